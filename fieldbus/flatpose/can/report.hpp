#pragma once
// What the four TPDOs tell: one result in numbers that fit 8 bytes a frame, each with the same
// sequence number. Positions and rotations have the scale of the registers (0.001 mm, 0.001 degree,
// 1e-6 for a rotation vector) in 24 bits: +-8388.607 mm. What does not fit is no pose but a status,
// out_of_range; a quaternion, which takes four numbers, does not.
//
//   byte      0         1        2     3              4    5          6    7
//   TPDO1  sequence  status    bits  refused_status  judged_number   done_number
//   TPDO2  sequence  position_x             position_y             score
//   TPDO3  sequence  position_z             rotation_1             part
//   TPDO4  sequence  rotation_2             rotation_3             tool
//
// The sequence changes with the result. TPDO2 to TPDO4 are told when a pose comes or is taken back:
// a result that has none after one that had none is TPDO1 alone. So a reader waits for its
// done_number, and only if VALID is set, until the other three show the same sequence.

#include <array>
#include <cstdint>
#include <span>

#include "flatpose/can/frame.hpp"
#include "flatpose/job/snapshot.hpp"
#include "flatpose/result_map/entry.hpp"

namespace flatpose::can {

/// The numbers are the subindices of 2003h.
enum class ReportField : std::uint8_t {
  kSequence = 1,
  kStatus,
  kBits,
  kRefusedStatus,
  kJudgedNumber,
  kDoneNumber,
  kPositionX,
  kPositionY,
  kScore,
  kPositionZ,
  kRotation1,
  kPart,
  kRotation2,
  kRotation3,
  kTool,
};
inline constexpr int kReportFieldCount = 15;

inline constexpr std::int32_t kNoneInt24 = -0x800000;
inline constexpr std::int32_t kNoneUint8 = 0xff;

/// What a field is to who reads it.
struct ReportLine {
  ReportField field;
  const char* name;
  std::uint8_t bytes;
  bool is_signed;
  double scale;  ///< Value = raw x scale. Rotations: see result_map::rotation_scale().
  const char* unit;
  double least;  ///< Of the value.
  double greatest;
  result_map::ValueSet values;
  const char* doc;
};

/// By subindex, from 1.
[[nodiscard]] std::span<const ReportLine> report_lines() noexcept;
[[nodiscard]] const ReportLine& line_of(ReportField field) noexcept;

/// The fields of a TPDO, in the order of its bytes.  Needs: 0 to 3.
[[nodiscard]] std::span<const ReportField> fields_of_tpdo(int tpdo) noexcept;

struct Report {
  std::array<std::int32_t, kReportFieldCount> raw{};

  [[nodiscard]] std::int32_t& operator[](ReportField field) noexcept {
    return raw[static_cast<std::size_t>(field) - 1];
  }
  [[nodiscard]] std::int32_t operator[](ReportField field) const noexcept {
    return raw[static_cast<std::size_t>(field) - 1];
  }
  friend bool operator==(const Report&, const Report&) = default;
};

/// How the last number of this master was judged.
struct Judgement {
  std::uint16_t number = 0;
  job::Refusal refusal = job::Refusal::kNone;
};

/// What TPDO1 tells, as the registers have it: of another's result nothing. The sequence is 0, and
/// there is no pose.
[[nodiscard]] Report head_of(const job::Snapshot& snapshot, const Judgement& judgement) noexcept;

/// The same with the pose, or out_of_range.
[[nodiscard]] Report report_of(const job::Snapshot& snapshot, const Judgement& judgement) noexcept;

/// The status of a pose that does not fit, in place of it.
void show_out_of_range(Report& report) noexcept;

/// Whether the report has a pose.
[[nodiscard]] bool has_pose(const Report& report) noexcept;
/// Whether both tell of the same result; bits and judgement may differ.
[[nodiscard]] bool is_same_result(const Report& a, const Report& b) noexcept;

/// The bytes of a TPDO.
[[nodiscard]] std::array<std::uint8_t, kClassicBytesMax> tpdo_bytes(const Report& report,
                                                                    int tpdo) noexcept;

}  // namespace flatpose::can
