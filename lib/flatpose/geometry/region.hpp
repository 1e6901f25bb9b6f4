#pragma once
// A region of interest in the x and y of the frame at the face: everything, a circle, a box or a
// polygon.

#include <array>

namespace flatpose {

struct Region {
  enum class Kind { kAll, kCircle, kBox, kPolygon };
  static constexpr int kVertexCountMax = 64;

  Kind kind = Kind::kAll;
  double x_mm = 0.0;  ///< Centre of the circle.
  double y_mm = 0.0;
  double radius_mm = 0.0;
  std::array<double, kVertexCountMax>
      vertex_x_mm{};  ///< Corners of the polygon; the box has two opposite ones.
  std::array<double, kVertexCountMax> vertex_y_mm{};
  int vertex_count = 0;

  /// Border included for circle and box; the even-odd rule for the polygon.
  [[nodiscard]] bool contains(double x, double y) const noexcept;
  /// To the nearest point of the border, from either side; infinite without one.
  [[nodiscard]] double border_distance_mm(double x, double y) const noexcept;
};

/// The smallest box around a region that is not kAll.
struct Box {
  double x0_mm = 0.0;
  double y0_mm = 0.0;
  double x1_mm = 0.0;
  double y1_mm = 0.0;
};
[[nodiscard]] Box bounding_box(const Region& region) noexcept;

/// Whether the numbers are finite and enclose an area.
[[nodiscard]] bool is_valid(const Region& region) noexcept;

}  // namespace flatpose
