#define FLATPOSE_LANES 64
#include "flatpose/search/lay_points.inc"

namespace flatpose::search {
void lay_points_avx512(const PointSet& points, const LaidPlane& plane, LaidPoints& laid) noexcept {
  lay_points(points, plane, laid);
}
}  // namespace flatpose::search
