#pragma once
// What tells a part from its look-alikes, read off its contour.
//
// Holes: closed loops at which the surface falls inward. What tells two parts apart is often a hole
// alone, and a hole is little beside the rest of the contour.
//
// Telltales: points that the part lying on its face has no contour at. The contour seen then is the
// mirrored one; it is laid onto the part's own as well as it goes, and what it stays away from is a
// telltale. So is, the other way round, what the mirrored contour shows where the part has none. A
// part that looks the same from both sides has neither.

#include "flatpose/model/template.hpp"

namespace flatpose::model {

/// Finds both from the contour points.
/// Cost: contour points squared times a few hundred: tens of ms, when a template is made or read.
/// Memory: none.  Thread: reentrant.
[[nodiscard]] Landmarks find_landmarks(const Template& part) noexcept;

/// The two halves of it.
void find_holes(const Template& part, Landmarks& out) noexcept;
void find_telltales(const Template& part, Landmarks& out) noexcept;

}  // namespace flatpose::model
