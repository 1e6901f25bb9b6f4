#pragma once
// Every place, every angle, in full, through the public API: what the grid search must equal on
// level ground, where no binning of tilts comes between.

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "tests/lib/search/made_images.hpp"

namespace flatpose::search {

struct Hypothesis {
  std::int32_t cost = 0;
  int row = 0;
  int column = 0;
  int angle = 0;

  friend auto operator<=>(const Hypothesis&, const Hypothesis&) = default;
};

inline bool is_planar(const MadeImages& made, const GridSearchConfig& config, int x, int y) {
  const double slope = std::hypot(made.field.slope_x(x, y), made.field.slope_y(x, y));
  return made.field.rms_mm(x, y) <= config.planarity_mm && slope <= std::tan(config.max_tilt_rad);
}

inline Place place_at(const MadeImages& made, int x, int y) {
  const double sx = made.field.slope_x(x, y);
  const double sy = made.field.slope_y(x, y);
  const Vec3 normal = normalized({-sx, -sy, 1.0});
  const auto nearest = [](double v) { return static_cast<std::int32_t>(std::floor(v + 0.5)); };
  const double per_cell_q8 = made.images.grid.cell_mm * kHeightUnitsPerMm * 256.0;
  return {static_cast<std::int16_t>(x),
          static_cast<std::int16_t>(y),
          nearest((made.field.plane_mm(x, y) - made.images.base_mm) * kHeightUnitsPerMm),
          nearest(sx * per_cell_q8),
          nearest(sy * per_cell_q8),
          static_cast<std::int16_t>(nearest(normal.x * kNormalUnits)),
          static_cast<std::int16_t>(nearest(normal.y * kNormalUnits))};
}

/// All hypotheses on level places, dearest last; ties by row, column, angle.
inline std::vector<Hypothesis> slow_search(const MadeImages& made, const model::Template& part,
                                           const GridSearchConfig& config) {
  const int angles = angle_count(part.symmetry, config.angle_step_rad);
  const ScoreScale scale = score_scale(config.score);
  std::vector<Hypothesis> all;
  for (int angle = 0; angle < angles; ++angle) {
    const double angle_rad = angle_range_rad(part.symmetry) * angle / angles;
    const ProjectedTemplate t =
        project(part, part.anchors[0], 0.0, 0.0, angle_rad, made.images.grid.cell_mm, config.score);
    made.for_each([&](int x, int y) {
      if (x % config.stride_px != 0 || y % config.stride_px != 0) return;
      if (!is_planar(made, config, x, y)) return;
      all.push_back({cost(made.images, t, scale, place_at(made, x, y), 1 << 30), y, x, angle});
    });
  }
  std::sort(all.begin(), all.end());
  return all;
}

struct Found {
  Status status = Status::kOk;
  GridSearchResult result;
  std::vector<Candidate> candidates;
};

inline std::size_t scratch_bytes(const MadeImages& made) {
  rectify::Grid fine = made.images.grid;
  fine.width_px *= 2;
  fine.height_px *= 2;
  Arena measuring = Arena::measuring();
  reserve_search_scratch(measuring, fine);
  return measuring.required_bytes();
}

inline Found run(const MadeImages& made, const model::Template& part,
                 const GridSearchConfig& config, std::size_t capacity = 200) {
  Found found;
  found.candidates.resize(capacity);
  Memory scratch(scratch_bytes(made));
  const Result<GridSearchResult> result =
      grid_search(made.images, made.field, part, 0, config, scratch.arena, found.candidates);
  EXPECT_EQ(scratch.arena.used_bytes(), 0U) << "the scratch is given back";
  found.status = result.status();
  if (result) found.result = *result;
  found.candidates.resize(static_cast<std::size_t>(found.result.candidate_count));
  return found;
}

}  // namespace flatpose::search
