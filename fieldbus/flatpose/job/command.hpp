#pragma once
// What a master may ask for, why it may be refused, and the bits: the numbers on the wire.

#include <cstdint>
#include <span>

namespace flatpose::job {

enum class Command : std::uint16_t {
  kLocate = 1,
  kNext = 2,
  kCapture = 3,
  kLocateInLast = 4,
  kCancel = 5,
  kClearError = 6,
  kVerifyAlignment = 7,
  kSaveScan = 8,
  kReportPick = 9,
  kReloadJobs = 10,
};

/// Why a number was used up without being executed.
enum class Refusal : std::uint16_t {
  kNone = 0,
  kBusy = 1,
  kNotReady = 2,
  kNotOwner = 3,  ///< For masters that no exception can tell; over Modbus it is exception 6.
  kBadJob = 4,
  kBadCommand = 5,
  kStaleSession = 6,
};

/// Bits that are always readable.
enum Bit : std::uint16_t {
  kReady = 1 << 0,         ///< Would take a command now.
  kAck = 1 << 1,           ///< The last trigger was accepted.
  kBusy = 1 << 2,          ///< A command is running.
  kDone = 1 << 3,          ///< There is an answer.
  kValid = 1 << 4,         ///< There is a pose, and it is fresh.
  kError = 1 << 5,         ///< A command was refused, or something is at fault.
  kSimulated = 1 << 6,     ///< The scan (or the source) is simulated.
  kScanRepeated = 1 << 7,  ///< The scan is byte for byte the one before.
};
inline constexpr int kBitCount = 8;

/// Bits of the control register: only with handshake = "bits".
enum ControlBit : std::uint16_t {
  kTrigger = 1 << 0,    ///< Raise to start, drop when ACK is seen.
  kResultRead = 1 << 1  ///< Raise when the result was read, drop when DONE has dropped.
};
inline constexpr int kControlBitCount = 2;

enum class PickOutcome : std::uint16_t { kPicked = 1, kMissed = 2, kCollided = 3, kDropped = 4 };

/// The frame that a pose is in.
enum class FrameName : std::uint16_t { kScan = 0, kWork = 1, kRobot = 2 };

/// A number on the wire, its name and what it means.
struct Named {
  int value;
  const char* name;
  const char* doc;
};
[[nodiscard]] std::span<const Named> command_names() noexcept;
[[nodiscard]] std::span<const Named> refusal_names() noexcept;
[[nodiscard]] std::span<const Named> bit_names() noexcept;  ///< By bit index.
[[nodiscard]] std::span<const Named> control_bit_names() noexcept;
[[nodiscard]] std::span<const Named> pick_outcome_names() noexcept;
[[nodiscard]] std::span<const Named> frame_names() noexcept;

/// "unknown" when there is none.
[[nodiscard]] const char* name_of(std::span<const Named> names, int value) noexcept;

[[nodiscard]] constexpr bool is_command(std::uint16_t raw) noexcept {
  return raw >= static_cast<std::uint16_t>(Command::kLocate) &&
         raw <= static_cast<std::uint16_t>(Command::kReloadJobs);
}

[[nodiscard]] constexpr bool is_pick_outcome(std::uint16_t raw) noexcept {
  return raw >= static_cast<std::uint16_t>(PickOutcome::kPicked) &&
         raw <= static_cast<std::uint16_t>(PickOutcome::kDropped);
}

}  // namespace flatpose::job
