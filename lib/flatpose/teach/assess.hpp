#pragma once
// What a template is worth: its own threshold, and what an integrator should know about it.

#include "flatpose/locate/locator.hpp"
#include "flatpose/model/template.hpp"

namespace flatpose::teach {

/// Sets self_score, rival_score and score_threshold from a search for everything that resembles the
/// part in its own teach scan. The threshold lies in the widest gap between the scores found there:
/// below the part and its like, above what only resembles it.
void set_threshold(const locate::LocateResult& everything, const Pose& face_T_object,
                   model::Template& part) noexcept;

/// Sets the bits of Weakness that the template itself shows.
void find_weakness(model::Template& part) noexcept;

}  // namespace flatpose::teach
