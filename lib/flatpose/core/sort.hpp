#pragma once
// std::sort calls itself, so how deep depends on the data; this does not.

#include <algorithm>
#include <span>

namespace flatpose {

/// Sorts by heap: `precedes(a, b)` is a strict order, total where the outcome's bits matter.
/// Cost: n log n in every case.  Memory: none; the stack's depth is fixed.
template <class T, class Precedes>
void sort_in_place(std::span<T> values, Precedes precedes) noexcept {
  std::make_heap(values.begin(), values.end(), precedes);
  std::sort_heap(values.begin(), values.end(), precedes);
}

}  // namespace flatpose
