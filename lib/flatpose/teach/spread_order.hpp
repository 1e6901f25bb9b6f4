#pragma once
// Farthest-point order: each point is the one farthest from all before it, so that any first n are
// spread well. The order is the same every time, where the thesis draws at random.

#include <algorithm>
#include <limits>
#include <span>

namespace flatpose::teach {

/// Continues an order from `next` on, `nearest` holding each candidate's distance so far.
template <class Distance>
int continue_order(int candidate_count, int next, Distance&& distance, std::span<double> nearest,
                   std::span<int> order) noexcept {
  const int count = std::min(candidate_count, static_cast<int>(order.size()));
  for (int k = 0; k < count; ++k) {
    order[k] = next;
    int farthest = 0;
    for (int i = 0; i < candidate_count; ++i) {
      nearest[i] = std::min(nearest[i], distance(i, next));
      if (nearest[i] > nearest[farthest]) farthest = i;
    }
    if (!(nearest[farthest] > 0.0)) return k + 1;  // only copies are left
    next = farthest;
  }
  return count;
}

/// Picks `count` of `candidates` into `order` (indices), each as far as can be from those before
/// it. `distance(i, j)` is any non-negative measure; ties go to the lower index. Cost: count x
/// candidates.  Memory: `nearest` holds one value a candidate.
template <class Distance>
int spread_order(int candidate_count, int first, Distance&& distance, std::span<double> nearest,
                 std::span<int> order) noexcept {
  std::fill_n(nearest.begin(), candidate_count, std::numeric_limits<double>::infinity());
  return continue_order(candidate_count, first, distance, nearest, order);
}

/// The same within a border, `border(i)` away, that counts as taken already. Without it the order
/// runs along the border first, and any first n are denser there than inside.
template <class Border, class Distance>
int spread_order_within(int candidate_count, Border&& border, Distance&& distance,
                        std::span<double> nearest, std::span<int> order) noexcept {
  int innermost = 0;
  for (int i = 0; i < candidate_count; ++i) {
    nearest[i] = border(i);
    if (nearest[i] > nearest[innermost]) innermost = i;
  }
  return continue_order(candidate_count, innermost, distance, nearest, order);
}

}  // namespace flatpose::teach
