#include "port/sim/simulate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "port/sim/random.hpp"
#include "port/sim/visible.hpp"
#include "port/sim/world.hpp"

namespace flatpose::sim {
namespace {

constexpr int kUnseen = -2;

/// One laser ray: how far its light goes, and which face the camera sees it on.
struct Reading {
  double range_mm = 0.0;
  int surface = kUnseen;
};

Reading read(const World& world, const Ruler& ruler, const Vec3& floor_mm) {
  const Ray ray{ruler.laser_mm(), normalized(floor_mm - ruler.laser_mm())};
  const Hit hit = world.cast(ray);
  const Vec3 p_mm = ray.origin_mm + hit.distance_mm * ray.direction;
  if (!ruler.faces_both(p_mm, hit.normal) || world.blocked(p_mm, ruler.camera_mm())) return {};
  constexpr int kFaces = 4;
  return {hit.distance_mm, (hit.body - kFloorBody) * kFaces + static_cast<int>(hit.face)};
}

class Scanner {
 public:
  Scanner(const World& world, const Ruler& ruler, std::uint64_t seed)
      : world_(world), ruler_(ruler), config_(ruler.config()), seed_(seed) {}

  std::vector<float> run() {
    readings_.reserve(static_cast<std::size_t>(config_.columns) * config_.rows);
    for (int row = 0; row < config_.rows; ++row) {
      for (int column = 0; column < config_.columns; ++column) {
        readings_.push_back(read(world_, ruler_, ruler_.floor_point_mm(column, row)));
      }
    }
    std::vector<float> xyz_mm(3 * readings_.size(), std::numeric_limits<float>::quiet_NaN());
    for (int row = 0; row < config_.rows; ++row) {
      for (int column = 0; column < config_.columns; ++column) {
        measure(column, row, &xyz_mm[3 * index(column, row)]);
      }
    }
    return xyz_mm;
  }

 private:
  [[nodiscard]] std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * config_.columns + column;
  }

  /// Whether the footprint may hold more than one face, judged by the pixels it reaches.
  [[nodiscard]] bool near_step(int column, int row) const {
    const auto reach = [&](double pitch_mm) {
      return static_cast<int>(std::ceil(0.5 * config_.footprint_mm / pitch_mm));
    };
    const int reach_x = reach(ruler_.pitch_x_mm());
    const int reach_y = reach(ruler_.pitch_y_mm());
    const int own = readings_[index(column, row)].surface;
    const int last_row = std::min(row + reach_y, config_.rows - 1);
    const int last_column = std::min(column + reach_x, config_.columns - 1);
    for (int r = std::max(row - reach_y, 0); r <= last_row; ++r) {
      for (int c = std::max(column - reach_x, 0); c <= last_column; ++c) {
        if (readings_[index(c, r)].surface != own) return true;
      }
    }
    return false;
  }

  /// Range at the mean height of what is seen of the footprint. Heights, not ranges, are averaged:
  /// a level face keeps its level however much of the footprint lies on it.
  [[nodiscard]] double mixed_range_mm(const Vec3& floor_mm) const {
    double share_sum = 0.0;  // of the way to the floor
    int count = 0;
    for (int y = -1; y <= 1; ++y) {
      for (int x = -1; x <= 1; ++x) {
        const double step_mm = config_.footprint_mm / 3.0;
        const Vec3 target_mm = floor_mm + Vec3{x * step_mm, y * step_mm, 0.0};
        const Reading reading = read(world_, ruler_, target_mm);
        if (reading.surface == kUnseen) continue;
        share_sum += reading.range_mm / norm(target_mm - ruler_.laser_mm());
        ++count;
      }
    }
    return share_sum / count * norm(floor_mm - ruler_.laser_mm());  // the middle one is seen
  }

  void measure(int column, int row, float* xyz_mm) const {
    const Reading& reading = readings_[index(column, row)];
    if (reading.surface == kUnseen) return;
    // All are drawn whatever becomes of them, so that one setting does not shift another's numbers.
    Random random(seed_, index(column, row));
    const bool lost = random.uniform() < config_.lost_share;
    const bool mixes = random.uniform() < config_.mixed_share;
    const auto noise = random.normal_pair();
    if (lost) return;
    const Vec3 floor_mm = ruler_.floor_point_mm(column, row);
    double range_mm = reading.range_mm;
    if (mixes && near_step(column, row)) range_mm = mixed_range_mm(floor_mm);
    const Vec3 laser_direction = normalized(floor_mm - ruler_.laser_mm());
    const Vec3 seen_mm = ruler_.laser_mm() + range_mm * laser_direction;
    const Vec3 camera_direction = normalized(seen_mm - ruler_.camera_mm());
    range_mm += config_.laser_noise_mm * noise.first;
    const double step_mm = config_.quantisation_mm;
    if (step_mm > 0.0) range_mm = step_mm * std::floor(range_mm / step_mm + 0.5);
    const Vec3 p_mm = ruler_.laser_mm() + range_mm * laser_direction +
                      (config_.camera_noise_mm * noise.second) * camera_direction;
    xyz_mm[0] = static_cast<float>(p_mm.x);
    xyz_mm[1] = static_cast<float>(p_mm.y);
    xyz_mm[2] = static_cast<float>(p_mm.z);
  }

  const World& world_;
  const Ruler& ruler_;
  const SensorConfig& config_;
  std::uint64_t seed_;
  std::vector<Reading> readings_;
};

}  // namespace

RangeImageView SimulatedScan::view() const noexcept {
  constexpr std::ptrdiff_t kPointBytes = 3 * sizeof(float);
  return {xyz_mm.data(), xyz_mm.data() + 1, xyz_mm.data() + 2,     width_px,
          height_px,     kPointBytes,       kPointBytes * width_px};
}

SimulatedScan simulate(const SceneConfig& scene, const SensorConfig& sensor, std::uint64_t seed) {
  return scan(make_scene(scene, sensor, seed), sensor, seed);
}

SimulatedScan scan(const Scene& scene, const SensorConfig& sensor, std::uint64_t seed) {
  const Ruler ruler(sensor);
  const World world(scene);
  SimulatedScan result;
  result.width_px = sensor.columns;
  result.height_px = sensor.rows;
  result.xyz_mm = Scanner(world, ruler, seed).run();
  result.viewpoint_mm = ruler.camera_mm();
  result.scene = scene.name;
  result.part = scene.part;
  result.seed = seed;
  VisibleShare visible(world, ruler);
  for (const Instance& instance : scene.instances) {
    result.instances.push_back({instance.part->name, instance.scan_T_object, visible.of(instance)});
  }
  return result;
}

}  // namespace flatpose::sim
