#pragma once
// An edge of a height map: where the height falls off, and to which side.

#include <cstdint>

namespace flatpose::image {

enum class EdgeKind : std::uint8_t {
  kNone = 0,
  kJump = 1,  ///< The height falls by a step.
  kMissingBorder =
      2,        ///< A step down into missing data (a shadow), which stands for something lower.
  kCrease = 3,  ///< The slope changes, the height does not jump.
};

/// One edge pixel with its place to a fraction of a cell.
struct EdgePoint {
  float x_px = 0.0F;  ///< Sub-pixel column of the edge.
  float y_px = 0.0F;
  float dx = 0.0F;  ///< Unit direction in which the height falls (for a crease: toward the lower
                    ///< side of the bend).
  float dy = 0.0F;
  float step_mm = 0.0F;  ///< How far it falls (for a crease: 0).
  std::int16_t column = 0;
  std::int16_t row = 0;
  EdgeKind kind = EdgeKind::kNone;
};

inline constexpr int kOctantCount = 8;

/// The eighth of the circle that a direction points to: 0 is +x, counted toward +y, each centred on
/// its direction.
[[nodiscard]] int octant_of(float dx, float dy) noexcept;

}  // namespace flatpose::image
