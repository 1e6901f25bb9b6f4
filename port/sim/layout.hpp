#pragma once
// A scene while it is being laid out, and the builders of all scenes.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "port/sim/random.hpp"
#include "port/sim/scene.hpp"

namespace flatpose::sim {

class Layout {
 public:
  Layout(const SceneConfig& scene, const SensorConfig& sensor, std::uint64_t seed);

  /// The part of the catalogue; the same object for the same name.
  [[nodiscard]] std::shared_ptr<const Part> part(const std::string& name);
  /// The names of what lies about the target: neither it nor cylinders, which are no clutter.
  [[nodiscard]] std::vector<std::string> other_names() const;

  /// Lays the part flat on the floor, clear of all others. False when there is no room.
  bool place(const std::shared_ptr<const Part>& part, std::optional<double> turn_rad = {});
  /// Fails: std::runtime_error.
  void place_or_throw(const std::shared_ptr<const Part>& part, std::optional<double> turn_rad = {});
  /// Whether the whole part lies in the field and between the walls.
  [[nodiscard]] bool inside(const Instance& instance) const;
  [[noreturn]] void no_room(const std::string& what) const;

  const SceneConfig& config;
  Ruler ruler;
  Random random;
  std::shared_ptr<const Part> target;
  Scene result;

 private:
  [[nodiscard]] bool has_room(const Vec3& p_mm, double reach_mm, double raised_mm) const;

  std::vector<std::shared_ptr<const Part>> parts_;
};

// Parts apart from each other (flat_scenes.cpp).
void build_single(Layout& layout);
void build_lone(Layout& layout);
void build_low(Layout& layout);
void build_tilt(Layout& layout);
void build_empty(Layout& layout);
// Standing cylinders (cylinder_scenes.cpp).
void build_cyl_loose(Layout& layout);
void build_cyl_grid(Layout& layout);
void build_cyl_brick(Layout& layout);
// Parts on each other (heaped_scenes.cpp).
void build_medium(Layout& layout);
void build_high(Layout& layout);
void build_pile(Layout& layout);
void build_absent(Layout& layout);
void build_steep(Layout& layout);
void build_buried(Layout& layout);

}  // namespace flatpose::sim
