// The device's objects by SDO: what is read, and what a write does.

#include <algorithm>
#include <cstring>

#include "flatpose/can/device.hpp"
#include "flatpose/result_map/registers.hpp"
#include "flatpose/result_map/table.hpp"

namespace flatpose::can {
namespace {

using result_map::Entry;
using result_map::Field;

// The command's registers in the order of the map.
constexpr std::uint16_t job::CommandImage::*kRegisters[] = {
    &job::CommandImage::command_number, &job::CommandImage::command_session,
    &job::CommandImage::command,        &job::CommandImage::job,
    &job::CommandImage::pick_number,    &job::CommandImage::pick_outcome,
    &job::CommandImage::control};
static_assert(2 * std::size(kRegisters) == kWholeCommandBytes);

std::size_t text_bytes(const char* text) noexcept {
  return std::min<std::size_t>(std::strlen(text), kTextBytesMax);
}

bool is_report(const job::CommandImage& image) noexcept {
  return image.command == static_cast<std::uint16_t>(job::Command::kReportPick);
}

std::uint16_t& small_target(job::CommandImage& image, std::uint8_t subindex) noexcept {
  if (subindex == kSmallCommand) return image.command;
  if (subindex == kSmallOutcome) return image.pick_outcome;
  return is_report(image) ? image.pick_number : image.job;
}

bool is_of_command(std::uint16_t index) noexcept {
  return index == kCommandIndex || index == kSmallCommandIndex || index == kWholeCommandIndex;
}

Abort abort_of(job::Verdict verdict) noexcept {
  switch (verdict) {
    case job::Verdict::kGranted: return Abort::kNone;
    case job::Verdict::kNotOwner: return Abort::kLocalControl;
    case job::Verdict::kBadValue: return Abort::kDeviceState;
  }
  return Abort::kDeviceState;
}

}  // namespace

// --- reading

Abort Device::read_object(std::uint16_t index, std::uint8_t subindex,
                          std::span<std::uint8_t, kObjectBytesMax> bytes,
                          std::size_t& size) const noexcept {
  Object object;
  const Abort why = find_object(index, subindex, object);
  if (why != Abort::kNone) return why;
  if (object.type == DataType::kVisibleString) {
    const char* text = text_of(index);
    size = text_bytes(text);
    std::copy_n(text, size, bytes.begin());
  } else if (index == kWholeResultIndex) {
    size = whole_result(bytes);
  } else if (index == kWholeCommandIndex) {
    const job::CommandImage image = machine_.snapshot(master()).image;
    size = kWholeCommandBytes;
    for (std::size_t i = 0; i < std::size(kRegisters); ++i)
      put_number(bytes, 2 * i, 2, image.*kRegisters[i]);
  } else {
    size = bytes_of(object.type);
    put_number(bytes, 0, size, number_of(object));
  }
  return Abort::kNone;
}

const char* Device::text_of(std::uint16_t index) const noexcept {
  if (index == 0x1008) return config_.name;
  return index == 0x1009 ? config_.hardware : config_.software;
}

std::uint32_t Device::number_of(const Object& object) const noexcept {
  if (object.entry != nullptr)
    return result_map::raw_of(*object.entry, machine_.snapshot(master()), {});
  if (object.access == Access::kConst)
    return object.initial + (object.adds_node ? config_.node : 0U);
  std::uint32_t value = 0;
  if (parameters_.read(object.index, object.subindex, config_.node, value)) {
    const bool is_fd_id = object.index == kFdReportIndex && object.subindex == 1;
    return is_fd_id && !carries_fd_ ? value | kNotValid : value;
  }
  switch (object.index) {
    case 0x1001: return log_.error_register();
    case 0x1003:
      return object.subindex == 0 ? static_cast<std::uint32_t>(log_.history_count())
                                  : log_.history(object.subindex);
    case 0x1018: return config_.serial;
    case kReportIndex:
      return static_cast<std::uint32_t>(report_[static_cast<ReportField>(object.subindex)]);
    case kSmallCommandIndex: {
      job::CommandImage image = machine_.snapshot(master()).image;
      return small_target(image, object.subindex);
    }
    default: return object.initial;
  }
}

// The objects of 2010h one after the other, of one moment.
std::size_t Device::whole_result(std::span<std::uint8_t> bytes) const noexcept {
  const job::Snapshot snapshot = machine_.snapshot(master());
  std::size_t size = 0;
  Object object;
  (void)find_object(kResultIndex, 0, object);
  for (std::uint32_t i = 1; i <= object.initial; ++i) {
    Object part;
    if (find_object(kResultIndex, static_cast<std::uint8_t>(i), part) != Abort::kNone) continue;
    const std::size_t count = bytes_of(part.type);
    if (size + count > bytes.size()) break;
    put_number(bytes, size, count, result_map::raw_of(*part.entry, snapshot, {}));
    size += count;
  }
  return size;
}

// --- writing

// Whether a write of that many bytes may be tried at all; for a transfer that begins, what it says
// of its size.
Abort Device::may_write(const SdoServer::Step& step, Object& object) const noexcept {
  const Abort why = find_object(step.index, step.subindex, object);
  if (why != Abort::kNone) return why;
  if (object.access != Access::kReadWrite) return Abort::kReadOnly;
  if (!step.size_is_known) return Abort::kNone;
  const std::size_t wanted =
      step.index == kWholeCommandIndex ? kWholeCommandBytes : bytes_of(object.type);
  if (step.size == wanted) return Abort::kNone;
  return step.size > wanted ? Abort::kTooLong : Abort::kTooShort;
}

Abort Device::write_object(const SdoServer::Step& step) noexcept {
  Object object;
  const Abort why = may_write(step, object);
  if (why != Abort::kNone) return why;
  if (is_of_command(step.index)) return write_command(object, step.bytes);
  const std::uint32_t value = number_at(step.bytes, 0, bytes_of(object.type));
  if (step.index == 0x1003) {
    if (value != 0) return Abort::kValue;
    log_.clear_history();
    return Abort::kNone;
  }
  const Parameters before = parameters_;
  const Abort outcome = parameters_.write(step.index, step.subindex, config_.node, value);
  const bool turns_fd_on =
      step.index == kFdReportIndex && step.subindex == 1 && (value & kNotValid) == 0;
  if (turns_fd_on && outcome == Abort::kNone && !carries_fd_) {
    parameters_ = before;
    return Abort::kDeviceState;
  }
  if (step.index == 0x1016 && outcome == Abort::kNone) {
    consumer_.restart(parameters_.watched_node, parameters_.watched_ms);
    log_.clear(Fault::kMasterSilent);
  }
  if (parameters_.heartbeat_ms != before.heartbeat_ms)
    producer_.restart(parameters_.heartbeat_ms, now_us_);
  for (int i = 0; i < kTpdoCount; ++i) {
    if (!(parameters_.tpdos[i] == before.tpdos[i])) restart_pdo(i);
  }
  if (!(parameters_.fd == before.fd)) restart_fd();
  return outcome;
}

Abort Device::write_command(const Object& object, std::span<const std::uint8_t> bytes) noexcept {
  job::CommandImage image = machine_.image_for({master(), 0});
  if (object.index == kWholeCommandIndex) {
    if (bytes.size() != kWholeCommandBytes) return Abort::kLength;
    for (std::size_t i = 0; i < std::size(kRegisters); ++i)
      image.*kRegisters[i] = static_cast<std::uint16_t>(number_at(bytes, 2 * i, 2));
    return abort_of(command(image, true, true));
  }
  const auto value = static_cast<std::uint16_t>(number_at(bytes, 0, bytes_of(object.type)));
  if (object.index == kSmallCommandIndex) {
    small_target(image, object.subindex) = value;
    return abort_of(command(image, false, false));
  }
  image.*kRegisters[object.entry->address] = value;
  const Field field = object.entry->field;
  return abort_of(command(image, field == Field::kCommandNumber, field == Field::kControl));
}

}  // namespace flatpose::can
