#pragma once
// The stage between scene and search: what refinement and search read of a scene. Its parts touch
// different images and are shared out.

#include "flatpose/core/budget.hpp"
#include "flatpose/core/status.hpp"
#include "flatpose/locate/settings.hpp"
#include "flatpose/locate/workspace.hpp"

namespace flatpose::locate {

/// Takes (and leaves taken) the scratch of build_features(), also from a measuring arena.
void reserve_feature_scratch(Arena& arena, const rectify::Grid& fine) noexcept;

/// Fills the fine and coarse images, tilts and places of `work`; nothing is claimed yet.
/// Memory: `scratch`, given back.  Fails: as what it calls.  Thread: reentrant; shared out over
/// `budget`.
[[nodiscard]] Status build_features(const scene::Scene& scene, const Settings& settings,
                                    Arena& scratch, const Budget& budget, Workspace& work) noexcept;

}  // namespace flatpose::locate
