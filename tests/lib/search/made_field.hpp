#pragma once
// Tilt fields made by hand, and the places collected from them.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "flatpose/search/places.hpp"
#include "tests/lib/image/image.hpp"
#include "tests/lib/search/memory.hpp"

namespace flatpose::search {

/// A level floor at height 0, perfectly planar.
struct MadeField {
  image::Image<float> slope_x;
  image::Image<float> slope_y;
  image::Image<float> plane_mm;
  image::Image<float> rms_mm;
  TiltField field;

  MadeField(int width_px, int height_px)
      : slope_x(width_px, height_px),
        slope_y(width_px, height_px),
        plane_mm(width_px, height_px),
        rms_mm(width_px, height_px),
        field{slope_x.view(), slope_y.view(), plane_mm.view(), rms_mm.view()} {}
  MadeField(const MadeField&) = delete;
  MadeField& operator=(const MadeField&) = delete;

  template <class Function>
  void for_each(const Function& at) {
    for (int y = 0; y < slope_x.height(); ++y) {
      for (int x = 0; x < slope_x.width(); ++x) at(x, y);
    }
  }
  void set_slope(int x, int y, double slope, double azimuth_rad) {
    slope_x(x, y) = static_cast<float>(slope * std::cos(azimuth_rad));
    slope_y(x, y) = static_cast<float>(slope * std::sin(azimuth_rad));
  }
};

/// Places in memory of exactly the size that they ask for.
struct MadePlaces {
  Memory memory;
  Places places;

  MadePlaces(int width_px, int height_px)
      : memory(required_bytes(width_px, height_px)),
        places(take_places(memory.arena, width_px, height_px)) {}
  explicit MadePlaces(const MadeField& made, const PlaceConfig& config = {})
      : MadePlaces(made.slope_x.width(), made.slope_x.height()) {
    EXPECT_EQ(collect_places(made.field, config, places), Status::kOk);
  }

  static std::size_t required_bytes(int width_px, int height_px) {
    Arena measuring = Arena::measuring();
    (void)take_places(measuring, width_px, height_px);
    return measuring.required_bytes();
  }
};

}  // namespace flatpose::search
