#pragma once
// Height maps with dark places, filled, and then with their pits lowered.

#include <gtest/gtest.h>

#include <cstddef>
#include <span>
#include <vector>

#include "flatpose/image/dark_pit.hpp"
#include "flatpose/image/fill.hpp"
#include "tests/lib/image/image.hpp"

namespace flatpose::image {

struct DarkMap {
  Image<float> filled;
  Image<float> lowered;
  Image<std::uint8_t> missing;

  explicit DarkMap(const Image<float>& height, const DarkPitConfig& config = {})
      : filled(height.width(), height.height()),
        lowered(filled),
        missing(height.width(), height.height()) {
    Arena measuring = Arena::measuring();
    reserve_fill_scratch(measuring, height.width());
    reserve_dark_pit_scratch(measuring, height.width(), height.height());
    std::vector<std::byte> memory(measuring.required_bytes());
    Arena arena{std::span(memory)};
    EXPECT_EQ(fill_missing(height.view(), filled.view(), missing.view(), arena), Status::kOk);
    lowered = filled;
    EXPECT_EQ(lower_dark_pits(config, arena, missing.view(), lowered.view()), Status::kOk);
    EXPECT_EQ(arena.used_bytes(), 0U);
  }
  [[nodiscard]] bool is_pit(int x, int y) const { return missing(x, y) == kDarkPit; }
  [[nodiscard]] int pit_count() const {
    int count = 0;
    for (int y = 0; y < missing.height(); ++y) {
      for (int x = 0; x < missing.width(); ++x) count += is_pit(x, y) ? 1 : 0;
    }
    return count;
  }
};

/// A map of heights, NaN where `is_dark`.
template <class HeightAt, class IsDark>
Image<float> map_of(int width_px, int height_px, const HeightAt& height_at, const IsDark& is_dark) {
  return Image<float>::of(width_px, height_px, [&](int x, int y) {
    return is_dark(x, y) ? kMissing : static_cast<float>(height_at(x, y));
  });
}

}  // namespace flatpose::image
