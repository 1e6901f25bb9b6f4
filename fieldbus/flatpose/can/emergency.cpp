#include "flatpose/can/emergency.hpp"

namespace flatpose::can {
namespace {

constexpr std::uint8_t kGeneric = 1 << 0;
constexpr std::uint8_t kCommunication = 1 << 4;
constexpr std::uint8_t kManufacturer = 1 << 7;
constexpr std::uint16_t kNoError = 0x0000;

constexpr std::uint16_t code_of(Fault fault) noexcept {
  switch (fault) {
    case Fault::kMasterSilent: return 0x8130;
    case Fault::kErrorPassive: return 0x8120;
    case Fault::kBusWasOff: return 0x8140;
    case Fault::kFramesLost: return 0x8110;
    case Fault::kCommandShort: return 0x8210;
    case Fault::kTwin: return 0x8150;
    case Fault::kAnswer: return 0xff00;
  }
  return 0x1000;
}

}  // namespace

void EmergencyLog::raise(Fault fault) noexcept { raise(fault, code_of(fault), {}); }

void EmergencyLog::raise(Fault fault, std::uint16_t code,
                         const std::array<std::uint8_t, 5>& detail) noexcept {
  if (is_raised(fault)) return;
  raised_ = static_cast<std::uint8_t>(raised_ | 1 << static_cast<int>(fault));
  for (int i = kHistoryLength - 1; i > 0; --i) history_[i] = history_[i - 1];
  history_[0] = code | static_cast<std::uint32_t>(detail[0] | detail[1] << 8) << 16;
  if (history_count_ < kHistoryLength) ++history_count_;
  tell(code, detail);
}

void EmergencyLog::clear(Fault fault) noexcept {
  if (!is_raised(fault)) return;
  raised_ = static_cast<std::uint8_t>(raised_ & ~(1 << static_cast<int>(fault)));
  tell(kNoError, {});
}

void EmergencyLog::pulse(Fault fault) noexcept {
  raise(fault);
  clear(fault);
}

std::uint8_t EmergencyLog::error_register() const noexcept {
  if (raised_ == 0) return 0;
  const unsigned answer = 1U << static_cast<int>(Fault::kAnswer);
  unsigned bits = kGeneric;
  if ((raised_ & answer) != 0) bits |= kManufacturer;
  if ((raised_ & ~answer) != 0) bits |= kCommunication;
  return static_cast<std::uint8_t>(bits);
}

std::uint32_t EmergencyLog::history(int index) const noexcept {
  return index >= 1 && index <= history_count_ ? history_[index - 1] : 0;
}

void EmergencyLog::tell(std::uint16_t code, const std::array<std::uint8_t, 5>& detail) noexcept {
  if (message_count_ == kMessagesMax) {
    message_first_ = (message_first_ + 1) % kMessagesMax;
    --message_count_;
  }
  std::array<std::uint8_t, 8>& message =
      messages_[(message_first_ + message_count_) % kMessagesMax];
  ++message_count_;
  put_number(message, 0, 2, code);
  message[2] = error_register();
  for (std::size_t i = 0; i < detail.size(); ++i) message[3 + i] = detail[i];
}

std::array<std::uint8_t, 8> EmergencyLog::take_message() noexcept {
  const auto& message = messages_[message_first_];
  message_first_ = (message_first_ + 1) % kMessagesMax;
  --message_count_;
  return message;
}

}  // namespace flatpose::can
