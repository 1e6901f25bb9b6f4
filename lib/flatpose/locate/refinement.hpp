#pragma once
// From a candidate of the search to the pose nearby that the images hold best: a loose look, a
// Levenberg-Marquardt from afar, a look whether that came to anything, and one from near.

#include "flatpose/locate/settings.hpp"
#include "flatpose/locate/verify.hpp"
#include "flatpose/refine/pose_problem.hpp"

namespace flatpose::locate {

struct Refined {
  bool is_moved = false;  ///< Whether the candidate was worth a refinement.
  bool is_found = false;  ///< Whether that came to a pose worth keeping.
  Pose work_T_object;
  Verification verification;
};

class Refinement {
 public:
  /// What is referred to must outlive it and may be filled later.
  Refinement(const model::Template& part, const refine::FineImages& images,
             const Settings& settings, const Verifier& verifier) noexcept
      : part_(part), images_(images), settings_(settings), verifier_(verifier) {}

  /// Cost: 10 us for a candidate that is none, some hundred for one that is.  Thread: reentrant.
  [[nodiscard]] Refined operator()(const Pose& start) const noexcept;

 private:
  const model::Template& part_;
  const refine::FineImages& images_;
  const Settings& settings_;
  const Verifier& verifier_;
};

}  // namespace flatpose::locate
