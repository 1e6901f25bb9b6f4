#pragma once
// Runs the whole chain, fill and edges, on a made height map.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "flatpose/core/maths.hpp"
#include "flatpose/image/canny.hpp"
#include "flatpose/image/fill.hpp"
#include "tests/lib/image/image.hpp"

namespace flatpose::image {

struct Edges {
  std::vector<EdgePoint> points;
  Image<std::uint8_t> kinds;
};

inline Edges edges_of(const Image<float>& height, const EdgeConfig& config = {},
                      double cell_mm = 1.0) {
  const int w = height.width();
  const int h = height.height();
  Image<float> filled(w, h);
  Image<std::uint8_t> missing(w, h);
  Edges edges{std::vector<EdgePoint>(static_cast<std::size_t>(w * h)), Image<std::uint8_t>(w, h)};
  Arena measuring = Arena::measuring();
  reserve_fill_scratch(measuring, w);
  measuring.rewind(0);
  reserve_edge_scratch(measuring, w, h);
  std::vector<std::byte> memory(measuring.required_bytes());
  Arena arena{std::span(memory)};
  (void)fill_missing(height.view(), filled.view(), missing.view(), arena);
  const Result<int> count = detect_edges(filled.view(), missing.view(), cell_mm, config, arena,
                                         edges.kinds.view(), edges.points);
  EXPECT_TRUE(count) << to_string(count.status());
  edges.points.resize(count ? static_cast<std::size_t>(*count) : 0);
  EXPECT_EQ(arena.used_bytes(), 0U);
  return edges;
}

/// A straight step through the middle of a square map, on a plane, point-sampled or averaged over
/// each cell, with noise.
struct StepScene {
  double angle_rad = 0.0;  // where it falls to
  double offset_px = 0.0;  // of the step from the middle
  double step_mm = 4.0;
  double tilt_rad = 0.0;
  double tilt_azimuth_rad = 0.0;
  double noise_mm = 0.0;
  int samples = 1;  // of a cell's area, along each axis

  static constexpr int kSize_px = 101;
  static constexpr int kMiddle_px = kSize_px / 2;

  [[nodiscard]] double beyond(double x_px, double y_px) const {
    return (x_px - kMiddle_px) * std::cos(angle_rad) + (y_px - kMiddle_px) * std::sin(angle_rad) -
           offset_px;
  }
  [[nodiscard]] double plane(double x_px, double y_px) const {
    return std::tan(tilt_rad) *
           (x_px * std::cos(tilt_azimuth_rad) + y_px * std::sin(tilt_azimuth_rad));
  }
  [[nodiscard]] Image<float> map(unsigned seed) const {
    std::mt19937 generator(seed);
    std::normal_distribution<double> noise(0.0, 1.0);
    return Image<float>::of(kSize_px, kSize_px, [&](int x, int y) {
      int upper = 0;
      for (int j = 0; j < samples; ++j) {
        for (int i = 0; i < samples; ++i) {
          const double dx = (i + 0.5) / samples - 0.5;
          const double dy = (j + 0.5) / samples - 0.5;
          upper += beyond(x + dx, y + dy) < 0.0 ? 1 : 0;
        }
      }
      return step_mm * upper / (samples * samples) + plane(x, y) + noise_mm * noise(generator);
    });
  }
};

}  // namespace flatpose::image
