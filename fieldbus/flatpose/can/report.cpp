#include "flatpose/can/report.hpp"

#include <algorithm>
#include <cmath>

#include "flatpose/result_map/registers.hpp"
#include "flatpose/result_map/table.hpp"

namespace flatpose::can {
namespace {

using result_map::Field;
using result_map::ValueSet;
using Line = ReportField;

constexpr std::int32_t kMostInt24 = 0x7fffff;
constexpr double kMost = kMostInt24;
constexpr double kSharesPerOne = 200.0;

constexpr ReportLine kLines[kReportFieldCount] = {
    {Line::kSequence, "sequence", 1, false, 1, "", 0, 255, ValueSet::kNone,
     "another with each result; of one pose the same in all four frames"},
    {Line::kStatus, "status", 1, true, 1, "", -128, 127, ValueSet::kAnswers, "how it ended"},
    {Line::kBits, "bits", 1, false, 1, "", 0, 255, ValueSet::kBits, "what the machine is at"},
    {Line::kRefusedStatus, "refused_status", 1, false, 1, "", 0, 255, ValueSet::kRefusals,
     "why judged_number was refused; 0: it was accepted"},
    {Line::kJudgedNumber, "judged_number", 2, false, 1, "", 0, 65535, ValueSet::kNone,
     "your last command_number that was accepted or refused"},
    {Line::kDoneNumber, "done_number", 2, false, 1, "", 0, 65535, ValueSet::kNone,
     "your command that this result is of; 0: no result"},
    {Line::kPositionX, "position_x", 3, true, 0.001, "mm", -kMost / 1000, kMost / 1000,
     ValueSet::kNone, "-8388608: no pose"},
    {Line::kPositionY, "position_y", 3, true, 0.001, "mm", -kMost / 1000, kMost / 1000,
     ValueSet::kNone, "-8388608: no pose"},
    {Line::kScore, "score", 1, false, 0.005, "", 0, 1, ValueSet::kNone,
     "confirmed share of what is visible; 255: none"},
    {Line::kPositionZ, "position_z", 3, true, 0.001, "mm", -kMost / 1000, kMost / 1000,
     ValueSet::kNone, "-8388608: no pose"},
    {Line::kRotation1, "rotation_1", 3, true, 0.001, "deg", -kMost / 1000, kMost / 1000,
     ValueSet::kNone, "A, W or rx; 1e-6 rad for a rotation vector. -8388608: no pose"},
    {Line::kPart, "part", 1, false, 1, "", 0, 254, ValueSet::kNone,
     "which of the job's parts, from 1; 255: none"},
    {Line::kRotation2, "rotation_2", 3, true, 0.001, "deg", -kMost / 1000, kMost / 1000,
     ValueSet::kNone, "B, P or ry; scaled like rotation_1"},
    {Line::kRotation3, "rotation_3", 3, true, 0.001, "deg", -kMost / 1000, kMost / 1000,
     ValueSet::kNone, "C, R or rz; scaled like rotation_1"},
    {Line::kTool, "tool", 1, false, 1, "", 0, 254, ValueSet::kNone,
     "which tool the pose is for; 0: the pose is the part's own, no pick. 255: none"},
};

constexpr bool lines_are_in_order() {
  for (int i = 0; i < kReportFieldCount; ++i) {
    if (static_cast<int>(kLines[i].field) != i + 1) return false;
  }
  return true;
}
static_assert(lines_are_in_order());

constexpr ReportField kStatusFrame[] = {Line::kSequence,     Line::kStatus,
                                        Line::kBits,         Line::kRefusedStatus,
                                        Line::kJudgedNumber, Line::kDoneNumber};
constexpr ReportField kFirstPoseFrame[] = {Line::kSequence, Line::kPositionX, Line::kPositionY,
                                           Line::kScore};
constexpr ReportField kSecondPoseFrame[] = {Line::kSequence, Line::kPositionZ, Line::kRotation1,
                                            Line::kPart};
constexpr ReportField kThirdPoseFrame[] = {Line::kSequence, Line::kRotation2, Line::kRotation3,
                                           Line::kTool};
constexpr std::span<const ReportField> kFrames[kTpdoCount] = {kStatusFrame, kFirstPoseFrame,
                                                              kSecondPoseFrame, kThirdPoseFrame};

constexpr bool frames_are_full() {
  for (const auto& frame : kFrames) {
    int bytes = 0;
    for (const ReportField field : frame) bytes += kLines[static_cast<int>(field) - 1].bytes;
    if (bytes != kClassicBytesMax) return false;
  }
  return true;
}
static_assert(frames_are_full());
static_assert(job::kBitCount <= 8, "the bits do not fit their byte");

struct Wide {
  ReportField line;
  Field field;
};
constexpr Wide kPose[] = {
    {Line::kPositionX, Field::kPositionX}, {Line::kPositionY, Field::kPositionY},
    {Line::kPositionZ, Field::kPositionZ}, {Line::kRotation1, Field::kRotation1},
    {Line::kRotation2, Field::kRotation2}, {Line::kRotation3, Field::kRotation3}};

std::int32_t share(double value) noexcept {
  return static_cast<std::int32_t>(
      std::clamp(std::floor(value * kSharesPerOne + 0.5), 0.0, kSharesPerOne));
}

void show_no_pose(Report& report) noexcept {
  for (const Wide& wide : kPose) report[wide.line] = kNoneInt24;
  report[Line::kScore] = report[Line::kPart] = report[Line::kTool] = kNoneUint8;
}

// Returns whether all of it fits.
bool show_pose(const job::Snapshot& snapshot, Report& report) noexcept {
  if (snapshot.convention == Convention::kAbbQuaternion) return false;
  for (const Wide& wide : kPose) {
    const result_map::Entry* entry = result_map::find(wide.field);
    const auto raw = static_cast<std::int32_t>(result_map::raw_of(*entry, snapshot, {}));
    if (raw < -kMostInt24 || raw > kMostInt24) return false;
    report[wide.line] = raw;
  }
  if (snapshot.match.part >= kNoneUint8 || snapshot.match.tool >= kNoneUint8) return false;
  report[Line::kPart] = snapshot.match.part;
  report[Line::kScore] = share(snapshot.match.score);
  report[Line::kTool] = snapshot.match.tool;
  return true;
}

}  // namespace

std::span<const ReportLine> report_lines() noexcept { return kLines; }

const ReportLine& line_of(ReportField field) noexcept {
  return kLines[static_cast<std::size_t>(field) - 1];
}

std::span<const ReportField> fields_of_tpdo(int tpdo) noexcept { return kFrames[tpdo]; }

Report head_of(const job::Snapshot& snapshot, const Judgement& judgement) noexcept {
  constexpr unsigned kOfTheResult = job::kAck | job::kDone | job::kValid | job::kScanRepeated;
  Report report;
  unsigned bits = snapshot.bits;
  job::Answer answer = snapshot.answer;
  show_no_pose(report);
  if (snapshot.result_is_readers) {
    report[Line::kDoneNumber] = snapshot.done_number;
  } else {
    answer = job::Answer::kPending;
    bits &= ~(kOfTheResult & ~(snapshot.reader_is_owner ? unsigned{job::kAck} : 0U));
  }
  report[Line::kStatus] = static_cast<std::int32_t>(answer);
  report[Line::kBits] = static_cast<std::int32_t>(bits);
  report[Line::kJudgedNumber] = judgement.number;
  report[Line::kRefusedStatus] = static_cast<std::int32_t>(judgement.refusal);
  return report;
}

void show_out_of_range(Report& report) noexcept {
  show_no_pose(report);
  report[Line::kStatus] = static_cast<std::int32_t>(job::Answer::kOutOfRange);
  report[Line::kBits] &= ~static_cast<std::int32_t>(job::kValid);
}

Report report_of(const job::Snapshot& snapshot, const Judgement& judgement) noexcept {
  Report report = head_of(snapshot, judgement);
  if (!snapshot.result_is_readers || snapshot.match.index == 0) return report;
  if (!show_pose(snapshot, report)) show_out_of_range(report);
  return report;
}

bool has_pose(const Report& report) noexcept { return report[Line::kPositionX] != kNoneInt24; }

bool is_same_result(const Report& a, const Report& b) noexcept {
  for (const ReportLine& line : kLines) {
    const bool is_of_the_moment = line.field == Line::kSequence || line.field == Line::kBits ||
                                  line.field == Line::kRefusedStatus ||
                                  line.field == Line::kJudgedNumber;
    if (!is_of_the_moment && a[line.field] != b[line.field]) return false;
  }
  return true;
}

std::array<std::uint8_t, kClassicBytesMax> tpdo_bytes(const Report& report, int tpdo) noexcept {
  std::array<std::uint8_t, kClassicBytesMax> bytes{};
  std::size_t at = 0;
  for (const ReportField field : fields_of_tpdo(tpdo)) {
    const std::size_t count = line_of(field).bytes;
    put_number(bytes, at, count, static_cast<std::uint32_t>(report[field]));
    at += count;
  }
  return bytes;
}

}  // namespace flatpose::can
