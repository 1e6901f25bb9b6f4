#include "flatpose/teach/part_mask.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace flatpose::teach {
namespace {

constexpr std::int32_t kUnassigned = 0;
constexpr std::int32_t kBarrier = -1;
constexpr std::int32_t kBackground = -2;
constexpr std::int32_t kOutside = -3;
// Areas beyond this many are specks: they are counted as background.
constexpr int kAreaCountMax = 16384;
constexpr std::int32_t kAreaCellsMin = 12;
constexpr double kNoiseFactor = 6.0;
constexpr int kBarrierReach_px = 2;  // an edge's cell and the one beside it

struct Area {
  std::int32_t cell_count = 0;
  std::int32_t inside_count = 0;  ///< Cells that lie in the region.
  std::int32_t missing_count = 0;
  double height_sum_mm = 0.0;
  std::int32_t upper_count = 0;         ///< Edges that fall away from it ...
  std::int32_t lower_count = 0;         ///< ... and toward it.
  std::int32_t rests_on = kUnassigned;  ///< The area that most edges of its own fall to.
  std::int32_t lies_in = kUnassigned;   ///< The area whose edges fall to it.
  bool is_part = false;
};

class Partition {
 public:
  Partition(const scene::Scene& scene, Arena& arena) noexcept
      : scene_(scene),
        width_px_(scene.map.grid.width_px),
        height_px_(scene.map.grid.height_px),
        step_max_mm_(static_cast<float>(kNoiseFactor * scene.noise_mm + scene.map.grid.cell_mm)) {
    label_ = arena.take_image<std::int32_t>(width_px_, height_px_);
    stack_ = arena.take<std::int32_t>(static_cast<std::size_t>(width_px_) *
                                      static_cast<std::size_t>(height_px_));
    areas_ = arena.take<Area>(kAreaCountMax + 1);
    is_inside_ = arena.take_image<std::uint8_t>(width_px_, height_px_);
  }

  /// Draws the barriers, floods the background, labels what is shut in and writes what of it is the
  /// part. Edges lower than `step_min_mm` are no contours.
  Status divide(const Frames& frames, const Region& region, float step_min_mm,
                PartMask& mask) noexcept {
    step_min_mm_ = step_min_mm;
    area_count_ = 0;
    region_cell_count_ = 0;
    background_mm_ = -std::numeric_limits<double>::infinity();
    draw(frames, region);
    if (region.kind == Region::Kind::kAll) {
      flood_background();
      label_areas();
      vote();
      if (largest() == 0) return Status::kNoPart;
      if (const Status s = take_largest(); s != Status::kOk) return s;
    } else {
      label_areas();
      const bool is_one_surface = send_back_what_lies_outside();
      vote();
      take_all();
      if (largest() == 0) {
        if (!is_one_surface) return Status::kNoPart;
        take_region_whole();
      }
    }
    write(mask);
    return mask.cell_count >= kAreaCellsMin ? Status::kOk : Status::kNoPart;
  }

