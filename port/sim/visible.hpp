#pragma once
// What the truth says of a part: which share of its top shows.

#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "port/sim/world.hpp"

namespace flatpose::sim {

/// Samples over the top of a part for the truth; a line of them is 1 %.
inline constexpr int kTruthSamples = 10000;

/// Keeps the sample points of the parts it was asked about.
class VisibleShare {
 public:
  VisibleShare(const World& world, const Ruler& ruler) noexcept : world_(world), ruler_(ruler) {}

  /// Share of the top (areas counted in) that laser and camera both see.
  /// Cost: about 0.5 us a sample, and ten times that when a part is new.
  [[nodiscard]] double of(const Instance& instance, int samples = kTruthSamples);

 private:
  const std::vector<Vec3>& top_points_mm(const std::shared_ptr<const Part>& part, int samples);

  const World& world_;
  const Ruler& ruler_;
  std::map<std::pair<std::shared_ptr<const Part>, int>, std::vector<Vec3>> points_mm_;
};

}  // namespace flatpose::sim
