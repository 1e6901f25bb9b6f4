// Jumps tested and measured side by side come out as those taken one at a time, on every path.

#include "flatpose/image/jump_batch.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <random>
#include <vector>

#include "flatpose/image/row_kernels.hpp"
#include "flatpose/image/sobel.hpp"
#include "tests/lib/image/image.hpp"
#include "tests/lib/image/slow_jump.hpp"
#include "tests/lib/search/vector_paths.hpp"

namespace flatpose::image {
namespace {

constexpr float kLow_mm = 1.2F;

/// Steps in all directions on a slope, with noise; some of it was not seen.
struct Ground {
  Image<float> height;
  Image<std::uint8_t> missing;
  Image<float> slope_x;
  Image<float> slope_y;

  Ground(int width_px, int height_px, unsigned seed)
      : height(width_px, height_px),
        missing(width_px, height_px),
        slope_x(width_px, height_px),
        slope_y(width_px, height_px) {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<float> u(-1.0F, 1.0F);
    const float tilt = u(generator), cx = 20.0F + 10.0F * u(generator), radius = 12.0F;
    for (int y = 0; y < height_px; ++y) {
      for (int x = 0; x < width_px; ++x) {
        const auto fx = static_cast<float>(x), fy = static_cast<float>(y);
        const bool on_disc = (fx - cx) * (fx - cx) + (fy - 15.0F) * (fy - 15.0F) < radius * radius;
        height(x, y) = 0.4F * tilt * fx + (on_disc ? 4.0F : 0.0F) + (x + y > 40 ? 2.0F : 0.0F) +
                       0.2F * u(generator);
        missing(x, y) = u(generator) > 0.8F ? 1 : 0;
      }
    }
    if (sobel(height.view(), slope_x.view(), slope_y.view()) != Status::kOk) std::abort();
  }
  [[nodiscard]] SlopeField field() const {
    return {height.view(), missing.view(), slope_x.view(), slope_y.view()};
  }
};

bool same_bits(float a, float b) {
  return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}

/// Calls body(field, batch) for batches of all inner cells, of many sizes, in bands of rows.
template <class Body>
void for_each_batch(const Ground& ground, VectorPath path, const Body& body) {
  constexpr int kBandRows = 13;
  const int w = ground.height.width(), h = ground.height.height();
  std::vector<std::byte> memory(1 << 20);
  int size = 1;
  for (int begin = 1; begin + 1 < h; begin += kBandRows) {
    const int end = std::min(begin + kBandRows, h - 1);
    Arena arena{std::span(memory)};
    SlopeBand slopes = SlopeBand::take(arena, w, end - begin + 2 * SlopeBand::kHalo_px);
    slopes.fill(ground.height.view(), begin - SlopeBand::kHalo_px, end + SlopeBand::kHalo_px, path);
    const JumpField field(ground.height.view(), ground.missing.view(), slopes);
    JumpBatch batch;
    const auto flush = [&] {
      batch.pad();
      body(field, batch);
      batch.count = 0;
      size = size * 3 % JumpBatch::kCountMax + 1;
    };
    for (int y = begin; y < end; ++y) {
      for (int x = 1; x + 1 < w; ++x) {
        batch.add(x, y);
        if (batch.count == size) flush();
      }
    }
    if (batch.count > 0) flush();
  }
}

constexpr struct { int width_px, height_px; } kSizes[] = {{61, 47}, {9, 30}, {30, 5}, {3, 3}};

/// Calls body(slow field, field, batch) for all grounds, paths and batches.
template <class Body>
void for_each_ground(const Body& body) {
  for (const auto [width_px, height_px] : kSizes) {
    for (unsigned seed = 0; seed < 6; ++seed) {
      const Ground ground(width_px, height_px, seed);
      for (const VectorPath path : vector_paths()) {
        for_each_batch(ground, path, [&](const JumpField& field, JumpBatch& batch) {
          row_kernels(path).test_jumps(field, kLow_mm, batch);
          body(ground.field(), field, path, batch);
        });
      }
    }
  }
}

TEST(JumpBatch, TestsAsOneAtATime) {
  int found_count = 0;
  for_each_ground([&](const SlopeField& slow_field, const JumpField&, VectorPath path,
                      JumpBatch& batch) {
    int next = 0;
    for (int i = 0; i < batch.count; ++i) {
      const slow::Jump jump = slow::test_jump(slow_field, batch.column[i], batch.row[i], kLow_mm);
      if (!jump.found || !(jump.step_mm >= kLow_mm)) continue;
      ASSERT_LT(next, batch.jump_count);
      ASSERT_EQ(batch.index[next], i) << static_cast<int>(path);
      ASSERT_TRUE(same_bits(batch.tested_step_mm[next], jump.step_mm));
      ASSERT_EQ(batch.below_is_missing[next] != 0, jump.below_is_missing);
      ++next;
      ++found_count;
    }
    ASSERT_EQ(next, batch.jump_count);
  });
  EXPECT_GT(found_count, 500 * path_count());
}

TEST(JumpBatch, MeasuresAsOneAtATime) {
  int measured_count = 0;
  for_each_ground(
      [&](const SlopeField& slow_field, const JumpField& field, VectorPath path, JumpBatch& batch) {
        row_kernels(path).measure_jumps(field, batch);
        for (int i = 0; i < batch.jump_count; ++i) {
          const int cell = batch.index[i];
          const slow::Measured m =
              slow::measure_jump(slow_field, batch.column[cell], batch.row[cell], kLow_mm);
          ++measured_count;
          ASSERT_TRUE(same_bits(batch.x_px[i], m.at.x) && same_bits(batch.y_px[i], m.at.y))
              << static_cast<int>(path);
          ASSERT_TRUE(same_bits(batch.fall_x[i], m.fall.x) && same_bits(batch.fall_y[i], m.fall.y));
          ASSERT_TRUE(same_bits(batch.step_mm[i], m.step_mm));
        }
      });
  EXPECT_GT(measured_count, 500 * path_count());
}

}  // namespace
}  // namespace flatpose::image
