#include "port/linux/daemon/plane_check.hpp"

#include <algorithm>

#include "flatpose/core/maths.hpp"
#include "flatpose/rectify/survey.hpp"
#include "port/linux/tool/number_text.hpp"
#include "port/linux/tool/work_plane.hpp"

namespace flatpose::daemon {
namespace {

using job::Answer;

/// Fewer points on the plane than this share of all: parts cover it, or it is not the plane.
constexpr double kValidShareMin = 0.02;

Answer answer_of(Status status, const Budget& budget) noexcept {
  if (status == Status::kStopped)
    return budget.was_cancelled() ? Answer::kCancelled : Answer::kOutOfTime;
  return status == Status::kTooFewPoints ? Answer::kScanPoor : Answer::kInternal;
}

void tell(const Job& job, const tool::PlaneShift& shift, bool holds, std::string& told) noexcept {
  const JobConfig& config = job.config;
  try {
    told = tool::formatted(
        "the work plane of job %d %s: moved %+.3f mm under the scan's middle, %.3f mm at most "
        "(%.3f "
        "allowed), tilted %.3f deg (%.3f allowed)",
        config.rule.job, holds ? "holds" : "does not hold", shift.middle_mm, shift.greatest_mm,
        config.verify_shift_mm, shift.tilt_rad * kDegPerRad, config.verify_tilt_rad * kDegPerRad);
  } catch (...) {  // a line that cannot be made costs no answer
    told.clear();
  }
}

}  // namespace

std::size_t plane_check_bytes(const locate::Limits& limits) noexcept {
  const auto pixels = static_cast<std::size_t>(limits.scan_width_px) *
                      static_cast<std::size_t>(limits.scan_height_px);
  return std::max(rectify::survey_required_bytes() + Arena::kAlignmentBytes,
                  tool::work_plane_bytes(pixels));
}

Answer check_plane(const Job& job, const HeldScan& scan, Arena arena, const Host& host,
                   std::int64_t end_us, std::string& told) noexcept {
  const Alignment& alignment = job.alignment;
  if (!alignment.work_T_scan) return Answer::kNoAlignment;
  const Budget budget(host, end_us);
  const auto survey =
      rectify::survey(scan.view, *alignment.work_T_scan, arena, VectorPath::kPortable, budget);
  if (!survey) return answer_of(survey.status(), budget);
  if (1.0 - survey->missing_share < kValidShareMin) return Answer::kScanPoor;
  const double pitch_mm = std::max(survey->pitch_along_row_mm, survey->pitch_along_column_mm);
  const int up_sign = alignment.work_up == port::Up::kPlusZ ? 1 : -1;
  const auto found =
      tool::find_work_plane(scan.view, up_sign, survey->noise_sigma_mm, pitch_mm, arena, budget);
  if (!found) return answer_of(found.status(), budget);
  const tool::PlaneShift shift = tool::shift_of(*found, *alignment.work_T_scan);
  const bool holds = shift.is_within(job.config.verify_shift_mm, job.config.verify_tilt_rad);
  tell(job, shift, holds, told);
  return holds ? Answer::kOk : Answer::kAlignmentMoved;
}

}  // namespace flatpose::daemon
