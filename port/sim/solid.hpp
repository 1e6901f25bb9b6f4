#pragma once
// Where a ray enters a part. The ray is cut at every edge of the outline and the areas it passes;
// between two cuts the part is a slab of constant height, so the answer is exact.
//
// Most rays pass no edge: a grid over the outline tells them apart. A cell that no edge touches
// stores its height; each row of cells knows the edges in it, and rays ask no others.

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "flatpose/geometry/vec3.hpp"
#include "port/sim/part.hpp"

namespace flatpose::sim {

struct Ray {
  Vec3 origin_mm;
  Vec3 direction;  ///< Unit length.
};

enum class Face { kTop, kSide, kBottom, kInside };

struct SolidHit {
  double distance_mm = 0.0;
  Vec3 normal;  ///< Out of the material.
  Face face = Face::kTop;
};

class Solid {
 public:
  explicit Solid(std::shared_ptr<const Part> part);

  /// The first point of the part at a distance in [from_mm, to_mm]; kInside when the ray starts
  /// in the material.  Frames: object.  Thread: reentrant.  Cost: a few ns over no edge, else
  /// linear in the edges of the rows of cells that the ray passes.
  [[nodiscard]] std::optional<SolidHit> first_hit(const Ray& ray, double from_mm,
                                                  double to_mm) const;
  [[nodiscard]] const Part& part() const noexcept { return *part_; }
  /// The sphere about the middle of the part's box.  Frames: object.
  [[nodiscard]] const Vec3& sphere_center_mm() const noexcept { return sphere_center_mm_; }
  [[nodiscard]] double sphere_radius_mm() const noexcept { return sphere_radius_mm_; }

 private:
  struct Edge {
    Vec2 from;
    Vec2 along;
    int loop;  // 0: the outer one, then holes, then areas
  };
  struct Interval {
    double from_mm;
    double to_mm;
  };
  struct Cut {
    double distance_mm;
    const Edge* edge;
  };
  static constexpr double kNoPart = -std::numeric_limits<double>::infinity();

  void add_edges(const Loop& loop, int loop_index);
  void build_grid();
  void mark(int edge_index);
  [[nodiscard]] int row_of(double y_mm) const noexcept;
  [[nodiscard]] double height_at(Vec2 p_mm) const noexcept;
  [[nodiscard]] std::optional<Interval> clip_to_box(const Ray& ray, Interval range) const noexcept;
  [[nodiscard]] std::optional<double> height_without_edges(const Ray& ray,
                                                           Interval range) const noexcept;
  static void add_cut(const Edge& edge, const Ray& ray, Interval range, std::vector<Cut>& cuts);
  void find_cuts(const Ray& ray, Interval range, std::vector<Cut>& cuts) const;
  [[nodiscard]] std::optional<SolidHit> enter(const Ray& ray, Interval range, double height_mm,
                                              const Edge* edge) const noexcept;

  std::shared_ptr<const Part> part_;
  std::vector<Edge> edges_;
  Vec3 low_mm_;   // the box, with a margin: no face of the part lies in a face of the box
  Vec3 high_mm_;  // (a ray that starts on the box's border would not know which face it entered)
  Vec3 sphere_center_mm_;
  double sphere_radius_mm_ = 0.0;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<std::vector<int>> row_edges_;  // by row of cells
  std::vector<double> cells_;                // height, kNoPart, or NaN where an edge touches
};

}  // namespace flatpose::sim
