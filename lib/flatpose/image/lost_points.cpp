#include "flatpose/image/lost_points.hpp"

#include "flatpose/image/row_kernels.hpp"

namespace flatpose::image {
namespace {

double single_share(ImageView<const std::uint8_t> missing, VectorPath path) noexcept {
  const RowKernels& kernels = row_kernels(path);
  std::int64_t count = 0;
  for (int y = 1; y + 1 < missing.height_px; ++y) {
    count += kernels.count_single(missing.row(y - 1), missing.row(y), missing.row(y + 1),
                                  missing.width_px);
  }
  return static_cast<double>(count) / missing.width_px / missing.height_px;
}

}  // namespace

double lost_share(ImageView<const std::uint8_t> missing, VectorPath path) noexcept {
  if (missing.empty()) return 0.0;
  constexpr int kRoundCount = 30;
  constexpr double kShareMax = 0.2;  // where p (1 - p)^4 is largest
  const double single = single_share(missing, path);
  double share = single;
  for (int round = 0; round < kRoundCount && share < kShareMax; ++round) {
    const double kept2 = (1.0 - share) * (1.0 - share);
    share = single / (kept2 * kept2);
  }
  return share < kShareMax ? share : kShareMax;
}

int accidental_side_px(ImageView<const std::uint8_t> missing, int least_px,
                       VectorPath path) noexcept {
  constexpr double kExpectedMax = 0.01;
  constexpr int kSideMax_px = 8;
  const double share = lost_share(missing, path);
  int side_px = least_px;
  for (; side_px < kSideMax_px; ++side_px) {
    double expected = 1.0 * missing.width_px * missing.height_px;
    for (int point = 0; point < side_px * side_px; ++point) expected *= share;
    if (expected <= kExpectedMax) break;
  }
  return side_px;
}

}  // namespace flatpose::image
