#include "flatpose/refine/raw_contour.hpp"

#include <algorithm>
#include <cmath>

namespace flatpose::refine {
namespace {

constexpr int kWalkLengthMax = 64;
// Laser triangulation overshoots at an edge over a few points; what stays above for longer lies on
// the part.
constexpr int kSpikeLengthMax = 6;
// A slope goes on from point to point by at least this share of the tolerance.
// The foot of a fall: this share of the step below the surface.
constexpr double kFootShare = 0.8;
constexpr double kRiseShare = 0.3;

enum class Standing { kOn, kBelow, kAbove, kMissing };

// A walk along one scan line in the object's frame.
class Line {
 public:
  Line(const RawScan& raw, const Pose& object_T_scan, double low_mm, double high_mm) noexcept
      : raw_(raw), object_T_scan_(object_T_scan), low_mm_(low_mm), high_mm_(high_mm) {}

  Standing at(Pixel pixel, Vec3* p_object_mm) const noexcept {
    if (!raw_.scan.contains(pixel.column, pixel.row)) return Standing::kMissing;
    const Vec3 p_scan_mm = raw_.scan(pixel.column, pixel.row);
    if (!is_valid(p_scan_mm)) return Standing::kMissing;
    *p_object_mm = object_T_scan_ * p_scan_mm;
    if (p_object_mm->z > high_mm_) return Standing::kAbove;
    return p_object_mm->z < low_mm_ ? Standing::kBelow : Standing::kOn;
  }

