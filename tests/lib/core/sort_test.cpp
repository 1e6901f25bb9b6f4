#include "flatpose/core/sort.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

namespace flatpose {
namespace {

TEST(SortInPlace, EqualsStdSortOnAllPermutationsAndRepeats) {
  for (int count = 0; count <= 7; ++count) {
    std::vector<int> order(static_cast<std::size_t>(count));
    std::iota(order.begin(), order.end(), 0);
    do {
      for (const int divisor : {1, 2, 3}) {
        std::vector<int> values = order;
        for (int& v : values) v /= divisor;
        std::vector<int> expected = values;
        std::sort(expected.begin(), expected.end(), [](int a, int b) { return a > b; });
        sort_in_place(std::span(values), [](int a, int b) { return a > b; });
        ASSERT_EQ(values, expected);
      }
    } while (std::next_permutation(order.begin(), order.end()));
  }
}

}  // namespace
}  // namespace flatpose
