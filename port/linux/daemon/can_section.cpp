// [can]: the node on a CAN bus.

#include "port/linux/daemon/config.hpp"
#include "port/linux/daemon/section.hpp"

namespace flatpose::daemon {
namespace {

constexpr Range kNodes{1, can::kNodeMax};
constexpr Range kTimes_ms{0, 65535};
constexpr Range kBitRates_per_s{10'000, 1'000'000};
constexpr Range kSerials{0, UINT32_MAX};

}  // namespace

void read_can(Section section, Config& config) {
  CanConfig& can = config.can;
  can.is_on = section.is_there();
  can.place = section.place_of("interface");
  can.interface = section.text("interface").value_or(can.interface);
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
  can.bit_rate_per_s =
      static_cast<std::uint32_t>(section.whole("bit_rate", kBitRates_per_s).value_or(0));
  if (node.master == node.node)
    section.fail("master", "master and node are the same", "they are two nodes of the bus");
  if (can.is_on && config.modbus.handshake == job::Handshake::kBits)
    section.fail("interface", "CAN has no handshake by bits",
                 "write handshake = \"number\" in [modbus]");
  section.finish();
}

}  // namespace flatpose::daemon
