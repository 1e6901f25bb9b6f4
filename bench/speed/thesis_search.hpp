#pragma once
// The grid search as Ingberg 2015 has it (2.6.1, 2.6.2, 2.8.2, 2.10; measured there in table 4.1):
// every position takes the closest of the tilts made beforehand, and for every angle each control
// point is projected and looked up, one after the other, in a chamfer image or a normal image of
// floats. It is the peer that ours is held against, and built with -O2 and nothing more.
//
// To be quick in its own terms: images have a margin, so no look-up is checked; the part is flat,
// so a point takes a 2x2 matrix; |n - t|^2 of unit vectors is 2 - 2 n.t; matrices are made
// beforehand, and so is the tilt of every position, as the table's times leave pre-computations
// out. Two forms:
//   kProjecting   as it is written: a hypothesis projects and turns its points
//   kTabled       offsets and turned normals of all tilts and angles lie in tables: the quickest
//                 that a scalar search can be, of which the thesis says nothing

#include <cstdint>
#include <span>
#include <vector>

namespace flatpose::bench::thesis {

struct Normal {
  float x = 0.0F;
  float y = 0.0F;
  float z = 1.0F;
  float unused = 0.0F;
};

inline constexpr std::uint16_t kNoHypothesis = 0xFFFF;

/// The live image's pre-computations, with a margin all round.
struct Images {
  int width_px = 0;  ///< Without the margin.
  int height_px = 0;
  int margin_px = 0;  ///< No control point lies farther from the position.
  std::vector<float> chamfer_px;
  std::vector<Normal> normal;
  std::vector<std::uint16_t> tilt;  ///< Of every position, without the margin: an index of tilts,
                                    ///< or kNoHypothesis.

  [[nodiscard]] std::int32_t row_px() const { return width_px + 2 * margin_px; }
  [[nodiscard]] std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row + margin_px) * static_cast<std::size_t>(row_px()) +
           static_cast<std::size_t>(column + margin_px);
  }
};

/// The sparse template: where points lie from the position, in pixels.
struct EdgePoint {
  float x = 0.0F;
  float y = 0.0F;
};
struct SurfacePoint {
  float x = 0.0F;
  float y = 0.0F;
  Normal normal;
};
struct Cloud {
  std::vector<EdgePoint> edge;
  std::vector<SurfacePoint> surface;
};

/// A rotation of the cloud, row by row.
struct Turn {
  float m[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
};

struct TabledSurface {
  std::int32_t offset = 0;
  Normal normal;
};

/// What is made beforehand for one tilt.
struct Tilt {
  float cos_tilt = 1.0F;
  std::vector<Turn> turns;                    ///< By angle.
  std::vector<std::int32_t> edge_offset;      ///< kTabled: by angle, then by point.
  std::vector<TabledSurface> surface_offset;  ///< As above.
};

/// Fills the tables for kTabled.
void make_tables(const Images& images, const Cloud& cloud, Tilt& tilt);

struct Hypothesis {
  float error = 0.0F;
  int column = 0;
  int row = 0;
  int angle = 0;
};
inline constexpr std::size_t kKept = 10;  // the thesis's n

enum class Form { kProjecting, kTabled };

/// All positions, all angles; the best are given back, best first.
/// `tilts` is indexed by Images::tilt; those that occur must be filled.
[[nodiscard]] std::vector<Hypothesis> search(const Images& images, const Cloud& cloud,
                                             std::span<const Tilt> tilts, Form form);

}  // namespace flatpose::bench::thesis
