#include "flatpose/image/glance.hpp"

#include <gtest/gtest.h>

#include <random>
#include <utility>
#include <vector>

namespace flatpose::image {
namespace {

std::vector<std::uint8_t> random_row(std::mt19937& generator, int width_px) {
  std::vector<std::uint8_t> row(static_cast<std::size_t>(width_px));
  const unsigned rare = 1 + generator() % 8;
  constexpr std::uint8_t kMarks[] = {1, 0x80, 0xFF};
  for (auto& mark : row) {
    const bool set = generator() % 8 < rare;
    mark = set ? kMarks[generator() % 3] : std::uint8_t{0};
  }
  return row;
}

TEST(Glance, FindsWhatOneLookAtATimeFinds) {
  std::mt19937 generator(5);
  for (int trial = 0; trial < 2000; ++trial) {
    const int w = trial % 70;
    const std::vector<std::uint8_t> row = random_row(generator, w);
    std::vector<int> expected, found;
    std::vector<std::pair<int, int>> expected_runs, runs;
    for (int x = 0; x < w; ++x) {
      if (row[x] == 0) continue;
      expected.push_back(x);
      if (x == 0 || row[x - 1] == 0) expected_runs.emplace_back(x, x);
      expected_runs.back().second = x + 1;
    }
    for_each_set(row.data(), w, [&](int x) { found.push_back(x); });
    for_each_run(row.data(), w, [&](int begin, int end) { runs.emplace_back(begin, end); });
    ASSERT_EQ(found, expected);
    found.clear();
    for_each_set_backward(row.data(), w, [&](int x) { found.push_back(x); });
    ASSERT_EQ(found, std::vector<int>(expected.rbegin(), expected.rend()));
    ASSERT_EQ(runs, expected_runs);
  }
}

TEST(Glance, BodyMayClearWhatItIsGiven) {
  std::vector<std::uint8_t> row(21, 1);
  int count = 0;
  for_each_set(row.data(), 21, [&](int x) { row[x] = 0, ++count; });
  EXPECT_EQ(count, 21);
}

}  // namespace
}  // namespace flatpose::image