 private:
  void draw(const Frames& frames, const Region& region) noexcept {
    for (int y = 0; y < height_px_; ++y) {
      for (int x = 0; x < width_px_; ++x) {
        const Vec3 p_work{scene_.map.grid.x_of(x), scene_.map.grid.y_of(y), 0.0};
        const Vec3 p_face = frames.face_T_work * p_work;
        is_inside_(x, y) = region.contains(p_face.x, p_face.y) ? 1 : 0;
        label_(x, y) = kUnassigned;
        region_cell_count_ += is_inside_(x, y);
      }
    }
    for (const image::EdgePoint& e : scene_.edges) {
      if (e.step_mm < step_min_mm_) continue;
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          const int x = e.column + dx;
          const int y = e.row + dy;
          if (label_.contains(x, y) && label_(x, y) == kUnassigned) label_(x, y) = kBarrier;
        }
      }
    }
  }

  void flood_background() noexcept {
    for (int y = 0; y < height_px_; ++y) {
      for (int x = 0; x < width_px_; ++x) {
        if (label_(x, y) == kUnassigned && is_on_border(x, y)) (void)flood(x, y, kBackground);
      }
    }
  }

  void label_areas() noexcept {
    std::fill(areas_.begin(), areas_.end(), Area{});
    for (int y = 0; y < height_px_; ++y) {
      for (int x = 0; x < width_px_; ++x) {
        if (label_(x, y) != kUnassigned) continue;
        const std::int32_t label = area_count_ < kAreaCountMax ? ++area_count_ : kBackground;
        const std::int32_t cell_count = flood(x, y, label);
        if (label != kBackground) areas_[label].cell_count = cell_count;
      }
    }
  }

  /// What lies mostly outside of the region is background; what lies mostly in it is wanted whole,
  /// also where a region drawn too tightly cuts it. Returns whether one surface that goes on
  /// outside fills most of the region.
  bool send_back_what_lies_outside() noexcept {
    constexpr double kInsideShareMin = 0.6;
    constexpr double kFilledShare = 0.6;
    for (int y = 0; y < height_px_; ++y) {
      for (int x = 0; x < width_px_; ++x) {
        if (label_(x, y) > 0) areas_[label_(x, y)].inside_count += is_inside_(x, y);
      }
    }
    bool is_one_surface = false;
    for (int y = 0; y < height_px_; ++y) {
      for (int x = 0; x < width_px_; ++x) {
        std::int32_t& label = label_(x, y);
        if (label <= 0) continue;
        const Area& area = areas_[label];
        if (area.inside_count >= kInsideShareMin * area.cell_count) continue;
        is_one_surface |= area.inside_count > kFilledShare * region_cell_count_;
        label = kBackground;
      }
    }
    for (std::int32_t i = 1; i <= area_count_; ++i) {
      if (areas_[i].inside_count < kInsideShareMin * areas_[i].cell_count) areas_[i] = Area{};
    }
    return is_one_surface;
  }

  /// Nothing stands in the region, which lies on a larger surface: the region itself is the part.
  void take_region_whole() noexcept {
    area_count_ = 1;
    std::fill(areas_.begin(), areas_.end(), Area{});
    for (int y = 0; y < height_px_; ++y) {
      for (int x = 0; x < width_px_; ++x) {
        std::int32_t& label = label_(x, y);
        if (label == kBarrier) continue;
        label = is_inside_(x, y) != 0 ? 1 : kBackground;
        areas_[1].cell_count += is_inside_(x, y);
      }
    }
    areas_[1].is_part = true;
  }

  /// Counts for every area what is missing in it, and the edges that fall away from it and toward
  /// it.
  void vote() noexcept {
    double background_sum_mm = 0.0;
    double background_count = 0.0;
    for (int y = 0; y < height_px_; ++y) {
      for (int x = 0; x < width_px_; ++x) {
        const std::int32_t label = label_(x, y);
        const bool missing = scene_.missing(x, y) != 0;
        if (label > 0 && missing) ++areas_[label].missing_count;
        if (label > 0) areas_[label].height_sum_mm += static_cast<double>(scene_.filled_mm(x, y));
        if (label != kBackground || missing || is_inside_(x, y) == 0) continue;
        background_sum_mm += static_cast<double>(scene_.filled_mm(x, y));
        background_count += 1.0;
      }
    }
    if (background_count > 0.0) background_mm_ = background_sum_mm / background_count;
    for (const image::EdgePoint& e : scene_.edges) {
      if (e.step_mm < step_min_mm_) continue;
      const std::int32_t upper = area_beside(e, -1.0F);
      const std::int32_t lower = area_beside(e, 1.0F);
      if (upper == lower) continue;  // inside of a rough area
      if (upper > 0) ++areas_[upper].upper_count;
      if (lower > 0) ++areas_[lower].lower_count;
      if (upper > 0 && lower != kUnassigned && areas_[upper].rests_on <= 0)
        areas_[upper].rests_on = lower;
      if (upper > 0 && lower > 0 && areas_[lower].lies_in == kUnassigned)
        areas_[lower].lies_in = upper;
    }
  }

  /// Lower than all around it and no higher than the background, which shows through; or hardly
  /// seen at all.
  [[nodiscard]] bool is_pit(const Area& area) const noexcept {
    if (area.cell_count == 0 || 2 * area.missing_count > area.cell_count) return true;
    const bool lies_low =
        area.height_sum_mm / area.cell_count < background_mm_ + static_cast<double>(step_max_mm_);
    return lies_low && is_sunk(area);
  }

  [[nodiscard]] std::int32_t largest() const noexcept {
    std::int32_t best = 0;
    for (std::int32_t i = 1; i <= area_count_; ++i) {
      if (is_pit(areas_[i])) continue;
      if (best == 0 || areas_[i].cell_count > areas_[best].cell_count) best = i;
    }
    return best;
  }

  /// Everything shut in but pits and specks.
  void take_all() noexcept {
    for (std::int32_t i = 1; i <= area_count_; ++i) {
      areas_[i].is_part = !is_pit(areas_[i]) && areas_[i].cell_count >= kAreaCellsMin;
    }
  }

  [[nodiscard]] static bool is_sunk(const Area& area) noexcept {
    return area.upper_count * 6 < area.lower_count;
  }

  /// The largest, what stands on it and what is sunk into it.  Fails: kSeveralParts.
  Status take_largest() noexcept {
    constexpr int kRivalShare = 5;  // a fifth of the largest, standing apart, may be meant as well
    const std::int32_t part = largest();
    areas_[part].is_part = true;
    for (std::int32_t i = 1; i <= area_count_; ++i) {
      Area& area = areas_[i];
      if (i == part || is_pit(area) || area.cell_count < kAreaCellsMin) continue;
      area.is_part = area.rests_on == part || (area.lies_in == part && is_sunk(area));
      const bool is_rival = !area.is_part && area.rests_on <= 0 &&
                            kRivalShare * area.cell_count > areas_[part].cell_count;
      if (is_rival) return Status::kSeveralParts;
    }
    return Status::kOk;
  }

  void write(PartMask& mask) noexcept {
    mask.cell_count = 0;
    for (int y = 0; y < height_px_; ++y) {
      for (int x = 0; x < width_px_; ++x) {
        const bool is_part = label_(x, y) > 0 && areas_[label_(x, y)].is_part;
        mask.is_part(x, y) = is_part ? 1 : 0;
        mask.is_contour(x, y) = 0;
        if (is_part) ++mask.cell_count;
      }
    }
    for (int reach_px = 0; reach_px < kBarrierReach_px; ++reach_px) grow(mask);
    std::int32_t falls_away = 0;
    std::int32_t falls_toward = 0;
    for (const image::EdgePoint& e : scene_.edges) {
      if (e.step_mm < step_min_mm_) continue;
      const bool upper = is_part_area(area_beside(e, -1.0F));
      const bool lower = is_part_area(area_beside(e, 1.0F));
      if (upper) mask.is_contour(e.column, e.row) = 1;
      if (upper && !lower) ++falls_away;
      if (lower && !upper) ++falls_toward;
    }
    mask.lies_below = falls_toward > falls_away;
  }

  /// Adds the barrier cells beside the part that lie at its height: they are its surface up to the
  /// contour.
  void grow(PartMask& mask) noexcept {
    constexpr std::uint8_t kAdded = 2;
    for (int y = 1; y < height_px_ - 1; ++y) {
      for (int x = 1; x < width_px_ - 1; ++x) {
        if (label_(x, y) != kBarrier || mask.is_part(x, y) != 0) continue;
        const auto continues = [&](int px, int py) {
          return mask.is_part(px, py) == 1 &&
                 std::fabs(scene_.filled_mm(px, py) - scene_.filled_mm(x, y)) <= step_max_mm_;
        };
        const bool is_added = continues(x - 1, y) || continues(x + 1, y) || continues(x, y - 1) ||
                              continues(x, y + 1);
        if (is_added) mask.is_part(x, y) = kAdded;
      }
    }
    for (int y = 1; y < height_px_ - 1; ++y) {
      for (int x = 1; x < width_px_ - 1; ++x) {
        if (mask.is_part(x, y) != kAdded) continue;
        mask.is_part(x, y) = 1;
        ++mask.cell_count;
      }
    }
  }

  [[nodiscard]] bool is_part_area(std::int32_t label) const noexcept {
    return label > 0 && areas_[label].is_part;
  }

  [[nodiscard]] bool is_on_border(int x, int y) const noexcept {
    return x == 0 || y == 0 || x == width_px_ - 1 || y == height_px_ - 1;
  }

  // Four-connected, with a stack of our own; each cell is pushed once.
  std::int32_t flood(int x, int y, std::int32_t label) noexcept {
    std::int32_t depth = 0;
    std::int32_t count = 0;
    // Where a contour has a gap, the step of height under it still bars the way.
    const auto push = [&](int px, int py, float from_mm) {
      if (!label_.contains(px, py) || label_(px, py) != kUnassigned) return;
      if (std::fabs(scene_.filled_mm(px, py) - from_mm) > step_max_mm_) return;
      label_(px, py) = label;
      stack_[depth++] = py * width_px_ + px;
      ++count;
    };
    push(x, y, scene_.filled_mm(x, y));
    while (depth > 0) {
      const std::int32_t cell = stack_[--depth];
      const int cx = cell % width_px_;
      const int cy = cell / width_px_;
      const float from_mm = scene_.filled_mm(cx, cy);
      push(cx - 1, cy, from_mm);
      push(cx + 1, cy, from_mm);
      push(cx, cy - 1, from_mm);
      push(cx, cy + 1, from_mm);
    }
    return count;
  }

  // The area a little beside an edge: side -1 is its upper side, +1 its lower one. The barrier is
  // three cells wide.
  [[nodiscard]] std::int32_t area_beside(const image::EdgePoint& e, float side) const noexcept {
    for (const float distance_px : {2.0F, 3.0F, 4.0F}) {
      const int x = static_cast<int>(std::floor(e.x_px + side * distance_px * e.dx + 0.5F));
      const int y = static_cast<int>(std::floor(e.y_px + side * distance_px * e.dy + 0.5F));
      if (!label_.contains(x, y)) return kOutside;
      if (label_(x, y) != kBarrier) return label_(x, y);
    }
    return kUnassigned;
  }

  const scene::Scene& scene_;
  int width_px_;
  int height_px_;
  float step_min_mm_ = 0.0F;
  float step_max_mm_;  ///< Between neighbouring cells of one surface: noise, and a slope of 45
                       ///< degrees.
  ImageView<std::int32_t> label_;
  std::span<std::int32_t> stack_;
  std::span<Area> areas_;
  ImageView<std::uint8_t> is_inside_;
  std::int32_t area_count_ = 0;
  double background_mm_ = -std::numeric_limits<double>::infinity();
  std::int32_t region_cell_count_ = 0;
};

