#include "port/sim/sensor.hpp"

#include <cmath>
#include <cstdint>
#include <stdexcept>

namespace flatpose::sim {
namespace {

bool in_range(double value, double low, double high) {  // false for NaN
  return value >= low && value <= high;
}

double tangent(double angle_rad) {
  const auto [s, c] = sin_cos(angle_rad);
  return s / c;
}

}  // namespace

std::string validate(const SensorConfig& c) {
  constexpr double kFarMm = 1e5;
  if (c.columns < 2 || c.rows < 2) return "columns and rows must be at least 2";
  if (std::int64_t{c.columns} * c.rows > kPointsMax) return "more than 2097152 points";
  if (!in_range(c.field_x_mm, 1.0, kFarMm) || !in_range(c.field_y_mm, 1.0, kFarMm)) {
    return "field_x_mm and field_y_mm must be 1 to 100000";
  }
  if (!in_range(c.stand_off_mm, 1.0, kFarMm)) return "stand_off_mm must be 1 to 100000";
  if (!in_range(c.laser_angle_rad, -1.0, 1.0) || !in_range(c.camera_angle_rad, -1.0, 1.0)) {
    return "laser_angle_rad and camera_angle_rad must be -1 to 1";
  }
  if (!(std::fabs(c.laser_angle_rad - c.camera_angle_rad) > 1e-3)) {
    return "laser and camera must look from different angles";
  }
  if (!in_range(c.laser_noise_mm, 0.0, kFarMm) || !in_range(c.camera_noise_mm, 0.0, kFarMm)) {
    return "laser_noise_mm and camera_noise_mm must be 0 or more";
  }
  if (!in_range(c.lost_share, 0.0, 1.0)) return "lost_share must be 0 to 1";
  if (!in_range(c.mixed_share, 0.0, 1.0)) return "mixed_share must be 0 to 1";
  if (!in_range(c.footprint_mm, 0.0, 50.0)) return "footprint_mm must be 0 to 50";
  if (!in_range(c.quantisation_mm, 0.0, kFarMm)) return "quantisation_mm must be 0 or more";
  if (!in_range(c.incidence_max_rad, 0.0, kPi / 2.0)) return "incidence_max_rad must be 0 to pi/2";
  return {};
}

Ruler::Ruler(const SensorConfig& config) : config_(config) {
  if (const std::string why = validate(config); !why.empty()) {
    throw std::invalid_argument("sensor: " + why);
  }
  laser_mm_ = {0.0, config.stand_off_mm * tangent(config.laser_angle_rad), config.stand_off_mm};
  camera_mm_ = {0.0, config.stand_off_mm * tangent(config.camera_angle_rad), config.stand_off_mm};
  incidence_cos_min_ = sin_cos(config.incidence_max_rad).cos;
}

Vec3 Ruler::floor_point_mm(int column, int row) const noexcept {
  return {(column - 0.5 * (config_.columns - 1)) * pitch_x_mm(),
          (row - 0.5 * (config_.rows - 1)) * pitch_y_mm(), 0.0};
}

bool Ruler::in_field(const Vec3& p_mm) const noexcept {
  if (!(p_mm.z < laser_mm_.z)) return false;
  const double stretch = laser_mm_.z / (laser_mm_.z - p_mm.z);
  const Vec3 floor_mm = laser_mm_ + stretch * (p_mm - laser_mm_);
  return std::fabs(floor_mm.x) <= 0.5 * config_.field_x_mm &&
         std::fabs(floor_mm.y) <= 0.5 * config_.field_y_mm;
}

bool Ruler::faces_both(const Vec3& p_mm, const Vec3& normal) const noexcept {
  const auto faces = [&](const Vec3& from_mm) {
    const double cosine = dot(normalized(from_mm - p_mm), normal);
    return cosine > 0.0 && cosine >= incidence_cos_min_;
  };
  return faces(laser_mm_) && faces(camera_mm_);
}

}  // namespace flatpose::sim
