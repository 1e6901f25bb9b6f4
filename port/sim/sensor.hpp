#pragma once
// A sheet-of-light ruler (Ingberg 2015, 3.2.1): a mirror sweeps a sheet of laser light over the
// scene, a camera beside it watches where the light falls, and the two angles give the point.
//
//            laser L . . . . . . . C camera      scan frame: floor z = 0, z up, the field about
//                    |\          .'              the origin. Rows are steps of the sweep, along y;
//                    | \       .'                columns lie along x. L and C are stand_off above
//      z             |  \    .'                  the floor at x = 0, apart along y.
//      |        _____|___\ .'____
//      |_ y          floor  P                    A point needs light and sight: both occlude.
//
// L, C and a column of the camera lie in one plane, so each (column, row) is one ray of laser
// light. It meets the floor on a regular grid; what stands above the floor is met nearer to L.

#include <string>

#include "flatpose/core/maths.hpp"
#include "flatpose/geometry/vec3.hpp"

namespace flatpose::sim {

inline constexpr int kPointsMax = 1 << 21;  // two megapixels

struct SensorConfig {
  int columns = 600;             ///< Points along x; >= 2. Cost: time and memory, linear.
  int rows = 500;                ///< Points along y, the sweep; >= 2. columns x rows <= kPointsMax.
  double field_x_mm = 600.0;     ///< Width of the grid on the floor, a pitch per point; > 0.
  double field_y_mm = 500.0;     ///< Depth of the grid on the floor; > 0.
  double stand_off_mm = 1300.0;  ///< Height of laser and camera over the floor; > 0.
  double laser_angle_rad = 0.0;  ///< Of the laser from the vertical at the field's middle, toward
                                 ///< +y; within +-1.
  double camera_angle_rad =
      22.0 * kRadPerDeg;          ///< Of the camera, likewise; apart from the laser's.
  double laser_noise_mm = 0.4;    ///< Sigma along the laser ray (where the camera saw it); >= 0.
  double camera_noise_mm = 0.12;  ///< Sigma along the camera ray (where the laser was); >= 0.
  double lost_share = 0.01;       ///< Of the points that would be seen; 0 to 1.
  double footprint_mm = 1.0;      ///< Side of the square on the floor that one point sees; >= 0.
  double mixed_share = 0.5;       ///< Of the points whose square holds a step: those that come out
                                  ///< as the mean of what the square shows, along the ray; 0 to 1.
  double quantisation_mm = 0.05;  ///< Step of the range along the laser ray; 0: none.
  double incidence_max_rad = 85.0 * kRadPerDeg;  ///< A face more oblique than this to laser or
                                                 ///< camera shows nothing; 0 to pi / 2.
};

/// What is wrong with it; empty when nothing is.
[[nodiscard]] std::string validate(const SensorConfig& config);

/// Where laser, camera and rays are.  Frames: scan.
class Ruler {
 public:
  /// Fails: std::invalid_argument with the reason of validate().
  explicit Ruler(const SensorConfig& config);

  [[nodiscard]] const SensorConfig& config() const noexcept { return config_; }
  [[nodiscard]] const Vec3& laser_mm() const noexcept { return laser_mm_; }
  [[nodiscard]] const Vec3& camera_mm() const noexcept { return camera_mm_; }
  [[nodiscard]] double pitch_x_mm() const noexcept { return config_.field_x_mm / config_.columns; }
  [[nodiscard]] double pitch_y_mm() const noexcept { return config_.field_y_mm / config_.rows; }
  /// Where the laser ray of a pixel meets the floor.
  [[nodiscard]] Vec3 floor_point_mm(int column, int row) const noexcept;
  /// Whether some laser ray of the sweep goes through the point.
  [[nodiscard]] bool in_field(const Vec3& p_mm) const noexcept;
  /// Whether a face is turned to laser and camera enough to be seen by both.
  [[nodiscard]] bool faces_both(const Vec3& p_mm, const Vec3& normal) const noexcept;

 private:
  SensorConfig config_;
  Vec3 laser_mm_;
  Vec3 camera_mm_;
  double incidence_cos_min_;
};

}  // namespace flatpose::sim
