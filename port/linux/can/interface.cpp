#include "port/linux/can/interface.hpp"

#include <libsocketcan.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <cstdio>

#include "port/linux/files/input_error.hpp"
#include "port/linux/modbus/file_descriptor.hpp"

namespace flatpose::port {
namespace {

constexpr std::uint32_t kPerKilo = 1000;

bool is_interface_up(const std::string& name) {
  const FileDescriptor socket(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  ifreq request{};
  name.copy(request.ifr_name, IFNAMSIZ - 1);
  return ioctl(socket.get(), SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_UP) != 0;
}

std::string kilobits(std::uint32_t bit_rate_per_s) {
  return std::to_string(bit_rate_per_s / kPerKilo) + " kbit/s";
}

}  // namespace

CanInterface look_at_can(const std::string& name) {
  CanInterface found;
  if (name.size() >= IFNAMSIZ) return found;
  found.index = static_cast<int>(if_nametoindex(name.c_str()));
  if (found.index == 0) return found;
  found.is_up = is_interface_up(name);
  int state = CAN_STATE_ERROR_ACTIVE;
  found.is_bus_off = can_get_state(name.c_str(), &state) == 0 && state == CAN_STATE_BUS_OFF;
  can_bittiming timing{};
  if (can_get_bittiming(name.c_str(), &timing) == 0 && timing.bitrate != 0)
    found.bit_rate_per_s = timing.bitrate;
  return found;
}

std::string to_text(const std::string& name, const CanInterface& interface) {
  std::string text = printable(name, IFNAMSIZ);
  if (interface.bit_rate_per_s) text += " at " + kilobits(*interface.bit_rate_per_s);
  if (!interface.is_up) return text + ", which is down";
  return interface.is_bus_off ? text + ", which is bus-off" : text;
}

void check_can(const std::string& subject, const std::string& name, const CanInterface& interface,
               std::uint32_t expected_bit_rate_per_s) {
  const std::string shown = printable(name, IFNAMSIZ);
  if (interface.index == 0)
    throw InputError(subject, "there is no CAN interface " + shown,
                     "see ip link; a driver may have to be loaded, or the name is another");
  const bool is_right = expected_bit_rate_per_s == 0 || !interface.bit_rate_per_s ||
                        *interface.bit_rate_per_s == expected_bit_rate_per_s;
  if (is_right) return;
  throw InputError(subject,
                   shown + " runs at " + kilobits(*interface.bit_rate_per_s) + ", not " +
                       kilobits(expected_bit_rate_per_s),
                   "ip link set " + shown + " down; ip link set " + shown +
                       " up type can bitrate " + std::to_string(expected_bit_rate_per_s) +
                       " restart-ms 100");
}

}  // namespace flatpose::port
