#pragma once
// How a part comes to rest when it is let down at a place onto what lies there already.
//
// It keeps its place and turn (its centre of mass goes straight down) and tilts until it rests on
// three contacts whose triangle holds the centre: the lowest plane over what lies under it
// (support_plane.hpp), asked for again and again since the footprint moves as the part tilts. Where
// the two are nearest is found by rays from rim points (rim.hpp), straight down from the part's and
// straight up from the others'.
//
// What it leaves out: what lies there does not move, nothing slides or rolls, and a part never gets
// under another. A lean that friction would not hold is for the caller to refuse.

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "port/sim/rim.hpp"
#include "port/sim/world.hpp"

namespace flatpose::sim {

/// How far a resting part may be off its contacts, or in what it rests on, at its rim points.
inline constexpr double kRestErrorMm = 0.02;

/// What lies there already.
class Heap {
 public:
  void add(const Instance& instance);
  /// The body added last.  Limits: there is one.
  void remove_last();
  [[nodiscard]] const World& world() const noexcept { return world_; }

 private:
  friend class Settling;
  struct Shape {
    std::shared_ptr<const Part> part;
    const Solid* solid;
    Rims rims;
    Vec3 center_of_mass_mm;
  };
  struct Body {
    Vec3 center_mm;
    double radius_mm;
    std::vector<Vec3> upper_rim_mm;  // in scan
  };
  const Shape& shape_of(const std::shared_ptr<const Part>& part);

  World world_;
  std::vector<std::unique_ptr<Shape>> shapes_;  // one a part
  std::vector<Body> bodies_;
};

struct Drop {
  std::shared_ptr<const Part> part;
  double x_mm = 0.0;  ///< Of the centre of mass.
  double y_mm = 0.0;
  double turn_rad = 0.0;
  bool upside_down = false;
};

struct Rest {
  Pose scan_T_object;
  double tilt_rad = 0.0;              ///< From lying level, whichever side is up.
  std::array<Vec3, 3> contacts_mm{};  ///< Their triangle, seen from above, holds the centre.
  Vec3 center_of_mass_mm;
};

/// Cost: about 3 ms in a heap.
/// Fails: none where the part finds no rest, none but leaning more than `tilt_max_rad`, or none but
/// with a side steeper than 60 degrees against an edge, past which it would slip.
[[nodiscard]] std::optional<Rest> settle(Heap& heap, const Drop& drop, double tilt_max_rad);

}  // namespace flatpose::sim
