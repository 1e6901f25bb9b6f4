#pragma once
// A scene as rays meet it: the floor, the parts and the fixtures.  Frames: scan.

#include <vector>

#include "port/sim/scene.hpp"
#include "port/sim/solid.hpp"

namespace flatpose::sim {

inline constexpr int kFloorBody = -1;

struct Hit {
  double distance_mm = 0.0;
  Vec3 normal;
  int body = kFloorBody;  ///< Index into instances, then fixtures; kFloorBody for the floor.
  Face face = Face::kTop;
};

class World {
 public:
  World() = default;
  explicit World(const Scene& scene);

  void add(const Instance& instance);
  /// The body added last.  Limits: there is one.
  void remove_last() { bodies_.pop_back(); }
  /// Made when first asked for, or when the part is first added.
  [[nodiscard]] const Solid& solid_of(const std::shared_ptr<const Part>& part);

  /// What a ray that points down meets first; the floor is everywhere.
  [[nodiscard]] Hit cast(const Ray& ray) const;
  /// Whether any body lies between two points. Both ends are shortened by a hair, so that the face
  /// a point lies on does not hide it.  The floor hides nothing here.
  [[nodiscard]] bool blocked(const Vec3& from_mm, const Vec3& to_mm) const;

 private:
  struct Body {
    const Solid* solid;
    Pose scan_T_object;
    Pose object_T_scan;
    Vec3 center_mm;
    double radius_squared_mm2;
  };
  static bool may_meet(const Body& body, const Ray& ray) noexcept;
  static Ray in_object(const Body& body, const Ray& ray) noexcept;

  std::vector<std::unique_ptr<Solid>> solids_;  // one a part, however many lie about
  std::vector<Body> bodies_;
};

}  // namespace flatpose::sim
