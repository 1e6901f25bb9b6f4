#pragma once
// A CAN interface as the system has it: there or not, up or not, and how fast. Whoever runs the
// machine sets it up (`ip link set can0 up type can bitrate 250000 restart-ms 100`); here it is
// only looked at.

#include <cstdint>
#include <optional>
#include <string>

namespace flatpose::port {

struct CanInterface {
  int index = 0;  ///< 0: there is none of this name.
  bool is_up = false;
  bool is_bus_off = false;                      ///< As far as the driver says.
  std::optional<std::uint32_t> bit_rate_per_s;  ///< Virtual ones have none.
};

[[nodiscard]] CanInterface look_at_can(const std::string& name);

/// "can0 at 250 kbit/s", "vcan0", "can0, which is down"
[[nodiscard]] std::string to_text(const std::string& name, const CanInterface& interface);

/// Fails: InputError naming `subject`: no such interface, or a bit rate that is not the expected
/// one (0: any is right).
void check_can(const std::string& subject, const std::string& name, const CanInterface& interface,
               std::uint32_t expected_bit_rate_per_s);

}  // namespace flatpose::port