// The upper quartile of the steps along the part's contour: what stands out among whatever
// roughness was taken in.
float upper_quartile_step(const scene::Scene& scene, const PartMask& mask,
                          std::span<float> steps_mm) noexcept {
  std::ptrdiff_t count = 0;
  for (const image::EdgePoint& e : scene.edges) {
    if (mask.is_contour(e.column, e.row) != 0) steps_mm[count++] = e.step_mm;
  }
  if (count == 0) return 0.0F;
  const auto quartile = steps_mm.begin() + (3 * count) / 4;
  std::nth_element(steps_mm.begin(), quartile, steps_mm.begin() + count);
  return *quartile;
}

}  // namespace

PartMask take_part_mask(Arena& arena, const rectify::Grid& grid) noexcept {
  PartMask mask;
  mask.is_part = arena.take_image<std::uint8_t>(grid.width_px, grid.height_px);
  mask.is_contour = arena.take_image<std::uint8_t>(grid.width_px, grid.height_px);
  return mask;
}

void reserve_mask_scratch(Arena& arena, const rectify::Grid& grid) noexcept {
  scene::Scene scene;
  scene.map.grid = grid;
  (void)Partition(scene, arena);
  const std::size_t cell_count =
      static_cast<std::size_t>(grid.width_px) * static_cast<std::size_t>(grid.height_px);
  (void)arena.take<float>(cell_count / scene::kCellsPerEdge + 1);
}