 private:
  const RawScan& raw_;
  const Pose& object_T_scan_;
  double low_mm_;
  double high_mm_;
};

struct Step {
  int dcolumn = 0;
  int drow = 0;
  double dx_mm = 0.0;  // in the object's plane
  double dy_mm = 0.0;
};

// The step from the pixel to a neighbour on the surface, on one side or the other.
bool neighbour_step(const Line& line, Pixel at, const Vec3& p_mm, int dcolumn, int drow,
                    Step* step) noexcept {
  Vec3 q_mm;
  for (const int side : {1, -1}) {
    if (line.at({at.column + side * dcolumn, at.row + side * drow}, &q_mm) != Standing::kOn)
      continue;
    *step = {dcolumn, drow, side * (q_mm.x - p_mm.x), side * (q_mm.y - p_mm.y)};
    return true;
  }
  return false;
}

// The scan direction that leads outward most straightly.
bool outward_step(const Line& line, Pixel at, const Vec3& p_mm, double nx, double ny,
                  Step* best) noexcept {
  constexpr double kCosineMin = 0.6;
  double best_cosine = kCosineMin;
  bool found = false;
  for (const bool along_row : {true, false}) {
    Step step;
    if (!neighbour_step(line, at, p_mm, along_row ? 1 : 0, along_row ? 0 : 1, &step)) continue;
    const double length_mm = std::sqrt(step.dx_mm * step.dx_mm + step.dy_mm * step.dy_mm);
    if (!(length_mm > 0.0)) continue;
    const double cosine = (step.dx_mm * nx + step.dy_mm * ny) / length_mm;
    if (std::fabs(cosine) <= best_cosine) continue;
    best_cosine = std::fabs(cosine);
    found = true;
    *best = cosine > 0.0 ? step : Step{-step.dcolumn, -step.drow, -step.dx_mm, -step.dy_mm};
  }
  return found;
}

// A pixel on the surface a little inside of the contour.
bool find_start(const RawScan& raw, const Pose& work_T_object, const model::ContourPoint& c,
                const Line& line, Pixel* pixel, Vec3* p_mm) noexcept {
  for (const double inward_cells : {2.0, 3.0, 1.0, 4.0}) {
    const double inward_mm = inward_cells * raw.map->grid.cell_mm;
    const Vec3 probe_mm{c.x_mm - inward_mm * c.nx, c.y_mm - inward_mm * c.ny, c.z_mm};
    *pixel = raw.pixel_under(work_T_object * probe_mm);
    if (!pixel->is_none() && line.at(*pixel, p_mm) == Standing::kOn) return true;
  }
  return false;
}

// The end of a slope: from a pixel on, as long as each next point lies further along in height
// (rise > 0 up, < 0 down). A shadow cuts the slope off: nothing is known of the rest.
Vec3 end_of_slope(const Line& line, Pixel from, const Vec3& from_mm, int dcolumn, int drow,
                  double rise_mm) noexcept {
  constexpr int kSlopeLengthMax = 24;
  Vec3 end_mm = from_mm;
  Pixel pixel = from;
  for (int walked = 0; walked < kSlopeLengthMax; ++walked) {
    pixel = {pixel.column + dcolumn, pixel.row + drow};
    Vec3 p_mm;
    if (line.at(pixel, &p_mm) == Standing::kMissing) return end_mm;
    const bool goes_on = rise_mm > 0.0 ? p_mm.z > end_mm.z + rise_mm : p_mm.z < end_mm.z + rise_mm;
    if (!goes_on) return end_mm;
    end_mm = p_mm;
  }
  return end_mm;
}

double offset_from(const model::ContourPoint& c, const Vec3& p_mm) noexcept {
  return (p_mm.x - c.x_mm) * c.nx + (p_mm.y - c.y_mm) * c.ny;
}

struct OffsetMean {
  double sum_mm = 0.0;
  int count = 0;
  [[nodiscard]] double mean_or(double otherwise_mm) const noexcept {
    return count > 0 ? sum_mm / count : otherwise_mm;
  }
};

// The points from a pixel on that have left the surface but not reached the foot of the step.
OffsetMean points_on_the_way(const Line& line, Pixel from, const Step& step,
                             const model::ContourPoint& c) noexcept {
  constexpr int kPointCountMax = 8;
  const double foot_z_mm = c.z_mm - kFootShare * c.step_mm;
  OffsetMean mean;
  Pixel pixel = from;
  while (mean.count < kPointCountMax) {
    Vec3 p_mm;
    if (line.at(pixel, &p_mm) == Standing::kMissing || p_mm.z < foot_z_mm) break;
    mean.sum_mm += offset_from(c, p_mm);
    ++mean.count;
    pixel = {pixel.column + step.dcolumn, pixel.row + step.drow};
  }
  return mean;
}

}  // namespace

Crossing measure_crossing(const RawScan& raw, const Pose& work_T_object,
                          const model::ContourPoint& c, const RawContourConfig& config) noexcept {
  const Pose object_T_scan = work_T_object.inverse() * raw.work_T_scan;
  // A surface ends where it has fallen by about half of the step: sensors round the edge that they
  // see last, and a bound near the surface would cut there.
  constexpr double kStepShare = 0.4;
  const double fall_mm = std::max(config.tolerance_mm, kStepShare * static_cast<double>(c.step_mm));
  const Line line(raw, object_T_scan, c.z_mm - fall_mm, c.z_mm + config.tolerance_mm);
  Pixel pixel;
  Vec3 last_mm;
  Step step;
  if (!find_start(raw, work_T_object, c, line, &pixel, &last_mm)) return {};
  if (!outward_step(line, pixel, last_mm, c.nx, c.ny, &step)) return {};

  int above_count = 0;
  for (int walked = 0; walked < kWalkLengthMax; ++walked) {
    const Pixel next{pixel.column + step.dcolumn, pixel.row + step.drow};
    Vec3 next_mm;
    const Standing at_next = line.at(next, &next_mm);
    above_count = at_next == Standing::kAbove ? above_count + 1 : 0;
    if (above_count > kSpikeLengthMax) return {};  // hidden under something, not ended
    if (at_next == Standing::kOn || at_next == Standing::kAbove) {
      pixel = next;
      last_mm = next_mm;
      if (offset_from(c, last_mm) > config.search_mm) return {};
      continue;
    }
    const Pixel after{next.column + step.dcolumn, next.row + step.drow};
    if (line.at(after, &next_mm) == Standing::kOn) {  // one lost or stray point ends no surface
      pixel = after;
      last_mm = next_mm;
      continue;
    }
    if (!raw.scan.contains(next.column, next.row)) return {};  // the field ends here
    const bool has_fallen = last_mm.z < c.z_mm - config.tolerance_mm;
    const double step_mm = step.dx_mm * c.nx + step.dy_mm * c.ny;
    const double last_offset_mm = offset_from(c, last_mm);
    // Points on the way down stand on the side wall or are mixed of both sides: they are at the
    // contour. Without them it lies anywhere within the next step, half of it on average.
    const double offset_mm =
        points_on_the_way(line, next, step, c)
            .mean_or(has_fallen ? last_offset_mm : last_offset_mm + 0.5 * step_mm);
    if (!(std::fabs(offset_mm) <= config.search_mm)) return {};
    // A single step of the scan is as sharp as can be seen; what the slope goes on for, up and
    // down, is its width.
    const double rise_mm = kRiseShare * config.tolerance_mm;
    const Vec3 top_mm = end_of_slope(line, pixel, last_mm, -step.dcolumn, -step.drow, rise_mm);
    const Vec3 foot_mm = end_of_slope(line, pixel, last_mm, step.dcolumn, step.drow, -rise_mm);
    const double width_mm = offset_from(c, foot_mm) - offset_from(c, top_mm) - step_mm;
    return {true, offset_mm, std::max(0.0, width_mm)};
  }
  return {};
}

}  // namespace flatpose::refine
