#define FLATPOSE_LANES 16
#include "flatpose/search/lay_points.inc"

namespace flatpose::search {
void lay_points_portable(const PointSet& points, const LaidPlane& plane,
                         LaidPoints& laid) noexcept {
  lay_points(points, plane, laid);
}
}  // namespace flatpose::search
