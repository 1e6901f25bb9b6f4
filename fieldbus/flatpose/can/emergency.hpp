#pragma once
// What is wrong at the moment, told once when it begins and once when it ends (EMCY), with the
// error register (1001h) and the history (1003h).

#include <array>
#include <cstdint>

#include "flatpose/can/frame.hpp"

namespace flatpose::can {

inline constexpr int kHistoryLength = 8;

enum class Fault : std::uint8_t {
  kMasterSilent,  ///< 8130h: no heartbeat of the node that 1016h names.
  kErrorPassive,  ///< 8120h: the bus, as the controller sees it.
  kBusWasOff,     ///< 8140h: back from bus-off; told for one moment.
  kFramesLost,    ///< 8110h: more frames than could be read; told for one moment.
  kCommandShort,  ///< 8210h: a command (RPDO) shorter than eight bytes.
  kTwin,          ///< 8150h: another node has this one's number; lasts until the next reset.
  kAnswer,        ///< FF00h - status: a command ended by a fault of ours; see job::is_fault.
};
inline constexpr int kFaultCount = 7;

class EmergencyLog {
 public:
  /// Does nothing while the fault lasts already.  `detail` is bytes 3 to 7 of the message.
  void raise(Fault fault, std::uint16_t code, const std::array<std::uint8_t, 5>& detail) noexcept;
  void raise(Fault fault) noexcept;
  void clear(Fault fault) noexcept;
  /// Raised and cleared: for what is over when it is told.
  void pulse(Fault fault) noexcept;

  [[nodiscard]] bool is_raised(Fault fault) const noexcept {
    return (raised_ >> static_cast<int>(fault) & 1) != 0;
  }
  [[nodiscard]] std::uint8_t error_register() const noexcept;

  [[nodiscard]] int history_count() const noexcept { return history_count_; }
  /// From 1, the newest; 0 beyond the end.
  [[nodiscard]] std::uint32_t history(int index) const noexcept;
  void clear_history() noexcept { history_count_ = 0; }

  [[nodiscard]] bool has_message() const noexcept { return message_count_ > 0; }
  /// Takes the oldest message not sent yet.  Needs has_message().
  [[nodiscard]] std::array<std::uint8_t, 8> take_message() noexcept;

 private:
  /// More cannot wait: then the oldest is left out, and stays in the history.
  static constexpr int kMessagesMax = 8;

  void tell(std::uint16_t code, const std::array<std::uint8_t, 5>& detail) noexcept;

  std::uint8_t raised_ = 0;
  std::array<std::uint32_t, kHistoryLength> history_{};
  int history_count_ = 0;
  std::array<std::array<std::uint8_t, 8>, kMessagesMax> messages_{};
  int message_first_ = 0;
  int message_count_ = 0;
};

}  // namespace flatpose::can
