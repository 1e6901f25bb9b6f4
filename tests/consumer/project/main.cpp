// What a user's program does: a scan of his own, taught, kept as bytes, and found again where it
// was moved to.

#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "flatpose/locate/locator.hpp"
#include "flatpose/model/template_file.hpp"
#include "flatpose/teach/teacher.hpp"

namespace {

using namespace flatpose;

constexpr int kSide_px = 160;
constexpr double kHeight_mm = 8.0;

/// An angle of 50 x 35 mm with a hole, 8 mm above a floor: a point a millimetre.
std::vector<float> scan_of_part(double x_mm, double y_mm, double turn_rad) {
  std::vector<float> points;
  for (int row = 0; row < kSide_px; ++row) {
    for (int column = 0; column < kSide_px; ++column) {
      const double dx = column - x_mm;
      const double dy = row - y_mm;
      const double u = std::cos(turn_rad) * dx + std::sin(turn_rad) * dy;
      const double v = -std::sin(turn_rad) * dx + std::cos(turn_rad) * dy;
      const bool in_long_arm = std::fabs(u) < 25.0 && v > -17.5 && v < 0.0;
      const bool in_short_arm = u > -25.0 && u < -5.0 && std::fabs(v) < 17.5;
      const bool in_hole = std::hypot(u - 15.0, v + 9.0) < 5.0;
      const bool on_part = (in_long_arm || in_short_arm) && !in_hole;
      // No surface is perfectly smooth.
      const double rough_mm = 0.02 * std::sin(12.9898 * column + 78.233 * row);
      points.insert(points.end(), {static_cast<float>(column), static_cast<float>(row),
                                   static_cast<float>((on_part ? kHeight_mm : 0.0) + rough_mm)});
    }
  }
  return points;
}

RangeImageView view_of(const std::vector<float>& points) {
  constexpr std::ptrdiff_t kPointBytes = 3 * sizeof(float);
  return {points.data(), points.data() + 1, points.data() + 2,     kSide_px,
          kSide_px,      kPointBytes,       kSide_px * kPointBytes};
}

int fail(const char* what) {
  std::fprintf(stderr, "consumer: %s\n", what);
  return 1;
}

}  // namespace

int main() {
  const locate::Limits limits{kSide_px, kSide_px, 60'000};
  std::vector<std::byte> memory(teach::Teacher::required_bytes(limits));
  const Frames frames = frames_of_scan(/*up_is_plus_z=*/true);

  const std::vector<float> first = scan_of_part(70.0, 75.0, 0.0);
  const teach::TeachScan lesson{view_of(first), frames};
  teach::TeachConfig config;
  config.origin = {true, 70.0, 75.0};
  teach::Teacher teacher;
  teach::TeachReport report;
  model::Template taught;
  if (teacher.init(limits, memory) != Status::kOk) return fail("no teacher");
  if (teacher.teach({&lesson, 1}, config, taught, report) != Status::kOk)
    return fail("nothing taught");

  std::vector<std::byte> file(model::kTemplateFileBytesMax);
  const auto size_bytes = model::write_template(taught, file);
  model::Template part;
  if (!size_bytes || model::read_template({file.data(), *size_bytes}, part) != Status::kOk)
    return fail("the template was not kept");

  const double turn_rad = 0.7;
  const std::vector<float> second = scan_of_part(90.0, 82.0, turn_rad);
  locate::Locator locator;
  locate::LocateResult result;
  if (locator.init(limits, memory) != Status::kOk) return fail("no locator");
  if (locator.locate(part, view_of(second), frames, {}, StoppedClock{}, result) != Status::kOk ||
      result.match_count != 1)
    return fail("not found");
  const locate::Match& match = result.matches[0];
  const Vec3& at_mm = match.face_T_object.position_mm;
  const double error_rad =
      std::atan2(match.face_T_object.rotation.m[3], match.face_T_object.rotation.m[0]) - turn_rad;
  std::printf("found at %.2f %.2f %.2f, turned by %.3f rad, score %.2f\n", at_mm.x, at_mm.y,
              at_mm.z, turn_rad + error_rad, match.score);
  const bool is_right = std::hypot(at_mm.x - 90.0, at_mm.y - 82.0) < 0.5 &&
                        std::fabs(at_mm.z - kHeight_mm) < 0.2 && std::fabs(error_rad) < 0.02;
  return is_right ? 0 : fail("found elsewhere");
}
