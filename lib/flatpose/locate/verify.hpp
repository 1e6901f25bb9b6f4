#pragma once
// How much of the template a pose explains, knowing what the sensor could not see. A point that
// lies outside the field, on missing data or under something higher says nothing; one that could be
// seen either confirms or contradicts.

#include <array>
#include <cstdint>

#include "flatpose/core/image_view.hpp"
#include "flatpose/locate/direction_weight.hpp"
#include "flatpose/locate/hold.hpp"
#include "flatpose/model/template.hpp"
#include "flatpose/refine/fine_images.hpp"

namespace flatpose::locate {

struct VerifyConfig {
  int contour_count = model::kContourPointCountMax;  ///< Points that take part: the first, which
  int surface_count = model::kSurfacePointCountMax;  ///< are spread well over the part.
  double surface_tolerance_mm = 1.0;  ///< A surface point this near to its height is confirmed.
  double height_tolerance_mm = 1.0;   ///< A single cell this near to its height may be there.
  double edge_tolerance_px =
      1.5;  ///< A contour point this near to an edge that falls its way is confirmed.
  /// Holes that can be seen must be there, and the face and the hold of the contour are judged.
  bool use_landmarks = true;
  /// A score that cannot reach this is not worked out: any value below it stands for it.
  double least_score = 0.0;
  /// How much more than a confirmed one a contradicted point of the surface weighs; >= 1.
  double contradiction_weight = 3.0;
};

struct Evidence {
  int visible_count = 0;
  int confirmed_count = 0;
  int claimed_count = 0;  ///< Of the visible: on cells that an accepted match already explains.
};

struct Verification {
  Evidence surface;
  Evidence contour;
  double visible = 0.0;  ///< Share of the surface that the scan could show.
  double score =
      0.0;  ///< Confirmed share of what could be seen, surface and contour weighing the same.
  double held = 0.0;       ///< Share by which the confirmed contour holds the direction held worst.
  bool shows_face = true;  ///< Whether what tells the part from itself on its face was seen.
};

/// Holds the dense template at a pose against the scan.
class Verifier {
 public:
  /// The part must outlive it.  Cost: what is the same at every pose, some 10 us.
  explicit Verifier(const model::Template& part) noexcept;

  /// Shape: `claimed` is of the fine grid, nonzero where accepted matches lie; it may be empty.
  /// Cost: linear in the template's points.  Memory: none.  Thread: reentrant.
  [[nodiscard]] Verification verify(const refine::FineImages& images,
                                    ImageView<const std::uint8_t> claimed,
                                    const Pose& work_T_object,
                                    const VerifyConfig& config) const noexcept;

 private:
  const model::Template& part_;
  DirectionWeight weight_;
  double typical_spread_mm_;
  std::array<double, model::kContourPointCountMax + 1>
      weight_before_{};  ///< Of all points before one.
  Hold hold_;            ///< With nothing confirmed yet.
};

/// Marks the cells under the part's visible surface as explained.
void claim(const model::Template& part, const refine::FineImages& images, const Pose& work_T_object,
           const VerifyConfig& config, ImageView<std::uint8_t> claimed) noexcept;

}  // namespace flatpose::locate
