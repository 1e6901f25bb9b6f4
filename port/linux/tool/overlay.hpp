#pragma once
// The picture of a search or a lesson: the shaded height map seen from above, the template's
// contour and axes (x red, y green, z blue) at each pose, a legend with scale and heights.

#include <cstddef>
#include <string>
#include <vector>

#include "flatpose/geometry/pose.hpp"
#include "flatpose/model/template.hpp"
#include "port/linux/tool/loaded_scan.hpp"

namespace flatpose::tool {

struct Mark {
  Pose face_T_object;
  std::string label;
  const model::Template* part = nullptr;  ///< Null: the overlay's.
};

struct Overlay {
  std::string title;
  std::vector<Mark> marks;
  bool shows_template = false;  ///< Its surface points and anchors too.
};

/// The picture as PNG; its longer side is about 1200 px.
/// Fails: InputError when the scan cannot be rectified, std::bad_alloc.
[[nodiscard]] std::vector<std::byte> draw_overlay(const Overlay& overlay,
                                                  const model::Template& part,
                                                  const LoadedScan& loaded);

}  // namespace flatpose::tool
