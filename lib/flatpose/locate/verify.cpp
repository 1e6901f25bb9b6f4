#include "flatpose/locate/verify.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "flatpose/image/dark_pit.hpp"
#include "flatpose/locate/hold.hpp"

namespace flatpose::locate {
namespace {

enum class Sight { kNothing, kAbove, kAt, kBelow };

struct Cell {
  int column = 0;
  int row = 0;
};

Cell cell_at(const rectify::Grid& grid, double x_mm, double y_mm) noexcept {
  return {static_cast<int>(std::floor(grid.column_of(x_mm) + 0.5)),
          static_cast<int>(std::floor(grid.row_of(y_mm) + 0.5))};
}

// Where nothing was seen. What casts a shadow is higher than what lies in it, so where nothing
// beside the dark is higher than the part, and something is lower or all is level around a gap too
// wide to be lost points, there is a hole.
Sight sight_in_the_dark(const refine::FineImages& images, const Cell& cell, const Vec3& p_mm,
                        double tolerance_mm) noexcept {
  constexpr int kReach_px = 40;
  if (!images.missing.contains(cell.column, cell.row)) return Sight::kNothing;
  bool is_open = images.missing(cell.column, cell.row) == image::kDarkPit;
  constexpr std::array<Cell, 4> kSides = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
  for (const Cell& side : kSides) {
    Cell at = cell;
    int steps = 0;
    while (images.missing.contains(at.column, at.row) && images.missing(at.column, at.row) != 0 &&
           ++steps < kReach_px) {
      at = {at.column + side.column, at.row + side.row};
    }
    if (!images.missing.contains(at.column, at.row) || steps == kReach_px) return Sight::kNothing;
    const double above_mm = static_cast<double>(images.height_mm(at.column, at.row)) - p_mm.z;
    if (above_mm > tolerance_mm) return Sight::kNothing;
    is_open |= above_mm < -tolerance_mm;
  }
  return is_open ? Sight::kBelow : Sight::kNothing;
}

// What stands at a place, judged by the cell of the 3x3 around it that comes nearest to the
// expected height: a lost point or a cell's width at a contour decides nothing.
Sight sight(const refine::FineImages& images, const Vec3& p_mm, double tolerance_mm) noexcept {
  const Cell centre = cell_at(images.grid, p_mm.x, p_mm.y);
  double nearest_mm = 0.0;
  bool found = false;
  for (int row = centre.row - 1; row <= centre.row + 1; ++row) {
    for (int column = centre.column - 1; column <= centre.column + 1; ++column) {
      if (!images.height_mm.contains(column, row)) continue;
      const double above_mm = static_cast<double>(images.height_mm(column, row)) - p_mm.z;
      if (std::isnan(above_mm)) continue;
      if (!found || std::fabs(above_mm) < std::fabs(nearest_mm)) nearest_mm = above_mm;
      found = true;
    }
  }
  if (!found) return sight_in_the_dark(images, centre, p_mm, tolerance_mm);
  if (nearest_mm > tolerance_mm) return Sight::kAbove;
  return nearest_mm < -tolerance_mm ? Sight::kBelow : Sight::kAt;
}

// What stands at a place on the surface: the middle one of the heights around it, which noise
// leaves near the truth.
Sight sight_on_surface(const refine::FineImages& images, const Vec3& p_mm,
                       double tolerance_mm) noexcept {
  const Cell centre = cell_at(images.grid, p_mm.x, p_mm.y);
  std::array<double, 9> above_mm{};
  int count = 0;
  for (int row = centre.row - 1; row <= centre.row + 1; ++row) {
    for (int column = centre.column - 1; column <= centre.column + 1; ++column) {
      if (!images.height_mm.contains(column, row)) continue;
      const double value_mm = static_cast<double>(images.height_mm(column, row)) - p_mm.z;
      if (!std::isnan(value_mm)) above_mm[count++] = value_mm;
    }
  }
  if (count == 0) return sight_in_the_dark(images, centre, p_mm, tolerance_mm);
  const auto middle = above_mm.begin() + count / 2;
  std::nth_element(above_mm.begin(), middle, above_mm.begin() + count);
  if (*middle > tolerance_mm) return Sight::kAbove;
  return *middle < -tolerance_mm ? Sight::kBelow : Sight::kAt;
}

bool is_claimed(const refine::FineImages& images, ImageView<const std::uint8_t> claimed,
                const Vec3& p_mm) noexcept {
  if (claimed.empty()) return false;
  const Cell cell = cell_at(images.grid, p_mm.x, p_mm.y);
  return claimed.contains(cell.column, cell.row) && claimed(cell.column, cell.row) != 0;
}

// How far off the nearest edge is that falls the right way.
double edge_distance_px(const refine::FineImages& images, const Vec3& p_mm,
                        const Vec3& falling) noexcept {
  const Cell cell = cell_at(images.grid, p_mm.x, p_mm.y);
  if (!images.height_mm.contains(cell.column, cell.row))
    return std::numeric_limits<double>::infinity();
  const int octant = image::octant_of(static_cast<float>(falling.x), static_cast<float>(falling.y));
  return images.edge_distance_third_px[octant](cell.column, cell.row) / 3.0;
}

// How well an edge so far off agrees with a contour point: 1 within the tolerance, then less and
// less, 0 beyond kFadeShare tolerances. A hard bound would let a fraction of a cell decide.
double edge_agreement(double distance_px, double tolerance_px) noexcept {
  constexpr double kFadeShare = 2.4;
  return std::clamp((kFadeShare - distance_px / tolerance_px) / (kFadeShare - 1.0), 0.0, 1.0);
}

// Where the contour is to be seen from: a little inside it the surface, a little outside something
// lower.
constexpr double kProbe_px = 2.5;
constexpr double kWallShare = 0.75;

struct PointVerdict {
  bool seen = false;
  double agreement = 0.0;                                        ///< 1: confirmed, 0: contradicted.
  double distance_px = std::numeric_limits<double>::infinity();  ///< Of the edge.
};

PointVerdict judge_contour(const refine::FineImages& images, ImageView<const std::uint8_t> claimed,
                           const Vec3& p_mm, const Vec3& falling, const Vec3& probe_mm,
                           const VerifyConfig& config) noexcept {
  // What hides the contour covers most of the cells beside it; what confirms it may be one of them.
  const auto is_hidden = [&](const Vec3& beside_mm) {
    return sight_on_surface(images, beside_mm, config.surface_tolerance_mm) == Sight::kAbove ||
           sight(images, beside_mm, config.height_tolerance_mm) == Sight::kAbove;
  };
  if (is_hidden(p_mm - probe_mm) || is_hidden(p_mm + probe_mm)) return {};
  const Sight inside = sight(images, p_mm - probe_mm, config.height_tolerance_mm);
  const Sight outside = sight(images, p_mm + probe_mm, config.height_tolerance_mm);
  if (inside == Sight::kNothing) return {};
  const double distance_px = edge_distance_px(images, p_mm, falling);
  const double agreement = edge_agreement(distance_px, config.edge_tolerance_px);
  // Another part adjoins here, and where two touch at one height there is no edge.
  if (agreement < 1.0 && is_claimed(images, claimed, p_mm + probe_mm)) return {};
  if (outside == Sight::kNothing && agreement == 0.0) return {};  // the scan ends or is dark here
  if (inside != Sight::kAt) return {true};
  return {true, agreement, distance_px};
}

double share(double confirmed, double visible) noexcept {
  return visible > 0.0 ? confirmed / visible : 0.0;
}

// Noise does not open a surface: what is missing of it is a hole or an end that the part does not
// have, small as it may be beside the rest.
double surface_agreement(double confirmed_share, double contradiction_weight) noexcept {
  return std::max(0.0, 1.0 - contradiction_weight * (1.0 - confirmed_share));
}

// What a contour point weighs: as much as its direction is rare. The two ends of a bar are all that
// holds it along its length, however short they are, and a web of a larger part lacks just those.
// With M = mean(n n^T) over the contour, w = n^T M^-1 n / 2 makes every direction in the plane
// weigh the same and the mean weight one.
class DirectionWeight {
 public:
  explicit DirectionWeight(const model::Template& part) noexcept {
    double xx = 0, xy = 0, yy = 0;
    for (const model::ContourPoint& p : part.contour_points()) {
      xx += static_cast<double>(p.nx) * p.nx;
      xy += static_cast<double>(p.nx) * p.ny;
      yy += static_cast<double>(p.ny) * p.ny;
    }
    const double count = std::max(1, part.contour_count);
    const double determinant = (xx * yy - xy * xy) / (count * count);
    constexpr double kParallel = 0.01;  // contours of hardly more than one direction weigh alike
    if (determinant < kParallel) return;
    inverse_xx_ = 0.5 * yy / count / determinant;
    inverse_xy_ = -0.5 * xy / count / determinant;
    inverse_yy_ = 0.5 * xx / count / determinant;
  }
  double operator()(const model::ContourPoint& p) const noexcept {
    const double nx = p.nx;
    const double ny = p.ny;
    return inverse_xx_ * nx * nx + 2.0 * inverse_xy_ * nx * ny + inverse_yy_ * ny * ny;
  }

