#include "port/linux/can/interface.hpp"

#include <libsocketcan.h>
#include <linux/can.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <cctype>
#include <cerrno>

#include "port/linux/can/link_kind.hpp"
#include "port/linux/files/input_error.hpp"
#include "port/linux/modbus/file_descriptor.hpp"

namespace flatpose::port {
namespace {

constexpr std::uint32_t kPerKilo = 1000;

constexpr std::uint32_t kUsualBitRate_per_s = 250'000;
constexpr std::uint32_t kUsualDataBitRate_per_s = 2'000'000;

bool has_kernel_can() {
  const FileDescriptor socket(::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW));
  return socket.is_open() || (errno != EAFNOSUPPORT && errno != EPROTONOSUPPORT);
}

std::string kilobits(std::uint32_t bit_rate_per_s) {
  return std::to_string(bit_rate_per_s / kPerKilo) + " kbit/s";
}

}  // namespace

bool is_interface_name(const std::string& name) noexcept {
  const auto is_wrong = [](char c) {
    return c == '/' || c == ':' || c == '\0' || std::isspace(static_cast<unsigned char>(c)) != 0;
  };
  return !name.empty() && name.size() < IFNAMSIZ && name != "." && name != ".." &&
         std::none_of(name.begin(), name.end(), is_wrong);
}

CanInterface look_at_can_link(const std::string& name) {
  CanInterface found;
  if (!is_interface_name(name)) return found;
  found.index = static_cast<int>(if_nametoindex(name.c_str()));
  if (found.index == 0) return found;
  const FileDescriptor socket(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  ifreq request{};
  name.copy(request.ifr_name, IFNAMSIZ - 1);
  found.is_can = ioctl(socket.get(), SIOCGIFHWADDR, &request) == 0 &&
                 request.ifr_hwaddr.sa_family == ARPHRD_CAN;
  found.is_up =
      ioctl(socket.get(), SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_UP) != 0;
  found.carries_fd =
      ioctl(socket.get(), SIOCGIFMTU, &request) == 0 && request.ifr_mtu >= int{CANFD_MTU};
  return found;
}

CanInterface look_at_can(const std::string& name) {
  if (!has_kernel_can()) return {.has_kernel_can = false};
  CanInterface found = look_at_can_link(name);
  if (found.index == 0 || !found.is_can) return found;
  found.is_virtual = link_kind_of(found.index) != "can";
  if (found.is_virtual) return found;
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

std::string command_for(const std::string& name, const CanInterface& interface,
                        const CanNeed& need) {
  const std::string link = "ip link set " + printable(name, IFNAMSIZ);
  if (interface.is_virtual && need.fd && !interface.carries_fd)
    return link + " down; " + link + " mtu 72; " + link + " up";
  if (interface.is_virtual) return link + " up";
  const std::uint32_t rate_per_s = need.bit_rate_per_s != 0
                                       ? need.bit_rate_per_s
                                       : interface.bit_rate_per_s.value_or(kUsualBitRate_per_s);
  const std::string fd =
      need.fd ? " dbitrate " + std::to_string(kUsualDataBitRate_per_s) + " fd on" : std::string();
  return (interface.is_up ? link + " down; " : "") + link + " up type can bitrate " +
         std::to_string(rate_per_s) + fd + " restart-ms 100";
}

std::optional<CanProblem> problem_of(const std::string& name, const CanInterface& interface,
                                     const CanNeed& need) {
  const std::string shown = printable(name, IFNAMSIZ);
  if (!interface.has_kernel_can)
    return CanProblem{"this kernel has no CAN", "load its module: modprobe can_raw"};
  if (interface.index == 0)
    return CanProblem{"there is no CAN interface " + shown,
                      "see ip link; a driver may have to be loaded, or the name is another"};
  if (!interface.is_can)
    return CanProblem{shown + " is no CAN interface", "name one that ip link shows as link/can"};
  const std::uint32_t rate_per_s = interface.bit_rate_per_s.value_or(need.bit_rate_per_s);
  if (need.bit_rate_per_s != 0 && rate_per_s != need.bit_rate_per_s)
    return CanProblem{
        shown + " runs at " + kilobits(rate_per_s) + ", not " + kilobits(need.bit_rate_per_s),
        command_for(name, interface, need)};
  if (need.fd && !interface.carries_fd)
    return CanProblem{shown + " is classic: it takes no CAN FD frame, which fd_frame asks for",
                      command_for(name, interface, need)};
  return {};
}

std::optional<std::string> doubt_of(const std::string& name, const CanInterface& interface,
                                    const CanNeed& need) {
  if (need.bit_rate_per_s == 0 || interface.bit_rate_per_s) return {};
  return printable(name, IFNAMSIZ) + " tells no bit rate: nothing checks that it is " +
         kilobits(need.bit_rate_per_s);
}

void check_can(const std::string& subject, const std::string& name, const CanInterface& interface,
               const CanNeed& need) {
  const auto problem = problem_of(name, interface, need);
  if (problem) throw InputError(subject, problem->what, problem->remedy);
}

}  // namespace flatpose::port
