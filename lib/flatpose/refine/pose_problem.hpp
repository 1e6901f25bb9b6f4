#pragma once
// The refinement's residuals over the six parameters of a pose (Ingberg 2015, 2.6 and 2.11):
// distances of the contour to the nearest edge that falls the same way, differences of normals, and
// of heights.
//
// The pose moves in its own frame: work_T_object (+) h turns by (h0, h1, h2) about the object's
// axes and then shifts by (h3, h4, h5) along them, so a point p goes to R (p + h_r x p + h_t) + t
// to first order, which is all that a derivative at h = 0 needs.

#include "flatpose/model/template.hpp"
#include "flatpose/refine/fine_images.hpp"
#include "flatpose/refine/levenberg_marquardt.hpp"

namespace flatpose::refine {

struct PoseProblemConfig {
  int contour_count = 128;  ///< Points of the dense set that take part.
  int surface_count = 64;
  double edge_reach_mm = 4.0;      ///< Edges farther than this are no evidence (Tukey's scale).
  double height_reach_mm = 2.0;    ///< The same for heights below the part.
  double covering_reach_mm = 2.0;  ///< For heights above it: what hides a part may lie on it.
  double normal_reach = 0.3;
  double edge_sigma_mm = 0.5;  ///< Standard deviations, which weigh the three kinds.
  double height_sigma_mm = 0.4;
  double normal_sigma = 0.2;
};

class PoseProblem {
 public:
  PoseProblem(const model::Template& part, const FineImages& images,
              const PoseProblemConfig& config) noexcept
      : part_(part), images_(images), config_(config) {}

  bool evaluate(const Pose& work_T_object, NormalEquations<6>* equations) const noexcept;
  [[nodiscard]] Pose plus(const Pose& work_T_object, const Vector<6>& step) const noexcept;

 private:
  void add_contour(const Pose& pose, NormalEquations<6>* equations) const noexcept;
  void add_surface(const Pose& pose, NormalEquations<6>* equations) const noexcept;

  const model::Template& part_;
  const FineImages& images_;
  const PoseProblemConfig& config_;
};

/// The pose moved by a step in its own frame.
[[nodiscard]] Pose moved(const Pose& pose, const Vector<6>& step) noexcept;

}  // namespace flatpose::refine
