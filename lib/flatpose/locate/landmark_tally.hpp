#pragma once
// Whether what tells a part from its look-alikes is there.

#include <algorithm>
#include <array>
#include <limits>

#include "flatpose/model/template.hpp"

namespace flatpose::locate {

/// What a scan says to one point of the contour.
struct PointVerdict {
  bool seen = false;
  double agreement = 0.0;                                        ///< 1: confirmed, 0: contradicted.
  double distance_px = std::numeric_limits<double>::infinity();  ///< Of the edge.
};

/// Every hole that can be seen must be there: one that is not is enough, so the worst decides. And
/// something must be seen of what its own face alone shows.
class LandmarkTally {
 public:
  explicit LandmarkTally(const model::Landmarks& landmarks) noexcept : landmarks_(landmarks) {}

  void add(int point, const PointVerdict& verdict) noexcept {
    holes_[landmarks_.hole[point]].add(verdict.agreement);
    const double gap_px = landmarks_.telltale_gap_px[point];
    if (gap_px > 0.0) {
      telltales_.add(verdict.distance_px < 0.5 * gap_px ? 1.0 : 0.0);
    } else {
      common_.add(verdict.distance_px < 0.5 * model::kTelltaleGapMin_px ? 1.0 : 0.0);
    }
  }

  /// A place where the contour would be if the part lay on its face.
  void add_mirrored(int index, const PointVerdict& verdict) noexcept {
    const double gap_px = landmarks_.mirrored_gap_px[index];
    telltales_.add(verdict.distance_px > 0.5 * gap_px ? 1.0 : 0.0);
  }

  /// 1 when every hole seen is there, less when one is hardly there.
  [[nodiscard]] double agreement() const noexcept {
    constexpr double kSeenShare = 0.5;
    constexpr double kEnough = 0.65;
    double worst = 1.0;
    for (int i = 1; i <= landmarks_.hole_count; ++i) {
      if (holes_[i].seen_count < kSeenShare * landmarks_.hole_point_count[i]) continue;
      worst = std::min(worst, holes_[i].mean_agreement() / kEnough);
    }
    return worst;
  }
  /// Whether the contour seen is the one of the part's own face; a part whose faces differ too
  /// little for the cells shows it always.
  [[nodiscard]] bool shows_face(int contour_count) const noexcept {
    constexpr double kTelltaleShareMin = 0.06;
    constexpr double kConfirmedMin = 2.0;
    constexpr double kAgreementMin = 0.3;
    const int count = landmarks_.telltale_count + landmarks_.mirrored_count;
    if (count < kTelltaleShareMin * contour_count) return true;
    // Where the contour that both faces have in common is met sharply, so must be what tells.
    constexpr double kCommonShare = 0.6;
    const double common = common_.seen_count > 0 ? common_.mean_agreement() : 0.0;
    const double least = std::max(kAgreementMin, kCommonShare * common);
    // A handful of votes, where a hundred could be cast, decides only when it is clear.
    constexpr double kFewShare = 0.05;
    constexpr double kClearMin = 0.6;
    const bool are_few = telltales_.agreement_sum < kFewShare * count;
    return telltales_.agreement_sum >= kConfirmedMin &&
           telltales_.mean_agreement() >= (are_few ? kClearMin : least);
  }

 private:
  struct Tally {
    int seen_count = 0;
    double agreement_sum = 0.0;
    void add(double agreement) noexcept {
      ++seen_count;
      agreement_sum += agreement;
    }
    [[nodiscard]] double mean_agreement() const noexcept { return agreement_sum / seen_count; }
  };

  const model::Landmarks& landmarks_;
  std::array<Tally, model::kHoleCountMax + 1> holes_{};
  Tally telltales_;
  Tally common_;  ///< What both faces show, asked as strictly as a telltale may be.
};

}  // namespace flatpose::locate
