#pragma once
// A part that lies on its face.

#include "port/sim/scene.hpp"

namespace flatpose::sim {

/// The part's bottom as a top: its outline mirrored (x against x), flat.
[[nodiscard]] Part underside(const Part& part);
/// The instance as a part whose top is the instance's bottom; it fills the same space but for the
/// areas.
[[nodiscard]] Instance underside(const Instance& instance);

/// Whether the part, seen from below, is the part turned: no areas, and an outline that is its own
/// mirror image to within 0.5 mm.
[[nodiscard]] bool same_upside_down(const Part& part);

}  // namespace flatpose::sim