 private:
  double inverse_xx_ = 1.0;
  double inverse_xy_ = 0.0;
  double inverse_yy_ = 1.0;
};

// Which side of a step the sensor draws as a ramp turns with the part, so no point is more certain
// than the contour typically is: the middle one of its spreads.
double typical_spread_mm(const model::Template& part) noexcept {
  std::array<float, model::kContourPointCountMax> spread_mm{};
  int count = 0;
  for (const model::ContourPoint& p : part.contour_points()) {
    if (p.spread_mm >= 0.0F) spread_mm[count++] = p.spread_mm;
  }
  if (count == 0) return 0.0;
  const auto middle = spread_mm.begin() + count / 2;
  std::nth_element(spread_mm.begin(), middle, spread_mm.begin() + count);
  return static_cast<double>(*middle);
}

// What tells the part from its look-alikes. Every hole that can be seen must be there: one that is
// not is enough, so the worst decides. And something must be seen of what its own face alone shows.
class LandmarkTally {
 public:
  explicit LandmarkTally(const model::Landmarks& landmarks) noexcept : landmarks_(landmarks) {}

  void add(int point, const PointVerdict& verdict) noexcept {
    holes_[landmarks_.hole[point]].add(verdict.agreement);
    const double gap_px = landmarks_.telltale_gap_px[point];
    if (gap_px > 0.0) telltales_.add(verdict.distance_px < 0.5 * gap_px ? 1.0 : 0.0);
  }

