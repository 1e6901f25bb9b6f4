#pragma once
// The template: what is known of a part (Ingberg 2015, 2.4 and 2.9.1). Two clouds, contour and
// surface, in the object frame: origin at the taught point of the surface's plane, z out of the
// surface toward the sensor.
//
// Both clouds are kept in farthest-point order: any first n of them are spread well over the part,
// so the sparse set of the search is a prefix of the dense set of the refinement.

#include <array>
#include <cstdint>
#include <span>

#include "flatpose/geometry/pose.hpp"

namespace flatpose::model {

inline constexpr int kContourPointCountMax = 512;
inline constexpr int kSurfacePointCountMax = 512;
inline constexpr int kAnchorCountMax = 8;
inline constexpr int kNameBytesMax = 63;

/// A point where the upper side of the part ends.
struct ContourPoint {
  float x_mm = 0.0F;
  float y_mm = 0.0F;
  float z_mm = 0.0F;  ///< Height of the upper side.
  float nx = 1.0F;    ///< Unit direction in the object's xy plane in which the height falls.
  float ny = 0.0F;
  float step_mm = 0.0F;  ///< How far it fell in the teach scan.
  /// Scatter of the teach scan's own lines about it; negative where they could not measure it: such
  /// a point serves the search and the verification, not the last step.
  float spread_mm = -1.0F;
};

struct SurfacePoint {
  float x_mm = 0.0F;
  float y_mm = 0.0F;
  float z_mm = 0.0F;
  float nx = 0.0F;  ///< Unit normal; nz = sqrt(1 - nx^2 - ny^2).
  float ny = 0.0F;
  float weight = 1.0F;  ///< Area that it stands for, against the mean of all.
};

/// A place on the surface, as far from every edge as the part allows, where the search reads the
/// tilt.
struct Anchor {
  float x_mm = 0.0F;
  float y_mm = 0.0F;
  float clearance_mm = 0.0F;  ///< Radius of the flat disc around it.
};

/// The frame at the face: as the sensor gave it, or z up off the work plane.
enum class Frame : std::uint8_t { kScan = 0, kWork = 1 };

inline constexpr int kFullSymmetry = 0;

struct Symmetry {
  int order = 1;  ///< The part looks alike after a turn by 360 / order degrees; kFullSymmetry:
                  ///< after any turn.
  double center_x_mm = 0.0;
  double center_y_mm = 0.0;
};

/// What teach found that an integrator should know. Bits of Template::weakness.
enum Weakness : std::uint32_t {
  kWeakSymmetryLikely =
      1U << 0,  ///< A turn maps the contour nearly onto itself, and no symmetry is declared.
  kWeakDirectionLoose =
      1U << 1,  ///< The contour hardly holds a direction in the plane, or the turn.
  kWeakStepNearNoise = 1U << 2,  ///< Steps at the contour are not far above the noise.
  kWeakBelowSurroundings =
      1U << 3,                ///< The part lies below what surrounds it: is the right side up?
  kWeakSmall = 1U << 4,       ///< Few cells across: scan more finely or teach a larger part.
  kWeakMarginThin = 1U << 5,  ///< The best wrong place in the teach scan scores nearly as much.
  kWeakSymmetryDoubtful = 1U << 6,  ///< The declared turn does not lay the contour onto itself.
};

inline constexpr int kHoleCountMax = 16;
inline constexpr int kMirroredCountMax = 128;
/// Contours of part and mirrored self that lie nearer than this are not told apart.
inline constexpr double kTelltaleGapMin_px = 1.5;

/// What tells the part from its look-alikes, read off its contour: see landmarks.hpp.
struct Landmarks {
  std::array<std::uint8_t, kContourPointCountMax> hole{};  ///< Of a point: 0 none, else 1, 2, ..
  std::array<int, kHoleCountMax + 1> hole_point_count{};
  int hole_count = 0;
  /// How far off the contour of the part lying on its face is, in cells; 0 where too near to tell.
  std::array<float, kContourPointCountMax> telltale_gap_px{};
  int telltale_count = 0;
  /// Points of the contour that it would show then, and how far off this part's own contour is.
  std::array<ContourPoint, kMirroredCountMax> mirrored{};
  std::array<float, kMirroredCountMax> mirrored_gap_px{};
  int mirrored_count = 0;
};

struct Template {
  std::array<char, kNameBytesMax + 1> name{};  ///< UTF-8, zero-terminated.
  Symmetry symmetry;
  double cell_mm = 1.0;   ///< Side of a cell on the finest level.
  double pitch_mm = 1.0;  ///< Distance of neighbouring points in the teach scan.
  double noise_mm = 0.0;  ///< Standard deviation of the height, from the teach scan.
  double step_mm = 0.0;   ///< Lower quartile of the contour's steps.
  double area_mm2 = 0.0;
  double radius_mm =
      0.0;  ///< Of the smallest circle about the first anchor that holds every point.
  double score_threshold = 0.75;
  double self_score = 0.0;     ///< Score of the part in its own teach scan.
  double rival_score = 0.0;    ///< Best score of a wrong place there.
  Pose scan_T_object;          ///< As taught, in the frame that teach worked in.
  std::int8_t up = 1;          ///< +1: z up in that frame, -1: z down.
  Frame frame = Frame::kScan;  ///< The frame that scan_T_object is given in.
  std::uint32_t weakness = 0;
  int symmetry_likely = 1;  ///< The order that kWeakSymmetryLikely speaks of.
  std::int32_t contour_count = 0;
  std::int32_t surface_count = 0;
  std::int32_t anchor_count = 0;
  std::array<ContourPoint, kContourPointCountMax> contour{};
  std::array<SurfacePoint, kSurfacePointCountMax> surface{};
  std::array<Anchor, kAnchorCountMax> anchors{};
  Landmarks landmarks;  ///< Follows from the contour; no part of the file.

  [[nodiscard]] std::span<const ContourPoint> contour_points() const noexcept {
    return {contour.data(), static_cast<std::size_t>(contour_count)};
  }
  [[nodiscard]] std::span<const SurfacePoint> surface_points() const noexcept {
    return {surface.data(), static_cast<std::size_t>(surface_count)};
  }
};

}  // namespace flatpose::model
