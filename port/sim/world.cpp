#include "port/sim/world.hpp"

#include <algorithm>

namespace flatpose::sim {

World::World(const Scene& scene) {
  for (const Instance& instance : scene.instances) add(instance);
  for (const Instance& fixture : scene.fixtures) add(fixture);
}

void World::add(const Instance& instance) {
  const Solid& solid = solid_of(instance.part);
  const double radius_mm = solid.sphere_radius_mm();
  bodies_.push_back({&solid, instance.scan_T_object, instance.scan_T_object.inverse(),
                     instance.scan_T_object * solid.sphere_center_mm(), radius_mm * radius_mm});
}

const Solid& World::solid_of(const std::shared_ptr<const Part>& part) {
  for (const auto& known : solids_) {
    if (&known->part() == part.get()) return *known;
  }
  solids_.push_back(std::make_unique<Solid>(part));
  return *solids_.back();
}

bool World::may_meet(const Body& body, const Ray& ray) noexcept {
  const Vec3 to_center = body.center_mm - ray.origin_mm;
  const double along_mm = dot(to_center, ray.direction);
  return dot(to_center, to_center) - along_mm * along_mm <= body.radius_squared_mm2;
}

Ray World::in_object(const Body& body, const Ray& ray) noexcept {
  return {body.object_T_scan * ray.origin_mm, body.object_T_scan.rotation * ray.direction};
}

Hit World::cast(const Ray& ray) const {
  Hit nearest;
  nearest.distance_mm = -ray.origin_mm.z / ray.direction.z;
  nearest.normal = {0, 0, 1};
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const Body& body = bodies_[i];
    if (!may_meet(body, ray)) continue;
    const auto hit = body.solid->first_hit(in_object(body, ray), 0.0, nearest.distance_mm);
    if (!hit || hit->distance_mm >= nearest.distance_mm) continue;
    nearest = {hit->distance_mm, body.scan_T_object.rotation * hit->normal, static_cast<int>(i),
               hit->face};
  }
  return nearest;
}

bool World::blocked(const Vec3& from_mm, const Vec3& to_mm) const {
  constexpr double kHairMm = 1e-5;
  const double length_mm = norm(to_mm - from_mm);
  const Ray ray{from_mm, normalized(to_mm - from_mm)};
  return std::any_of(bodies_.begin(), bodies_.end(), [&](const Body& body) {
    return may_meet(body, ray) &&
           body.solid->first_hit(in_object(body, ray), kHairMm, length_mm - kHairMm).has_value();
  });
}

}  // namespace flatpose::sim
