#include "port/sim/settle.hpp"

#include <algorithm>
#include <cmath>

#include "port/sim/support_plane.hpp"

namespace flatpose::sim {
namespace {

constexpr int kStepsMax = 12;     // rests that come at all come within seven
constexpr int kCoarseStride = 4;  // of the rim points, until the lean is about right
constexpr double kCoarseEnoughMm = 0.5;
constexpr double kLeanMaxRad = 65.0 * kRadPerDeg;  // no rest comes of it; slopes stay finite
constexpr double kHoldsMin = 0.5;   // upright share of the normal where two touch: 60 degrees
constexpr double kHighMm = 5000.0;  // over every heap

}  // namespace

void Heap::add(const Instance& instance) {
  world_.add(instance);
  const Shape& shape = shape_of(instance.part);
  const bool upright = instance.scan_T_object.rotation.column(2).z > 0.0;
  Body body;
  body.center_mm = instance.scan_T_object * shape.solid->sphere_center_mm();
  body.radius_mm = shape.solid->sphere_radius_mm();
  for (const Vec3& p_mm : upright ? shape.rims.top_mm : shape.rims.bottom_mm) {
    body.upper_rim_mm.push_back(instance.scan_T_object * p_mm);
  }
  bodies_.push_back(std::move(body));
}

void Heap::remove_last() {
  world_.remove_last();
  bodies_.pop_back();
}

const Heap::Shape& Heap::shape_of(const std::shared_ptr<const Part>& part) {
  for (const auto& known : shapes_) {
    if (known->part == part) return *known;
  }
  shapes_.push_back(std::make_unique<Shape>(
      Shape{part, &world_.solid_of(part), rims(*part), center_of_mass_mm(*part)}));
  return *shapes_.back();
}

/// A part on its way to rest.
class Settling {
 public:
  Settling(Heap& heap, const Drop& drop)
      : heap_(heap), shape_(heap.shape_of(drop.part)), drop_(drop) {
    center_mm_ = {drop.x_mm, drop.y_mm, 0.5 * kHighMm};
    for (const Heap::Body& body : heap.bodies_) {
      const double dx = body.center_mm.x - drop.x_mm;
      const double dy = body.center_mm.y - drop.y_mm;
      const double reach_mm = body.radius_mm + 2.0 * shape_.solid->sphere_radius_mm();
      if (dx * dx + dy * dy < reach_mm * reach_mm) near_.push_back(&body);
    }
  }

  std::optional<Rest> run(double tilt_max_rad) {
    int stride = kCoarseStride;
    for (int step = 0; step < kStepsMax; ++step) {
      find_gaps(stride);
      const auto plane = lowest_plane(gaps_);
      if (!plane) return std::nullopt;
      const double change_mm = apply(*plane);
      if (tilt_rad() > kLeanMaxRad) return std::nullopt;
      if (stride == 1 && change_mm < kRestErrorMm) {
        if (tilt_rad() > tilt_max_rad || !holds(*plane)) return std::nullopt;
        return rest(*plane);
      }
      stride = change_mm < kCoarseEnoughMm ? 1 : kCoarseStride;
    }
    return std::nullopt;  // it rocks between two leans
  }

 private:
  [[nodiscard]] Vec3 up() const { return normalized({-slope_x_, -slope_y_, 1.0}); }
  [[nodiscard]] double tilt_rad() const { return arc_cosine(up().z); }

  [[nodiscard]] Pose pose() const {
    Rotation rotation = tilt_rotation(up()) * rotation_about_z(drop_.turn_rad);
    if (drop_.upside_down) rotation = rotation * Rotation{{1, 0, 0, 0, -1, 0, 0, 0, -1}};
    return {rotation, center_mm_ - rotation * shape_.center_of_mass_mm};
  }

