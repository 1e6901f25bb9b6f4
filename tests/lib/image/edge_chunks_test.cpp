// Edges found chunk by chunk, in any order and side by side, are the same edges.

#include <gtest/gtest.h>

#include <cstring>

#include "flatpose/image/canny.hpp"
#include "tests/lib/image/executors.hpp"
#include "tests/lib/image/image.hpp"
#include "tests/lib/search/vector_paths.hpp"

namespace flatpose::image {
namespace {

struct Found {
  Image<std::uint8_t> kinds;
  std::vector<EdgePoint> points;
};

/// Discs on a slope with noise, some of it missing; more rows than chunks hold at once.
struct Discs {
  static constexpr int kWidth_px = 90, kHeight_px = 700;
  Image<float> height{kWidth_px, kHeight_px};
  Image<std::uint8_t> missing{kWidth_px, kHeight_px};

  Discs() {
    std::mt19937 generator(4);
    std::uniform_real_distribution<float> u(-1.0F, 1.0F);
    for (int y = 0; y < kHeight_px; ++y) {
      for (int x = 0; x < kWidth_px; ++x) {
        const int dx = x % 45 - 22, dy = y % 47 - 23;
        const float step_mm = dx * dx + dy * dy < 250 ? 3.0F : 0.0F;
        height(x, y) = 0.1F * static_cast<float>(x) + step_mm + 0.3F * u(generator);
        missing(x, y) = u(generator) > 0.9F ? 1 : 0;
      }
    }
  }
  [[nodiscard]] Found edges(const EdgeConfig& config, VectorPath path, Executor& executor) {
    Found found{Image<std::uint8_t>(kWidth_px, kHeight_px, 77), std::vector<EdgePoint>(30000)};
    Arena measuring = Arena::measuring();
    reserve_edge_scratch(measuring, kWidth_px, kHeight_px);
    std::vector<std::byte> memory(measuring.required_bytes());
    Arena arena{std::span(memory)};
    const Result<int> count = detect_edges(height.view(), missing.view(), 1.0, config, arena,
                                           found.kinds.view(), found.points, path, executor);
    EXPECT_TRUE(count);
    found.points.resize(count ? static_cast<std::size_t>(*count) : 0);
    return found;
  }
};

bool same(const EdgePoint& a, const EdgePoint& b) {
  return std::memcmp(&a.x_px, &b.x_px, 5 * sizeof(float)) == 0 && a.column == b.column &&
         a.row == b.row && a.kind == b.kind;
}

TEST(EdgeChunks, GiveTheSameEdgesWhoeverRunsThem) {
  Discs discs;
  EdgeConfig with_creases;
  with_creases.crease_low_rad = 0.2F;
  with_creases.crease_high_rad = 0.3F;
  for (const EdgeConfig& config : {EdgeConfig{}, with_creases}) {
    InlineExecutor one_by_one;
    const Found expected = discs.edges(config, VectorPath::kPortable, one_by_one);
    EXPECT_GT(expected.points.size(), 1000U);
    for (const VectorPath path : vector_paths()) {
      for_each_executor([&](Executor& executor) {
        const Found found = discs.edges(config, path, executor);
        ASSERT_EQ(found.kinds, expected.kinds);
        ASSERT_EQ(found.points.size(), expected.points.size());
        for (std::size_t i = 0; i < found.points.size(); ++i)
          ASSERT_TRUE(same(found.points[i], expected.points[i])) << i;
      });
    }
  }
}

TEST(EdgeChunks, ComeRowByRowAndOnceEach) {
  Discs discs;
  ReverseExecutor reverse;
  const Found found = discs.edges({}, VectorPath::kPortable, reverse);
  for (std::size_t i = 1; i < found.points.size(); ++i) {
    const EdgePoint &a = found.points[i - 1], &b = found.points[i];
    ASSERT_TRUE(a.row < b.row || (a.row == b.row && a.column < b.column));
  }
}

}  // namespace
}  // namespace flatpose::image
