// [can]: the node on a CAN bus.

#include <array>
#include <cstdio>

#include "port/linux/daemon/config.hpp"
#include "port/linux/daemon/section.hpp"
#include "port/linux/files/input_error.hpp"

namespace flatpose::daemon {
namespace {

constexpr Range kNodes{1, can::kNodeMax};
constexpr Range kTimes_ms{0, 65535};
constexpr Range kBitRates_per_s{10'000, 1'000'000};
constexpr Range kSerials{0, UINT32_MAX};
constexpr Range kIds{1, 0x7ff};

std::string hex_of(std::int64_t number) {
  std::array<char, 20> text{};
  std::snprintf(text.data(), text.size(), "0x%llX", static_cast<unsigned long long>(number));
  return text.data();
}

void read_interface(Section& section, CanConfig& can) {
  can.place = section.place_of("interface");
  can.interface = section.text("interface").value_or(can.interface);
  if (!port::is_interface_name(can.interface))
    section.fail("interface",
                 "'interface' is \"" + port::printable(can.interface, 60) +
                     "\", which no interface can be called",
                 "give a name of 1 to 15 characters, as ip link shows it");
}

void read_fd(Section& section, can::Config& node) {
  node.fd_frame = section.flag("fd_frame").value_or(node.fd_frame);
  node.fd_bit_rate_switch = section.flag("fd_bit_rate_switch").value_or(node.fd_bit_rate_switch);
  const auto id = section.whole("fd_frame_id", kIds);
  node.fd_frame_id = static_cast<std::uint16_t>(id.value_or(0));
  if (id && !can::is_fd_report_id(node.fd_frame_id, node.node))
    section.fail("fd_frame_id",
                 "'fd_frame_id' is " + hex_of(*id) + ", which has another use in CANopen",
                 "take one of 0x181 to 0x57F or 0x680 to 0x6DF that nobody on the bus sends");
}

}  // namespace

void read_can(Section section, Config& config) {
  CanConfig& can = config.can;
  can.is_on = section.is_there();
  read_interface(section, can);
  can::Config& node = can.node;
  const auto u8 = [&](const char* key, std::uint8_t usual) {
    return static_cast<std::uint8_t>(section.whole(key, kNodes).value_or(usual));
  };
  const auto u16 = [&](const char* key, std::uint16_t usual) {
    return static_cast<std::uint16_t>(section.whole(key, kTimes_ms).value_or(usual));
  };
  node.node = u8("node", node.node);
  node.master = u8("master", node.master);
  node.heartbeat_ms = u16("heartbeat_ms", node.heartbeat_ms);
  node.master_silence_ms = u16("master_silence_ms", node.master_silence_ms);
  node.serial = static_cast<std::uint32_t>(section.whole("serial", kSerials).value_or(0));
  read_fd(section, node);
  can.bit_rate_per_s =
      static_cast<std::uint32_t>(section.whole("bit_rate", kBitRates_per_s).value_or(0));
  read_lease(section, config);
  if (node.master == node.node)
    section.fail("master", "master and node are the same", "they are two nodes of the bus");
  if (can.is_on && config.modbus.handshake == job::Handshake::kBits)
    section.fail("interface", "CAN has no handshake by bits",
                 "write handshake = \"number\" in [modbus]");
  section.finish();
}

}  // namespace flatpose::daemon
