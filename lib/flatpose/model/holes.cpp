#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "flatpose/core/maths.hpp"
#include "flatpose/model/landmarks.hpp"

namespace flatpose::model {
namespace {

constexpr int kPointCountMin = 8;
constexpr int kSectorCount = 12;
constexpr int kSectorsMissingMax = 2;

double squared_distance(const ContourPoint& a, const ContourPoint& b) noexcept {
  const double dx = static_cast<double>(a.x_mm) - b.x_mm;
  const double dy = static_cast<double>(a.y_mm) - b.y_mm;
  return dx * dx + dy * dy;
}

// Neighbours on a loop are no farther apart than a few of the typical distances.
double link_mm(const Template& part) noexcept {
  std::array<double, kContourPointCountMax> nearest2{};
  const int count = part.contour_count;
  for (int i = 0; i < count; ++i) {
    nearest2[i] = std::numeric_limits<double>::infinity();
    for (int j = 0; j < count; ++j) {
      if (j != i)
        nearest2[i] = std::min(nearest2[i], squared_distance(part.contour[i], part.contour[j]));
    }
  }
  if (count == 0) return 0.0;
  const auto middle = nearest2.begin() + count / 2;
  std::nth_element(nearest2.begin(), middle, nearest2.begin() + count);
  return 3.0 * std::sqrt(*middle);
}

class LoopFinder {
 public:
  LoopFinder(const Template& part, Landmarks& out) noexcept
      : part_(part), link_mm_(link_mm(part)), out_(out) {}

  void run() noexcept {
    for (int i = 0; i < part_.contour_count && out_.hole_count < kHoleCountMax; ++i) {
      if (is_visited_[i]) continue;
      collect(i);
      if (is_hole()) keep();
    }
  }

 private:
  // All points linked to the first; each is expanded once.
  void collect(int first) noexcept {
    member_count_ = 0;
    push(first);
    for (int k = 0; k < member_count_; ++k) {
      for (int j = 0; j < part_.contour_count; ++j) {
        if (!is_visited_[j] &&
            squared_distance(part_.contour[members_[k]], part_.contour[j]) <= link_mm_ * link_mm_) {
          push(j);
        }
      }
    }
  }
  void push(int i) noexcept {
    is_visited_[i] = true;
    members_[member_count_++] = i;
  }

  [[nodiscard]] bool is_hole() const noexcept {
    if (member_count_ < kPointCountMin) return false;
    double x_mm = 0.0;
    double y_mm = 0.0;
    for (int k = 0; k < member_count_; ++k) {
      x_mm += static_cast<double>(part_.contour[members_[k]].x_mm) / member_count_;
      y_mm += static_cast<double>(part_.contour[members_[k]].y_mm) / member_count_;
    }
    std::array<bool, kSectorCount> is_taken{};
    int inward_count = 0;
    for (int k = 0; k < member_count_; ++k) {
      const ContourPoint& p = part_.contour[members_[k]];
      const double dx = x_mm - static_cast<double>(p.x_mm);
      const double dy = y_mm - static_cast<double>(p.y_mm);
      if (dx * p.nx + dy * p.ny > 0.0) ++inward_count;
      const double turn = arc_tangent(dy, dx) / (2.0 * kPi) + 0.5;
      is_taken[std::clamp(static_cast<int>(turn * kSectorCount), 0, kSectorCount - 1)] = true;
    }
    const auto taken = std::count(is_taken.begin(), is_taken.end(), true);
    return taken >= kSectorCount - kSectorsMissingMax && 5 * inward_count >= 4 * member_count_;
  }

  void keep() noexcept {
    ++out_.hole_count;
    for (int k = 0; k < member_count_; ++k)
      out_.hole[members_[k]] = static_cast<std::uint8_t>(out_.hole_count);
    out_.hole_point_count[out_.hole_count] = member_count_;
  }

  const Template& part_;
  double link_mm_;
  Landmarks& out_;
  std::array<bool, kContourPointCountMax> is_visited_{};
  std::array<int, kContourPointCountMax> members_{};
  int member_count_ = 0;
};

}  // namespace

void find_holes(const Template& part, Landmarks& out) noexcept { LoopFinder(part, out).run(); }

}  // namespace flatpose::model
