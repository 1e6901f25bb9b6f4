#pragma once
// Lays one sparse template on plane after plane, at angle after angle: what depends on neither is
// worked out once.

#include "flatpose/core/vector_path.hpp"
#include "flatpose/geometry/pose.hpp"
#include "flatpose/search/lay_points.hpp"
#include "flatpose/search/score.hpp"

namespace flatpose::search {

/// A plane as a template is laid on it.
struct Tilt {
  double slope_x = 0.0;
  double slope_y = 0.0;
  Vec3 normal;
  Rotation rotation;  ///< Tilts without turning.
};

[[nodiscard]] Tilt tilt_of(double slope_x, double slope_y) noexcept;

/// Cost: some 5 ns a point and call of at().  Memory: 2 KiB, its own.  Thread: at() is reentrant.
class Projector {
 public:
  /// `with_normals`: the surface's expected normals too, which a search by height does not read.
  Projector(const model::Template& part, const model::Anchor& anchor, const SearchImages& images,
            const ScoreConfig& config, bool with_normals,
            VectorPath path = VectorPath::kPortable) noexcept;

  /// As project() has it; `turn` about z comes before the tilt.
  [[nodiscard]] ProjectedTemplate at(const Tilt& tilt, const Rotation& turn) const noexcept;
  /// How far from the place its points lie, at any tilt.
  [[nodiscard]] double reach_px() const noexcept;

 private:
  void add_contour(const LaidPoints& laid, ProjectedTemplate& projected) const noexcept;
  void add_surface(const Rotation& work_R_object, const LaidPoints& laid,
                   ProjectedTemplate& projected) const noexcept;

  const SearchImages& images_;
  bool with_normals_;
  LayPoints lay_;
  PointSet points_;
};

}  // namespace flatpose::search
