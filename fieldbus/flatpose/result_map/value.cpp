#include "flatpose/result_map/value.hpp"

#include <cmath>

#include "flatpose/core/maths.hpp"
#include "flatpose/result_map/table.hpp"

namespace flatpose::result_map {
namespace {

constexpr Value kNone{0.0, true};

Value of_match(Field field, const job::ShownMatch& match, Convention convention) noexcept {
  if (match.index == 0) return kNone;
  const auto rotation = [&](int i) {
    return Value{is_euler(convention) ? match.rotation[i] * kDegPerRad : match.rotation[i]};
  };
  switch (field) {
    case Field::kPart: return {static_cast<double>(match.part)};
    case Field::kTool: return {static_cast<double>(match.tool)};
    case Field::kPick: return {static_cast<double>(match.pick)};
    case Field::kScore: return {match.score};
    case Field::kVisible: return {match.visible};
    case Field::kPositionX: return {match.position_mm.x};
    case Field::kPositionY: return {match.position_mm.y};
    case Field::kPositionZ: return {match.position_mm.z};
    case Field::kRotation1: return rotation(0);
    case Field::kRotation2: return rotation(1);
    case Field::kRotation3: return rotation(2);
    case Field::kRotation4: return rotation(3);
    case Field::kSigmaX: return {match.sigma_mm.x};
    case Field::kSigmaY: return {match.sigma_mm.y};
    case Field::kSigmaZ: return {match.sigma_mm.z};
    case Field::kSigmaTurnX: return {match.sigma_rad.x * kDegPerRad};
    case Field::kSigmaTurnY: return {match.sigma_rad.y * kDegPerRad};
    case Field::kSigmaTurnZ: return {match.sigma_rad.z * kDegPerRad};
    default: return kNone;
  }
}

double of_command(Field field, const job::CommandImage& image) noexcept {
  switch (field) {
    case Field::kCommandNumber: return image.command_number;
    case Field::kCommandSession: return image.command_session;
    case Field::kCommand: return image.command;
    case Field::kJob: return image.job;
    case Field::kPickNumber: return image.pick_number;
    case Field::kPickOutcome: return image.pick_outcome;
    default: return image.control;
  }
}

double of_machine(Field field, const job::Snapshot& s) noexcept {
  switch (field) {
    case Field::kTestUint16: return 0x1234;
    case Field::kTestUint32: return 0x12345678;
    case Field::kTestFloat32: return 123456.0;
    case Field::kMapVersion: return kMapVersion;
    case Field::kDoneNumber: return s.done_number;
    case Field::kStatus: return static_cast<double>(s.answer);
    case Field::kBits: return s.bits;
    case Field::kAcceptedNumber: return s.accepted_number;
    case Field::kRefusedNumber: return s.refused_number;
    case Field::kRefusedStatus: return static_cast<double>(s.refused_status);
    case Field::kScannedNumber: return s.scanned_number;
    case Field::kCancelledNumber: return s.cancelled_number;
    case Field::kLastNumber: return s.last_number;
    case Field::kSessionId: return s.session_id;
    case Field::kBootCount: return s.boot_count;
    case Field::kHeartbeat: return s.heartbeat;
    case Field::kReaderIsOwner: return s.reader_is_owner ? 1 : 0;
    case Field::kOwnerAddress: return s.owner_address;
    case Field::kUptime: return s.uptime_s;
    default: return s.answer_by_ms;
  }
}

Value of_result(Field field, const job::Snapshot& s) noexcept {
  const auto of_scan = [&s](double number) { return s.has_scan ? Value{number} : kNone; };
  switch (field) {
    case Field::kResultIsReaders: return {s.result_is_readers ? 1.0 : 0.0};
    case Field::kFrame: return {static_cast<double>(s.frame)};
    case Field::kConvention: return {static_cast<double>(s.convention)};
    case Field::kResultJob: return {static_cast<double>(s.job)};
    case Field::kScanNumber: return {static_cast<double>(s.scan_number)};
    case Field::kAge: return of_scan(s.age_ms);
    case Field::kSensorTime: return of_scan(s.sensor_us);
    case Field::kCycleTime: return of_scan(s.cycle_us);
    case Field::kPartHash: return {static_cast<double>(s.part_hash)};
    case Field::kAlignmentHash: return {static_cast<double>(s.alignment_hash)};
    case Field::kMatchCount: return {static_cast<double>(s.match_count)};
    default: return {static_cast<double>(s.matches_left)};
  }
}

}  // namespace

Value value_of(const Entry& entry, const job::Snapshot& s) noexcept {
  const Field field = entry.field;
  if (field <= Field::kControl) return {of_command(field, s.image)};
  if (field <= Field::kAnswerBy) return {of_machine(field, s)};
  if (field <= Field::kMatchesLeft) return of_result(field, s);
  const job::ShownMatch& match = entry.block == 0 ? s.match : s.further[entry.block - 1];
  if (field == Field::kMatchIndex) return {static_cast<double>(match.index)};
  if (field == Field::kMatchNumber) return {match.index == 0 ? 0.0 : s.done_number};
  const Value value = of_match(field, match, s.convention);
  return std::isfinite(value.number) ? value : kNone;
}

}  // namespace flatpose::result_map