Status find_part(const scene::Scene& scene, const Frames& frames, const Region& region,
                 Arena& scratch, PartMask& mask) noexcept {
  const ArenaScope scope(scratch);
  Partition partition(scene, scratch);
  const std::span<float> steps_mm = scratch.take<float>(scene.edges.size());
  if (scratch.failed()) return Status::kOutOfMemory;
  if (const Status s = partition.divide(frames, region, 0.0F, mask); s != Status::kOk) return s;
  // Now that the part's own steps are known, what is far lower is roughness on it: without it once
  // more.
  constexpr float kRoughShare = 0.25F;
  const float rough_mm = kRoughShare * upper_quartile_step(scene, mask, steps_mm);
  if (partition.divide(frames, region, rough_mm, mask) == Status::kOk) return Status::kOk;
  return partition.divide(frames, region, 0.0F, mask);
}

Status mask_from_labels(const scene::Scene& scene, ImageView<const std::uint8_t> labels,
                        PartMask& mask) noexcept {
  const auto label_of = [&](int x, int y) {
    const std::int32_t source = scene.map.source_index(x, y);
    if (source == rectify::kNoSource) return Label::kNone;
    return static_cast<Label>(labels(source % labels.width_px, source / labels.width_px));
  };
  mask.cell_count = 0;
  for (int y = 0; y < mask.is_part.height_px; ++y) {
    for (int x = 0; x < mask.is_part.width_px; ++x) {
      const Label label = label_of(x, y);
      const bool is_part = label == Label::kSurface || label == Label::kOrigin;
      mask.is_part(x, y) = is_part ? 1 : 0;
      mask.is_contour(x, y) = 0;
      if (is_part) ++mask.cell_count;
    }
  }
  if (mask.cell_count < kAreaCellsMin) return Status::kNoPart;
  // A stroke of the brush marks the contour: edges of the scan under it or beside it count.
  constexpr int kBrushReach_px = 3;
  std::int32_t contour_count = 0;
  for (const image::EdgePoint& e : scene.edges) {
    bool marked = false;
    for (int dy = -kBrushReach_px; dy <= kBrushReach_px && !marked; ++dy) {
      for (int dx = -kBrushReach_px; dx <= kBrushReach_px && !marked; ++dx) {
        const int x = e.column + dx;
        const int y = e.row + dy;
        marked = mask.is_part.contains(x, y) && label_of(x, y) == Label::kEdge;
      }
    }
    mask.is_contour(e.column, e.row) = marked ? 1 : 0;
    if (marked) ++contour_count;
  }
  return contour_count > 0 ? Status::kOk : Status::kNoContour;
}

}  // namespace flatpose::teach
