#include "port/sim/visible.hpp"

#include <algorithm>
#include <cmath>

namespace flatpose::sim {
namespace {

bool sees(const World& world, const Ruler& ruler, const Vec3& p_mm, const Vec3& normal) {
  return ruler.in_field(p_mm) && ruler.faces_both(p_mm, normal) &&
         !world.blocked(p_mm, ruler.laser_mm()) && !world.blocked(p_mm, ruler.camera_mm());
}

/// A square grid over the top.  Frames: object.
std::vector<Vec3> top_grid_mm(const Part& part, int samples) {
  const double pitch_mm = std::sqrt(area_mm2(part) / samples);
  const int reach = static_cast<int>(std::ceil(radius_mm(part) / pitch_mm));
  std::vector<Vec3> points_mm;
  for (int j = -reach; j < reach; ++j) {
    const TopRow row(part, (j + 0.5) * pitch_mm);
    for (int i = -reach; i < reach; ++i) {
      const Vec2 p{(i + 0.5) * pitch_mm, (j + 0.5) * pitch_mm};
      if (const auto height_mm = row.height_mm(p.x)) points_mm.push_back({p.x, p.y, *height_mm});
    }
  }
  return points_mm;
}

}  // namespace

double VisibleShare::of(const Instance& instance, int samples) {
  const std::vector<Vec3>& points_mm = top_points_mm(instance.part, samples);
  if (points_mm.empty()) return 0.0;
  const Vec3 normal = instance.scan_T_object.rotation.column(2);
  const auto seen = std::count_if(points_mm.begin(), points_mm.end(), [&](const Vec3& p_mm) {
    return sees(world_, ruler_, instance.scan_T_object * p_mm, normal);
  });
  return static_cast<double>(seen) / static_cast<double>(points_mm.size());
}

const std::vector<Vec3>& VisibleShare::top_points_mm(const std::shared_ptr<const Part>& part,
                                                     int samples) {
  auto& points_mm = points_mm_[{part, samples}];
  if (points_mm.empty()) points_mm = top_grid_mm(*part, samples);
  return points_mm;
}

}  // namespace flatpose::sim