  /// A place where the contour would be if the part lay on its face.
  void add_mirrored(int index, const PointVerdict& verdict) noexcept {
    const double gap_px = landmarks_.mirrored_gap_px[index];
    telltales_.add(verdict.distance_px > 0.5 * gap_px ? 1.0 : 0.0);
  }

  /// 1 when every hole seen is there, less when one is hardly there.
  [[nodiscard]] double agreement() const noexcept {
    constexpr double kSeenShare = 0.5;
    constexpr double kEnough = 0.65;
    double worst = 1.0;
    for (int i = 1; i <= landmarks_.hole_count; ++i) {
      if (holes_[i].seen_count < kSeenShare * landmarks_.hole_point_count[i]) continue;
      worst = std::min(worst, holes_[i].mean_agreement() / kEnough);
    }
    return worst;
  }
  /// Whether the contour seen is the one of the part's own face; a part whose faces differ too
  /// little for the cells shows it always.
  [[nodiscard]] bool shows_face(int contour_count) const noexcept {
    constexpr double kTelltaleShareMin = 0.06;
    constexpr double kConfirmedMin = 3.0;
    constexpr double kAgreementMin = 0.5;
    const int count = landmarks_.telltale_count + landmarks_.mirrored_count;
    if (count < kTelltaleShareMin * contour_count) return true;
    return telltales_.agreement_sum >= kConfirmedMin &&
           telltales_.mean_agreement() >= kAgreementMin;
  }

 private:
  struct Tally {
    int seen_count = 0;
    double agreement_sum = 0.0;
    void add(double agreement) noexcept {
      ++seen_count;
      agreement_sum += agreement;
    }
    [[nodiscard]] double mean_agreement() const noexcept { return agreement_sum / seen_count; }
  };

