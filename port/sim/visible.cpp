#include "port/sim/visible.hpp"

#include <cmath>

namespace flatpose::sim {
namespace {

bool sees(const World& world, const Ruler& ruler, const Vec3& p_mm, const Vec3& normal) {
  return ruler.in_field(p_mm) && ruler.faces_both(p_mm, normal) &&
         !world.blocked(p_mm, ruler.laser_mm()) && !world.blocked(p_mm, ruler.camera_mm());
}

}  // namespace

double visible_share(const World& world, const Ruler& ruler, const Instance& instance,
                     double samples) {
  const Part& part = *instance.part;
  const double pitch_mm = std::sqrt(area_mm2(part) / samples);
  const int reach = static_cast<int>(std::ceil(radius_mm(part) / pitch_mm));
  const Vec3 normal = instance.scan_T_object.rotation.column(2);
  int all = 0;
  int seen = 0;
  for (int j = -reach; j < reach; ++j) {
    for (int i = -reach; i < reach; ++i) {
      const Vec2 p{(i + 0.5) * pitch_mm, (j + 0.5) * pitch_mm};
      const auto height_mm = top_height_mm(part, p);
      if (!height_mm) continue;
      ++all;
      if (sees(world, ruler, instance.scan_T_object * Vec3{p.x, p.y, *height_mm}, normal)) ++seen;
    }
  }
  return all > 0 ? static_cast<double>(seen) / all : 0.0;
}

}  // namespace flatpose::sim
