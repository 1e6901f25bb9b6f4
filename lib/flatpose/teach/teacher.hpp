#pragma once
// Teaching: from one or several scans of a part to its template (Ingberg 2015, 2.4 and 2.9.1).
//
//   scan -> scene -> part's cells -> object frame -> clouds, anchors -> contour sharpened on raw
//   points
//        -> the part searched for in its own scan: threshold, margins, what is weak
//
// More scans of the same part in other poses take the sensor's grid out of the contour: in each the
// part is located, its contour measured, and the mean of all is kept.

#include <array>
#include <span>

#include "flatpose/core/arena.hpp"
#include "flatpose/core/status.hpp"
#include "flatpose/geometry/frames.hpp"
#include "flatpose/geometry/range_image.hpp"
#include "flatpose/geometry/region.hpp"
#include "flatpose/locate/locator.hpp"
#include "flatpose/model/template.hpp"
#include "flatpose/teach/part_mask.hpp"

namespace flatpose::teach {

struct TeachScan {
  RangeImageView scan;
  Frames frames;
};

/// A point of the plane in the x and y of the face.
struct PlanePoint {
  bool is_given = false;
  double x_mm = 0.0;
  double y_mm = 0.0;
};

struct TeachConfig {
  std::array<char, model::kNameBytesMax + 1> name{};
  Region region;  ///< Where the part lies in the first scan; kAll: the lone part.
  ImageView<const std::uint8_t> labels;  ///< A teach::Label a pixel of the first scan; empty: none.
  PlanePoint label_origin_px;            ///< Column and row of the labelled origin.
  PlanePoint origin;                     ///< Default: the centroid of the surface.
  PlanePoint x_axis;                     ///< A direction; default: the face's x.
  int symmetry_order = 1;                ///< 1 none, N-fold, model::kFullSymmetry.
  PlanePoint symmetry_center;            ///< Default: the contour's own centre.
  double cell_mm = 0.0;                  ///< Finest level of later searches; 0: from part and scan.
  std::int8_t up = 1;                    ///< What is kept in the template: the side that was up,
  model::Frame frame = model::Frame::kScan;  ///< and the frame of the taught pose.
};

struct TeachReport {
  int scan_count_used = 0;       ///< Scans in which the part was found and measured.
  double contour_rms_mm = 0.0;   ///< Of the raw contour about the template, first scan.
  double flatness_rms_mm = 0.0;  ///< Of the surface about its main plane.
};

class Teacher {
 public:
  /// The same memory serves a locator with the same limits.
  [[nodiscard]] static std::size_t required_bytes(const locate::Limits& limits) noexcept;
  [[nodiscard]] Status init(const locate::Limits& limits, std::span<std::byte> memory) noexcept;

  /// Teaches from one or more scans; the first is the one that region, labels and origin speak of.
  /// Fails: kNoPart, kSeveralParts, kNoContour, kTooFewPoints, kTooLarge, kNotFinite,
  /// kShapeMismatch (labels), kInvalidArgument.  Memory: as given.  Thread: one at a time per
  /// teacher.
  [[nodiscard]] Status teach(std::span<const TeachScan> scans, const TeachConfig& config,
                             model::Template& part, TeachReport& report) noexcept;

 private:
  locate::Limits limits_;
  std::span<std::byte> memory_;
};

}  // namespace flatpose::teach
