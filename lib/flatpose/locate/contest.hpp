#pragma once
// From the candidates of the search to matches: refined, polished, judged, best first, and none
// counted twice.

#include <span>

#include "flatpose/core/budget.hpp"
#include "flatpose/locate/acceptance.hpp"
#include "flatpose/locate/instances.hpp"
#include "flatpose/locate/locator.hpp"
#include "flatpose/locate/pose_set.hpp"
#include "flatpose/locate/refinement.hpp"
#include "flatpose/locate/settings.hpp"
#include "flatpose/locate/stopwatch.hpp"
#include "flatpose/locate/workspace.hpp"
#include "flatpose/refine/raw_scan.hpp"
#include "flatpose/search/candidate.hpp"

namespace flatpose::locate {

/// All that a contest reads. What is referred to must outlive it.
struct ContestGround {
  const model::Template& part;
  const Frames& frames;
  const LocateConfig& config;
  const Settings& settings;
  refine::RawScan raw;
};

class Contest {
 public:
  /// Works in `work`, writes matches into `result`, and tells `watch` of its laps.
  Contest(const ContestGround& ground, Workspace& work, const Budget& budget, Stopwatch& watch,
          LocateResult& result) noexcept;

  /// Refines and polishes the candidates of one anchor, best first.
  void enter(std::span<const search::Candidate> candidates) noexcept;
  /// Whether as many as are asked for are beyond doubt, each in a place of its own: other anchors
  /// need not be searched then.
  [[nodiscard]] bool has_enough() const noexcept;
  /// Turns instances into matches, in the order asked for; when the budget is over, only such as
  /// are polished already.
  void accept() noexcept;
  /// See Acceptance.
  [[nodiscard]] bool is_ambiguous() const noexcept { return acceptance_.is_ambiguous(); }

 private:
  void refine(std::span<const search::Candidate> round, bool only_rivals) noexcept;
  void polish_best() noexcept;
  bool polish(Instance& instance) noexcept;
  bool consider(int index) noexcept;
  void accept_polished() noexcept;
  Verdict decide(Instance& instance) noexcept;
  void close_place_of(const Instance& guess) noexcept;

  [[nodiscard]] bool is_beyond_doubt(const Instance& instance) const noexcept;
  [[nodiscard]] bool is_rival(const Pose& start) const noexcept;
  [[nodiscard]] bool is_explained(const search::Candidate& candidate) const noexcept;
  [[nodiscard]] bool is_on_surface(const Vec3& p_object_mm) const noexcept;
  [[nodiscard]] bool has_news(const Instance& instance) const noexcept;
  [[nodiscard]] bool is_same_place(const Pose& a, const Pose& b) const noexcept;

  const ContestGround ground_;
  const model::Template& part_;
  const Settings& settings_;
  Workspace& work_;
  const Budget& budget_;
  Stopwatch& watch_;
  LocateResult& result_;
  Verifier verifier_;
  Refinement refinement_;
  Acceptance acceptance_;
  Instances instances_;
  PoseSet tried_;
};

}  // namespace flatpose::locate
