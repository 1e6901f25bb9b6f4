#pragma once
// Templates made by hand.

#include <cmath>
#include <memory>
#include <random>

#include "flatpose/core/maths.hpp"
#include "flatpose/model/template.hpp"
#include "tests/lib/search/memory.hpp"

namespace flatpose::search {

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
