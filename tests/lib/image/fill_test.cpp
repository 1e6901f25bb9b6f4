#include "flatpose/image/fill.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "tests/lib/image/executors.hpp"
#include "tests/lib/image/image.hpp"
#include "tests/lib/search/vector_paths.hpp"

namespace flatpose::image {
namespace {

// By the definition: walk in four directions from every missing cell.
float brute_force(const Image<float>& z, int x, int y) {
  if (std::isfinite(z(x, y))) return z(x, y);
  float lowest = INFINITY;
  float lowest_of_all = INFINITY;
  for (int r = 0; r < z.height(); ++r) {
    for (int c = 0; c < z.width(); ++c) {
      if (std::isfinite(z(c, r))) lowest_of_all = std::min(lowest_of_all, z(c, r));
    }
  }
  for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
    for (int c = x, r = y; c >= 0 && r >= 0 && c < z.width() && r < z.height(); c += dx, r += dy) {
      if (!std::isfinite(z(c, r))) continue;
      lowest = std::min(lowest, z(c, r));
      break;
    }
  }
  return std::isfinite(lowest) ? lowest : lowest_of_all;
}

class FillMissing : public ::testing::Test {
 protected:
  FillMissing() : memory_(4096), arena_(std::span(memory_)) {}
  std::vector<std::byte> memory_;
  Arena arena_;
};

TEST_F(FillMissing, EqualsBruteForceOnAllMasksUpTo4x3AndOnLargerOnes) {
  const auto check = [&](const Image<float>& z) {
    Image<float> filled(z.width(), z.height());
    Image<std::uint8_t> missing(z.width(), z.height());
    ASSERT_EQ(fill_missing(z.view(), filled.view(), missing.view(), arena_), Status::kOk);
    for (int y = 0; y < z.height(); ++y) {
      for (int x = 0; x < z.width(); ++x) {
        ASSERT_EQ(filled(x, y), brute_force(z, x, y));
        ASSERT_EQ(missing(x, y), std::isfinite(z(x, y)) ? 0 : 1);
      }
    }
  };
  for (int h = 1; h <= 3; ++h) {
    for (int w = 1; w <= 4; ++w) {
      for (unsigned mask = 0; mask + 1 < 1U << (w * h); ++mask) {
        Image<float> z = random_image(w, h, mask);
        for (int i = 0; i < w * h; ++i) {
          if ((mask >> i & 1U) != 0) z(i % w, i / w) = i % 3 == 0 ? INFINITY : kMissing;
        }
        check(z);
      }
    }
  }
  for (unsigned seed = 0; seed < 20; ++seed) {
    Image<float> z = random_image(40, 30, seed);
    const Image<float> lost = random_image(40, 30, seed + 100);
    for (int i = 0; i < 1200; ++i) {
      if (lost(i % 40, i / 40) < static_cast<float>(seed) - 9.5F) z(i % 40, i / 40) = kMissing;
    }
    check(z);
  }
}

TEST_F(FillMissing, IsTheSameWhoeverFillsAndOnEveryPath) {
  constexpr int kWidth_px = 300, kHeight_px = 40;
  memory_.resize(1 << 16);
  for (unsigned seed = 0; seed < 8; ++seed) {
    Image<float> z = random_image(kWidth_px, kHeight_px, seed);
    const Image<float> lost = random_image(kWidth_px, kHeight_px, seed + 100);
    for (int i = 0; i < kWidth_px * kHeight_px; ++i) {
      const int x = i % kWidth_px, y = i / kWidth_px;
      // Gaps across the middle, where columns are parted.
      const bool in_gap = y % 7 == 0 && std::abs(x - kWidth_px / 2) < 20 + y;
      if (in_gap || lost(x, y) < 2.0F * static_cast<float>(seed) - 8.0F) z(x, y) = kMissing;
    }
    const auto expected =
        Image<float>::of(kWidth_px, kHeight_px, [&](int x, int y) { return brute_force(z, x, y); });
    for (const VectorPath path : vector_paths()) {
      for_each_executor([&](Executor& executor) {
        Arena arena{std::span(memory_)};
        Image<float> filled(kWidth_px, kHeight_px);
        Image<std::uint8_t> missing(kWidth_px, kHeight_px);
        ASSERT_EQ(fill_missing(z.view(), filled.view(), missing.view(), arena, path, executor),
                  Status::kOk);
        for (int y = 0; y < kHeight_px; ++y) {
          for (int x = 0; x < kWidth_px; ++x) {
            ASSERT_EQ(filled(x, y), expected(x, y));
            ASSERT_EQ(missing(x, y), std::isfinite(z(x, y)) ? 0 : 1);
          }
        }
      });
    }
  }
}

TEST_F(FillMissing, WorksInPlace) {
  Image<float> z(5, 1, 4.0F);
  z(2, 0) = kMissing;
  z(3, 0) = 1.0F;
  Image<std::uint8_t> missing(5, 1);
  ASSERT_EQ(fill_missing(z.view(), z.view(), missing.view(), arena_), Status::kOk);
  EXPECT_EQ(z(2, 0), 1.0F);
  EXPECT_EQ(missing(2, 0), 1);
}

TEST_F(FillMissing, SaysWhenNothingIsValidAndStillWritesTheOutputs) {
  Image<float> z(5, 4, kMissing);
  Image<std::uint8_t> missing(5, 4);
  EXPECT_EQ(fill_missing(z.view(), z.view(), missing.view(), arena_), Status::kTooFewPoints);
  EXPECT_EQ(z, Image<float>(5, 4, 0.0F));
  EXPECT_EQ(missing, Image<std::uint8_t>(5, 4, 1));
}

TEST_F(FillMissing, NeedsWhatItReservesAndNoLess) {
  Arena measuring = Arena::measuring();
  reserve_fill_scratch(measuring, 50);
  Image<float> z(50, 2);
  Image<std::uint8_t> missing(50, 2);
  std::vector<std::byte> memory(measuring.required_bytes());
  Arena enough{std::span(memory)};
  EXPECT_EQ(fill_missing(z.view(), z.view(), missing.view(), enough), Status::kOk);
  EXPECT_EQ(enough.used_bytes(), 0U);
  Arena small{std::span(memory).first(100)};
  EXPECT_EQ(fill_missing(z.view(), z.view(), missing.view(), small), Status::kOutOfMemory);
  Image<float> other(49, 2);
  EXPECT_EQ(fill_missing(z.view(), other.view(), missing.view(), enough), Status::kShapeMismatch);
}

}  // namespace
}  // namespace flatpose::image
