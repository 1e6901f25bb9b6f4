#pragma once
// A CAN interface as the system has it: there or not, up or not, and how fast. Whoever runs the
// machine sets it up (`ip link set can0 up type can bitrate 250000 restart-ms 100`); here it is
// only looked at.

#include <cstdint>
#include <optional>
#include <string>

namespace flatpose::port {

struct CanInterface {
  bool has_kernel_can = true;  ///< Else there is nothing more to say.
  int index = 0;               ///< 0: there is none of this name.
  bool is_can = true;          ///< Else it is of another kind: Ethernet, lo.
  bool is_up = false;
  bool is_virtual = false;                           ///< It has no controller that could be set up.
  bool is_bus_off = false;                           ///< As far as the driver says.
  bool carries_fd = false;                           ///< It takes CAN FD frames.
  std::optional<std::uint32_t> bit_rate_per_s = {};  ///< Virtual ones have none.
};

/// Whether the kernel lets an interface be called so.
[[nodiscard]] bool is_interface_name(const std::string& name) noexcept;

[[nodiscard]] CanInterface look_at_can(const std::string& name);

/// Index, kind, up or not, and FD or not alone.  Cost: system calls that wait for nobody, while the
/// driver is asked for the rest under a lock of the kernel that others may hold for long.
[[nodiscard]] CanInterface look_at_can_link(const std::string& name);

/// "can0 at 250 kbit/s", "vcan0", "can0, which is down"
[[nodiscard]] std::string to_text(const std::string& name, const CanInterface& interface);

/// What the config asks of an interface.
struct CanNeed {
  std::uint32_t bit_rate_per_s = 0;  ///< 0: any is right.
  bool fd = false;
};

/// What is wrong, and what mends it.
struct CanProblem {
  std::string what;
  std::string remedy;
};
/// Why a node cannot be on it; none: it can, now or when it is up.
[[nodiscard]] std::optional<CanProblem> problem_of(const std::string& name,
                                                   const CanInterface& interface,
                                                   const CanNeed& need);
/// What nobody can check there: the bit rate of an interface that tells none. None: nothing.
[[nodiscard]] std::optional<std::string> doubt_of(const std::string& name,
                                                  const CanInterface& interface,
                                                  const CanNeed& need);
/// "ip link set can0 up type can bitrate 250000 restart-ms 100"
[[nodiscard]] std::string command_for(const std::string& name, const CanInterface& interface,
                                      const CanNeed& need);

/// Fails: InputError naming `subject` with the problem, if there is one.
void check_can(const std::string& subject, const std::string& name, const CanInterface& interface,
               const CanNeed& need);

}  // namespace flatpose::port
