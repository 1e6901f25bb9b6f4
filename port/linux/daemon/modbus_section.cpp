// [modbus]: where the server listens, and how numbers lie in its registers.

#include <array>
#include <bit>

#include "port/linux/daemon/config.hpp"
#include "port/linux/daemon/section.hpp"
#include "port/linux/files/input_error.hpp"

namespace flatpose::daemon {
namespace {

constexpr Range kPorts{0, 65535};
constexpr Range kUnits{1, 247};
constexpr std::size_t kNetworksMax = 64;
constexpr Range kInt32s{INT32_MIN, INT32_MAX};
constexpr double kFloatMost = std::numeric_limits<float>::max();

// In the order of WordOrder and Handshake.
const std::vector<std::string> kOrders{"ABCD", "CDAB", "BADC", "DCBA"};
const std::vector<std::string> kHandshakes{"number", "bits"};

void read_allowed(Section& section, port::AllowList& allowed) {
  for (const std::string& text : section.texts("allow", kNetworksMax)) {
    const auto network = port::parse_network(text);
    if (!network)
      section.fail("allow",
                   "'allow' has \"" + port::printable(text, 60) + "\", which is no network",
                   "write \"192.0.2.7\" or \"192.0.2.0/24\", all beyond the network's bits 0");
    allowed.networks.push_back(*network);
  }
}

}  // namespace

void read_modbus(Section section, Config& config) {
  ModbusConfig& modbus = config.modbus;
  modbus.is_on = section.is_there();
  modbus.place = section.place_of("port");
  modbus.bind = section.text("bind").value_or(modbus.bind);
  modbus.port = static_cast<int>(section.whole("port", kPorts).value_or(modbus.port));
  read_allowed(section, modbus.allowed);
  modbus.unit = static_cast<std::uint8_t>(section.whole("unit", kUnits).value_or(modbus.unit));
  modbus.format.order =
      static_cast<result_map::WordOrder>(section.choice("word_order", kOrders).value_or(0));
  if (const auto none = section.whole("no_pose_int32", kInt32s))
    modbus.format.none_int32 = static_cast<std::uint32_t>(*none);
  if (const auto none = section.number("no_pose_float32", -kFloatMost, kFloatMost))
    modbus.format.none_float32 = std::bit_cast<std::uint32_t>(static_cast<float>(*none));
  modbus.handshake =
      static_cast<job::Handshake>(section.choice("handshake", kHandshakes).value_or(0));
  read_lease(section, config);
  section.finish();
}

}  // namespace flatpose::daemon
