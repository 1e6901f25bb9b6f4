#include "port/linux/tool/touch_fit.hpp"

#include <algorithm>
#include <cmath>

#include "flatpose/geometry/rigid_fit.hpp"
#include "port/linux/files/input_error.hpp"
#include "port/linux/tool/number_text.hpp"

namespace flatpose::tool {
namespace {

// So little width against the length leaves the turn about the line to the touch of a hair.
constexpr double kWidthShareMin = 0.1;
constexpr double kDepthShareFlat = 0.02;
constexpr std::size_t kLeftOutMax = 200;  // more points than these are no matter of single ones

struct Sides {
  std::vector<Vec3> scan_mm;
  std::vector<Vec3> robot_mm;

  explicit Sides(const std::vector<port::TouchedPair>& pairs, std::size_t without = SIZE_MAX) {
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (i == without) continue;
      scan_mm.push_back(pairs[i].scan_mm);
      robot_mm.push_back(pairs[i].robot_mm);
    }
  }
  [[nodiscard]] Result<RigidFit> fit() const { return fit_rigid(scan_mm, robot_mm); }
};

bool is_on_a_line(const Result<RigidFit>& fit) {
  return !fit || fit->width_mm < kWidthShareMin * fit->length_mm;
}

double reach_of(const std::vector<Vec3>& points) {
  Vec3 middle;
  for (const Vec3& p : points) middle = middle + (1.0 / static_cast<double>(points.size())) * p;
  double squares = 0.0;
  for (const Vec3& p : points) squares += dot(p - middle, p - middle);
  return std::sqrt(squares / static_cast<double>(points.size()));
}

[[noreturn]] void refuse_unit(const std::string& path, double ratio) {
  struct Unit {
    double ratio;
    const char* what;
  };
  constexpr Unit kUnits[] = {{0.001, "the robot's columns look like metres"},
                             {1000.0, "the scan's columns look like metres"},
                             {0.1, "the robot's columns look like centimetres"},
                             {10.0, "the scan's columns look like centimetres"},
                             {1.0 / 25.4, "the robot's columns look like inches"},
                             {25.4, "the scan's columns look like inches"}};
  std::string what = "no unit is so";
  for (const Unit& unit : kUnits)
    if (std::fabs(ratio / unit.ratio - 1.0) < 0.1) what = unit.what;
  throw port::InputError(
      path, formatted("the robot's distances are %.4g times the scan's: %s", ratio, what.c_str()),
      "give both sides in mm, and check that each line is one point");
}

[[noreturn]] void refuse_fit(const std::string& path, const std::vector<port::TouchedPair>& pairs,
                             const RigidFit& fit, const TouchFit& found, double rms_max_mm) {
  const Sides sides(pairs);
  const double ratio = reach_of(sides.robot_mm) / std::max(reach_of(sides.scan_mm), 1e-12);
  if (!(ratio > 0.8 && ratio < 1.25)) refuse_unit(path, ratio);
  Sides mirrored = sides;
  for (Vec3& p : mirrored.scan_mm) p.x = -p.x;
  const auto mirror_fit = mirrored.fit();
  if (mirror_fit && mirror_fit->rms_mm <= std::max(rms_max_mm, 0.2 * fit.rms_mm))
    throw port::InputError(
        path,
        formatted("one side is mirrored: as it is the pairs are off by %.2f mm rms, mirrored by "
                  "%.2f",
                  fit.rms_mm, mirror_fit->rms_mm),
        "check the columns' order (scan_x,scan_y,scan_z,robot_x,robot_y,robot_z) and signs");
  for (std::size_t i = 0; i < pairs.size() && pairs.size() > kTouchedPairsMin; ++i) {
    const auto rest = Sides(pairs, i).fit();
    if (!is_on_a_line(rest) && rest->rms_mm <= std::min(rms_max_mm, 0.3 * fit.rms_mm))
      throw port::InputError(path + ":" + std::to_string(pairs[i].line),
                             formatted("this pair does not fit: %.2f mm rms with it, %.2f without",
                                       fit.rms_mm, rest->rms_mm),
                             "touch the point again, or take the line out");
  }
  throw port::InputError(
      path,
      formatted(
          "the distances of the two sides do not fit: %.2f mm rms, more than %.2f, worst %.2f "
          "in line %d",
          fit.rms_mm, rms_max_mm, found.worst_mm, found.worst_line),
      "check that each line is one point seen and touched; --max-rms allows more");
}

void measure(std::vector<port::TouchedPair>& pairs, TouchFit& found) {
  for (port::TouchedPair& pair : pairs) {
    pair.residual_mm = norm(found.robot_T_scan * pair.scan_mm - pair.robot_mm);
    if (pair.residual_mm < found.worst_mm && found.worst_line != 0) continue;
    found.worst_mm = pair.residual_mm;
    found.worst_line = pair.line;
  }
}

double leave_one_out(const std::vector<port::TouchedPair>& pairs) {
  const std::size_t stride = pairs.size() / kLeftOutMax + 1;
  double squares = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < pairs.size(); i += stride) {
    const auto rest = Sides(pairs, i).fit();
    if (is_on_a_line(rest)) continue;
    const Vec3 off = rest->to_T_from * pairs[i].scan_mm - pairs[i].robot_mm;
    squares += dot(off, off);
    ++count;
  }
  return count == 0 ? 0.0 : std::sqrt(squares / count);
}

}  // namespace

TouchFit fit_touched(const std::string& path, std::vector<port::TouchedPair>& pairs,
                     double rms_max_mm) {
  if (pairs.size() < kTouchedPairsMin)
    throw port::InputError(path, "there are " + std::to_string(pairs.size()) + " pairs of points",
                           "touch at least four, far apart and not on one line");
  const Sides sides(pairs);
  const auto fit = sides.fit();
  const auto backwards = fit_rigid(sides.robot_mm, sides.scan_mm);
  for (const auto& side : {fit, backwards})
    if (is_on_a_line(side))
      throw port::InputError(path,
                             std::string("the points lie nearly on one line") +
                                 (is_on_a_line(fit) ? "" : " on the robot's side"),
                             "touch points that span a wide triangle or more");
  TouchFit found;
  found.robot_T_scan = fit->to_T_from;
  found.rms_mm = fit->rms_mm;
  found.is_flat = fit->depth_mm < kDepthShareFlat * fit->length_mm;
  measure(pairs, found);
  if (found.rms_mm > rms_max_mm) refuse_fit(path, pairs, *fit, found, rms_max_mm);
  found.leave_one_out_mm = leave_one_out(pairs);
  return found;
}

}  // namespace flatpose::tool