  /// What lies between the part and the heap, as points under which the part may not come: x and y
  /// from the centre, z how far the part would have to rise to touch there (mostly below 0).
  void find_gaps(int stride) {
    gaps_.clear();
    under_.clear();
    const Pose scan_T_object = pose();
    const auto count = [](const std::vector<Vec3>& list) { return static_cast<int>(list.size()); };
    for (const auto* rim : {&shape_.rims.bottom_mm, &shape_.rims.top_mm}) {
      for (int i = 0; i < count(*rim); i += stride) add_own(scan_T_object * (*rim)[i]);
    }
    const Pose object_T_scan = scan_T_object.inverse();
    const Vec3 middle_mm = scan_T_object * shape_.solid->sphere_center_mm();
    for (const Heap::Body* body : near_) {
      for (int i = 0; i < count(body->upper_rim_mm); i += stride) {
        add_other(body->upper_rim_mm[i], middle_mm, object_T_scan);
      }
    }
  }

  /// `upright`: of the unit normal there, the part along z.
  void add_gap(const Vec3& heap_mm, double part_z_mm, double upright) {
    gaps_.push_back({heap_mm.x - center_mm_.x, heap_mm.y - center_mm_.y, heap_mm.z - part_z_mm});
    under_.push_back({heap_mm, std::fabs(upright) >= kHoldsMin});
  }

  void add_own(const Vec3& p_mm) {
    const Ray down{{p_mm.x, p_mm.y, kHighMm}, {0, 0, -1}};
    const Hit hit = heap_.world_.cast(down);
    add_gap({p_mm.x, p_mm.y, kHighMm - hit.distance_mm}, p_mm.z, hit.normal.z);
  }

  void add_other(const Vec3& p_mm, const Vec3& middle_mm, const Pose& object_T_scan) {
    const double dx = p_mm.x - middle_mm.x;
    const double dy = p_mm.y - middle_mm.y;
    const double radius_mm = shape_.solid->sphere_radius_mm();
    if (dx * dx + dy * dy > radius_mm * radius_mm) return;
    const Vec3 start_mm{p_mm.x, p_mm.y, middle_mm.z - 2.0 * radius_mm};
    const Ray ray{object_T_scan * start_mm, object_T_scan.rotation * Vec3{0, 0, 1}};
    const auto hit = shape_.solid->first_hit(ray, 0.0, 4.0 * radius_mm);
    if (hit) add_gap(p_mm, start_mm.z + hit->distance_mm, dot(hit->normal, ray.direction));
  }

  /// Lays the part onto the plane; how far that moved any of its points, about.
  double apply(const SupportPlane& plane) {
    center_mm_.z += plane.height_mm;
    slope_x_ += plane.slope_x;
    slope_y_ += plane.slope_y;
    return std::fabs(plane.height_mm) +
           shape_.solid->sphere_radius_mm() * (std::fabs(plane.slope_x) + std::fabs(plane.slope_y));
  }

  [[nodiscard]] bool holds(const SupportPlane& plane) const {
    return std::all_of(plane.touched.begin(), plane.touched.end(),
                       [&](int touched) { return under_[touched].holds; });
  }

  [[nodiscard]] Rest rest(const SupportPlane& plane) const {
    Rest rest{.scan_T_object = pose(),
              .tilt_rad = tilt_rad(),
              .contacts_mm = {},
              .center_of_mass_mm = center_mm_};
    for (int k = 0; k < 3; ++k) rest.contacts_mm[k] = under_[plane.touched[k]].p_mm;
    return rest;
  }

  Heap& heap_;
  const Heap::Shape& shape_;
  const Drop& drop_;
  std::vector<const Heap::Body*> near_;
  Vec3 center_mm_;  // of mass, in scan
  double slope_x_ = 0.0;
  double slope_y_ = 0.0;
  std::vector<Vec3> gaps_;
  struct Under {
    Vec3 p_mm;   // the heap's side of a gap, in scan
    bool holds;  // a steep side that leans on an edge does not: it would slip past
  };
  std::vector<Under> under_;
};

std::optional<Rest> settle(Heap& heap, const Drop& drop, double tilt_max_rad) {
  return Settling(heap, drop).run(tilt_max_rad);
}

}  // namespace flatpose::sim
