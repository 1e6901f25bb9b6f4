#include "flatpose/image/edge.hpp"

#include <cmath>

namespace flatpose::image {

int octant_of(float dx, float dy) noexcept {
  constexpr float kTanEighthOfPi = 0.41421356F;  // the border between two octants lies at 22.5 deg
  const float ax = std::fabs(dx);
  const float ay = std::fabs(dy);
  if (ay <= kTanEighthOfPi * ax) return dx >= 0.0F ? 0 : 4;
  if (ax <= kTanEighthOfPi * ay) return dy >= 0.0F ? 2 : 6;
  if (dx >= 0.0F) return dy >= 0.0F ? 1 : 7;
  return dy >= 0.0F ? 3 : 5;
}

}  // namespace flatpose::image
