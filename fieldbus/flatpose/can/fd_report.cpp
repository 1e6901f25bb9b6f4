#include "flatpose/can/fd_report.hpp"

#include <algorithm>

#include "flatpose/result_map/registers.hpp"
#include "flatpose/result_map/table.hpp"

namespace flatpose::can {
namespace {

using result_map::Field;

constexpr FdLine kFdLines[] = {
    {Field::kPositionX, 4},  {Field::kPositionY, 4},  {Field::kPositionZ, 4},
    {Field::kRotation1, 4},  {Field::kRotation2, 4},  {Field::kRotation3, 4},
    {Field::kRotation4, 4},  {Field::kSigmaX, 2},     {Field::kSigmaY, 2},
    {Field::kSigmaZ, 2},     {Field::kSigmaTurnX, 2}, {Field::kSigmaTurnY, 2},
    {Field::kSigmaTurnZ, 2}, {Field::kScore, 2},      {Field::kVisible, 2},
    {Field::kAge, 4},        {Field::kPart, 1},       {Field::kTool, 1},
    {Field::kPick, 1},       {Field::kMatchIndex, 1}, {Field::kSessionId, 2},
    {Field::kConvention, 1}, {Field::kFrame, 1}};

constexpr std::size_t place_of(Field field) {
  std::size_t at = kClassicBytesMax;
  for (const FdLine& line : kFdLines) {
    if (line.field == field) return at;
    at += line.bytes;
  }
  return at;
}
constexpr std::size_t kAgeAt = place_of(Field::kAge);
constexpr std::size_t kAgeBytes = 4;
static_assert(place_of(Field::kFrame) + 1 == kFdBytesMax, "the frame is full");

constexpr std::uint32_t kNoneUint16 = 0xffff;
constexpr std::uint32_t kNoneUint32 = 0xffffffff;
constexpr auto kNoneByte = static_cast<std::uint32_t>(kNoneUint8);

constexpr bool is_of_age(std::size_t at) { return at >= kAgeAt && at < kAgeAt + kAgeBytes; }
// The bytes of the head that tell of the machine and not of its result: bits, refused_status,
// judged_number.
constexpr bool is_of_the_machine(std::size_t at) { return at >= 2 && at < 6; }

bool is_of_result(Field field) noexcept {
  return field == Field::kConvention || field == Field::kFrame;
}

// In one byte, what does not fit is `none` too, and then the pose is withheld.
std::uint32_t told_of(const FdLine& line, const job::Snapshot& snapshot, bool& fits) noexcept {
  if (is_of_result(line.field) && !snapshot.result_is_readers) return kNoneByte;
  const result_map::Entry& entry = *result_map::find(line.field);
  const std::uint32_t raw = result_map::raw_of(entry, snapshot, {});
  if (line.bytes > 1 || raw < kNoneByte) return raw;
  fits = fits && entry.may_be_none && raw == kNoneUint16;
  return kNoneByte;
}

// Returns whether all of it fits.
bool put_result(const job::Snapshot& snapshot, FdBytes& bytes) noexcept {
  bool fits = true;
  std::size_t at = kClassicBytesMax;
  for (const FdLine& line : kFdLines) {
    put_number(bytes, at, line.bytes, told_of(line, snapshot, fits));
    at += line.bytes;
  }
  return fits;
}

}  // namespace

std::span<const FdLine> fd_lines() noexcept { return kFdLines; }

FdBytes fd_bytes(const job::Snapshot& snapshot, const Judgement& judgement) noexcept {
  Report head = head_of(snapshot, judgement);
  job::Snapshot told = snapshot;
  if (!told.result_is_readers) {
    told.match = {};
    told.has_scan = false;
  }
  FdBytes bytes{};
  if (!put_result(told, bytes)) {
    show_out_of_range(head);
    told.match = {};
    (void)put_result(told, bytes);
  }
  const auto start = tpdo_bytes(head, 0);
  std::copy(start.begin(), start.end(), bytes.begin());
  return bytes;
}

void grow_older(FdBytes& bytes, std::int64_t time_us) noexcept {
  const std::uint32_t age_ms = number_at(bytes, kAgeAt, kAgeBytes);
  if (age_ms == kNoneUint32 || time_us <= 0) return;
  const std::int64_t older_ms = std::min<std::int64_t>(age_ms + time_us / 1000, kNoneUint32 - 1);
  put_number(bytes, kAgeAt, kAgeBytes, static_cast<std::uint32_t>(older_ms));
}

bool is_same_result(const FdBytes& a, const FdBytes& b) noexcept {
  for (std::size_t i = 1; i < kFdBytesMax; ++i) {
    if (!is_of_the_machine(i) && !is_of_age(i) && a[i] != b[i]) return false;
  }
  return true;
}

}  // namespace flatpose::can