  const model::Landmarks& landmarks_;
  std::array<Tally, model::kHoleCountMax + 1> holes_{};
  Tally telltales_;
};

}  // namespace

Verification verify(const model::Template& part, const refine::FineImages& images,
                    ImageView<const std::uint8_t> claimed, const Pose& work_T_object,
                    const VerifyConfig& config) noexcept {
  Verification out;
  double area = 0.0;
  double visible_area = 0.0;
  double confirmed_area = 0.0;
  for (const model::SurfacePoint& p : part.surface_points()) {
    const double weight_of_area = p.weight;
    area += weight_of_area;
    const Vec3 q_mm = work_T_object * Vec3{p.x_mm, p.y_mm, p.z_mm};
    const Sight seen = sight_on_surface(images, q_mm, config.surface_tolerance_mm);
    if (seen == Sight::kNothing || seen == Sight::kAbove) continue;
    ++out.surface.visible_count;
    visible_area += weight_of_area;
    if (is_claimed(images, claimed, q_mm)) ++out.surface.claimed_count;
    if (seen != Sight::kAt) continue;
    ++out.surface.confirmed_count;
    confirmed_area += weight_of_area;
  }
  const double probe_mm = kProbe_px * images.grid.cell_mm;
  const DirectionWeight weight(part);
  const double typical_mm = typical_spread_mm(part);
  double visible_weight = 0.0;
  double confirmed_weight = 0.0;
  LandmarkTally landmarks(part.landmarks);
  Hold hold(part);
  const auto judge = [&](const model::ContourPoint& p) {
    const Vec3 q_mm = work_T_object * Vec3{p.x_mm, p.y_mm, p.z_mm};
    const Vec3 falling = work_T_object.rotation * Vec3{p.nx, p.ny, 0.0};
    // A side wall that leans toward the sensor draws the fall out over its own width, and where the
    // teach scan saw a ramp the place is as uncertain as that was.
    VerifyConfig leaning = config;
    leaning.edge_tolerance_px +=
        std::max(typical_mm, static_cast<double>(p.spread_mm)) / images.grid.cell_mm;
    leaning.edge_tolerance_px +=
        kWallShare * std::max(0.0, falling.z) * p.step_mm / images.grid.cell_mm;
    return judge_contour(images, claimed, q_mm, falling, probe_mm * falling, leaning);
  };
  for (int i = 0; i < part.contour_count; ++i) {
    const model::ContourPoint& p = part.contour[i];
    const PointVerdict verdict = judge(p);
    if (!verdict.seen) continue;
    ++out.contour.visible_count;
    visible_weight += weight(p);
    if (verdict.agreement > 0.5) ++out.contour.confirmed_count;
    confirmed_weight += verdict.agreement * weight(p);
    landmarks.add(i, verdict);
    hold.add(p, verdict.agreement);
  }
  for (int i = 0; config.use_landmarks && i < part.landmarks.mirrored_count; ++i) {
    const PointVerdict verdict = judge(part.landmarks.mirrored[i]);
    if (verdict.seen) landmarks.add_mirrored(i, verdict);
  }
  out.visible = share(visible_area, area);
  out.score = surface_agreement(share(confirmed_area, visible_area), config.contradiction_weight) *
              share(confirmed_weight, visible_weight) *
              (config.use_landmarks ? landmarks.agreement() : 1.0);
  out.held = hold.least_share();
  out.shows_face = landmarks.shows_face(part.contour_count);
  return out;
}

void claim(const model::Template& part, const refine::FineImages& images, const Pose& work_T_object,
           const VerifyConfig& config, ImageView<std::uint8_t> claimed) noexcept {
  const double spacing_mm = std::sqrt(part.area_mm2 / std::max(1, part.surface_count));
  const int reach_px = static_cast<int>(0.75 * spacing_mm / images.grid.cell_mm) + 1;
  for (const model::SurfacePoint& p : part.surface_points()) {
    const Vec3 q_mm = work_T_object * Vec3{p.x_mm, p.y_mm, p.z_mm};
    if (sight(images, q_mm, config.height_tolerance_mm) != Sight::kAt) continue;
    const Cell centre = cell_at(images.grid, q_mm.x, q_mm.y);
    for (int row = centre.row - reach_px; row <= centre.row + reach_px; ++row) {
      for (int column = centre.column - reach_px; column <= centre.column + reach_px; ++column) {
        if (claimed.contains(column, row)) claimed(column, row) = 1;
      }
    }
  }
}

}  // namespace flatpose::locate
