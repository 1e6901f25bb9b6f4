#include "bench/speed/thesis_search.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace flatpose::bench::thesis {
namespace {

// To the nearest. Offsets lie far above the bias, so the conversion's cut is a floor.
inline std::int32_t rounded(float value) {
  constexpr std::int32_t kBias = 4096;
  return static_cast<std::int32_t>(value + (static_cast<float>(kBias) + 0.5F)) - kBias;
}

inline std::int32_t offset_of(const Turn& turn, float x, float y, std::int32_t row_px) {
  return rounded(turn.m[3] * x + turn.m[4] * y) * row_px + rounded(turn.m[0] * x + turn.m[1] * y);
}

inline Normal turned(const Turn& turn, const Normal& n) {
  const float* m = turn.m;
  return {m[0] * n.x + m[1] * n.y + m[2] * n.z, m[3] * n.x + m[4] * n.y + m[5] * n.z,
          m[6] * n.x + m[7] * n.y + m[8] * n.z, 0.0F};
}

inline float cosine(const Normal& a, const Normal& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// The edges' distances over the cosine of the tilt, and the sum of |n - t|^2.
inline float error_of(float edge, float over_cos_tilt, std::size_t surface_count, float cosines) {
  return edge * over_cos_tilt + 2.0F * (static_cast<float>(surface_count) - cosines);
}

/// The position's own pixel.
struct Cursor {
  const float* chamfer_px;
  const Normal* normal;
  std::int32_t row_px;
};

inline float projecting_error(const Cursor& at, const Cloud& cloud, const Turn& turn,
                              float over_cos_tilt) {
  float edge = 0.0F;
  for (const EdgePoint& p : cloud.edge) edge += at.chamfer_px[offset_of(turn, p.x, p.y, at.row_px)];
  float cosines = 0.0F;
  for (const SurfacePoint& p : cloud.surface) {
    const Normal& found = at.normal[offset_of(turn, p.x, p.y, at.row_px)];
    cosines += cosine(found, turned(turn, p.normal));
  }
  return error_of(edge, over_cos_tilt, cloud.surface.size(), cosines);
}

inline float tabled_error(const Cursor& at, const std::int32_t* edge_offset, int edge_count,
                          const TabledSurface* surface_offset, int surface_count,
                          float over_cos_tilt) {
  float edge = 0.0F;
  for (int i = 0; i < edge_count; ++i) edge += at.chamfer_px[edge_offset[i]];
  float cosines = 0.0F;
  for (int i = 0; i < surface_count; ++i)
    cosines += cosine(at.normal[surface_offset[i].offset], surface_offset[i].normal);
  return error_of(edge, over_cos_tilt, static_cast<std::size_t>(surface_count), cosines);
}

/// The best so far.
class Best {
 public:
  [[nodiscard]] float worst_error() const { return worst_error_; }
  void insert(const Hypothesis& h) {
    const auto at = std::upper_bound(
        kept_.begin(), kept_.end(), h,
        [](const Hypothesis& a, const Hypothesis& b) { return a.error < b.error; });
    kept_.insert(at, h);
    if (kept_.size() > kKept) kept_.pop_back();
    if (kept_.size() == kKept) worst_error_ = kept_.back().error;
  }
  [[nodiscard]] std::vector<Hypothesis> take() { return std::move(kept_); }

 private:
  std::vector<Hypothesis> kept_;
  float worst_error_ = std::numeric_limits<float>::max();
};

template <Form kForm>
void search_position(const Cursor& at, const Cloud& cloud, const Tilt& tilt, int column, int row,
                     Best& best) {
  const int edge_count = static_cast<int>(cloud.edge.size());
  const int surface_count = static_cast<int>(cloud.surface.size());
  const std::int32_t* edge = tilt.edge_offset.data();
  const TabledSurface* surface = tilt.surface_offset.data();
  const int angle_count = static_cast<int>(tilt.turns.size());
  const Turn* turns = tilt.turns.data();
  const float over_cos_tilt = 1.0F / tilt.cos_tilt;
  for (int angle = 0; angle < angle_count; ++angle) {
    float error = 0.0F;
    if constexpr (kForm == Form::kProjecting) {
      error = projecting_error(at, cloud, turns[angle], over_cos_tilt);
    } else {
      error = tabled_error(at, edge, edge_count, surface, surface_count, over_cos_tilt);
      edge += edge_count;
      surface += surface_count;
    }
    if (error < best.worst_error()) best.insert({error, column, row, angle});
  }
}

template <Form kForm>
std::vector<Hypothesis> search_all(const Images& images, const Cloud& cloud,
                                   std::span<const Tilt> tilts) {
  Best best;
  const std::uint16_t* tilt = images.tilt.data();
  for (int row = 0; row < images.height_px; ++row) {
    for (int column = 0; column < images.width_px; ++column) {
      const std::uint16_t its_tilt = *tilt++;
      if (its_tilt == kNoHypothesis) continue;
      const std::size_t index = images.index(column, row);
      const Cursor at{images.chamfer_px.data() + index, images.normal.data() + index,
                      images.row_px()};
      search_position<kForm>(at, cloud, tilts[its_tilt], column, row, best);
    }
  }
  return best.take();
}

}  // namespace

void make_tables(const Images& images, const Cloud& cloud, Tilt& tilt) {
  tilt.edge_offset.clear();
  tilt.surface_offset.clear();
  for (const Turn& turn : tilt.turns) {
    for (const EdgePoint& p : cloud.edge)
      tilt.edge_offset.push_back(offset_of(turn, p.x, p.y, images.row_px()));
    for (const SurfacePoint& p : cloud.surface) {
      tilt.surface_offset.push_back(
          {offset_of(turn, p.x, p.y, images.row_px()), turned(turn, p.normal)});
    }
  }
}

std::vector<Hypothesis> search(const Images& images, const Cloud& cloud,
                               std::span<const Tilt> tilts, Form form) {
  return form == Form::kProjecting ? search_all<Form::kProjecting>(images, cloud, tilts)
                                   : search_all<Form::kTabled>(images, cloud, tilts);
}

}  // namespace flatpose::bench::thesis
