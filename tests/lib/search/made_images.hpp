#pragma once
// Search images and templates made by hand, with memory of their own.

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <memory>
#include <random>
#include <vector>

#include "flatpose/core/maths.hpp"
#include "flatpose/search/grid_search.hpp"

namespace flatpose::search {

inline double uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
}
inline int integer(std::mt19937& random, int low, int high) {
  return low + static_cast<int>(random() % static_cast<unsigned>(high - low + 1));
}

/// An arena over bytes of its own.
struct Memory {
  std::vector<std::byte> bytes;
  Arena arena;
  explicit Memory(std::size_t size_bytes) : bytes(size_bytes), arena(std::span(bytes)) {}
};

/// Images of a coarse level of this size: a level floor of height 0, no edge anywhere.
struct MadeImages {
  Memory memory{1 << 22};
  SearchImages images;
  TiltField field;

  MadeImages(int width_px, int height_px, double cell_mm = 1.0) {
    rectify::Grid fine;
    fine.cell_mm = cell_mm / 2.0;
    fine.width_px = 2 * width_px;
    fine.height_px = 2 * height_px;
    images = take_search_images(memory.arena, fine);
    field = take_tilt_field(memory.arena, width_px, height_px);
    for_each([&](int x, int y) {
      images.filled_mm(x, y) = 0.0F;
      images.missing(x, y) = 0;
      for (const auto& channel : images.edge_cost) channel(x, y) = kEdgeCostMax;
      images.height_unit(x, y) = 0;
      images.normal_x_unit(x, y) = images.normal_y_unit(x, y) = 0;
      field.slope_x(x, y) = field.slope_y(x, y) = field.plane_mm(x, y) = field.rms_mm(x, y) = 0.0F;
    });
  }

  template <class Function>
  void for_each(const Function& at) const {
    for (int y = 0; y < images.grid.height_px; ++y) {
      for (int x = 0; x < images.grid.width_px; ++x) at(x, y);
    }
  }

  /// Any value in every image that the score reads.
  void randomise(std::mt19937& random, int height_reach_unit) const {
    for_each([&](int x, int y) {
      images.missing(x, y) = random() % 8 == 0 ? 1 : 0;
      for (const auto& channel : images.edge_cost)
        channel(x, y) = static_cast<std::uint8_t>(integer(random, 0, kEdgeCostMax));
      images.height_unit(x, y) =
          static_cast<std::int16_t>(integer(random, -height_reach_unit, height_reach_unit));
      images.normal_x_unit(x, y) = static_cast<std::int8_t>(integer(random, -127, 127));
      images.normal_y_unit(x, y) = static_cast<std::int8_t>(integer(random, -127, 127));
    });
  }
};

/// A flat part of random points, all within `radius_mm` of its anchor.
inline std::unique_ptr<model::Template> random_part(std::mt19937& random, double radius_mm,
                                                    int contour_count = 12,
                                                    int surface_count = 10) {
  auto part = std::make_unique<model::Template>();
  const auto coordinate = [&] {
    return static_cast<float>(uniform(random, -0.7 * radius_mm, 0.7 * radius_mm));
  };
  part->contour_count = contour_count;
  for (int i = 0; i < contour_count; ++i) {
    const double angle_rad = uniform(random, -kPi, kPi);
    part->contour[i] = {coordinate(),
                        coordinate(),
                        static_cast<float>(uniform(random, -1.0, 1.0)),
                        static_cast<float>(std::cos(angle_rad)),
                        static_cast<float>(std::sin(angle_rad)),
                        4.0F,
                        0.1F};
  }
  part->surface_count = surface_count;
  for (int i = 0; i < surface_count; ++i) {
    part->surface[i] = {coordinate(), coordinate(), static_cast<float>(uniform(random, -1.0, 1.0)),
                        static_cast<float>(uniform(random, -0.3, 0.3)),
                        static_cast<float>(uniform(random, -0.3, 0.3))};
  }
  part->anchor_count = 1;
  part->radius_mm = radius_mm;
  return part;
}

/// A rectangular plate, origin and anchor in its middle, x along its length.
inline std::unique_ptr<model::Template> plate(double length_mm, double width_mm) {
  auto part = std::make_unique<model::Template>();
  const auto contour = [&](double x, double y, double nx, double ny) {
    part->contour[part->contour_count++] = {static_cast<float>(x),
                                            static_cast<float>(y),
                                            0.0F,
                                            static_cast<float>(nx),
                                            static_cast<float>(ny),
                                            4.0F,
                                            0.1F};
  };
  for (const double share : {-0.4, 0.4, 0.0, -0.2, 0.2}) {
    contour(share * length_mm, width_mm / 2, 0, 1);
    contour(share * length_mm, -width_mm / 2, 0, -1);
    contour(length_mm / 2, share * width_mm, 1, 0);
    contour(-length_mm / 2, share * width_mm, -1, 0);
  }
  for (const double x : {-0.35, 0.35, 0.0}) {
    for (const double y : {-0.3, 0.3, 0.0}) {
      part->surface[part->surface_count++] = {static_cast<float>(x * length_mm),
                                              static_cast<float>(y * width_mm), 0.0F, 0.0F, 0.0F};
    }
  }
  part->anchor_count = 1;
  part->radius_mm = std::hypot(length_mm, width_mm) / 2;
  part->symmetry.order = 2;
  return part;
}

}  // namespace flatpose::search
