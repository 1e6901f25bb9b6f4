#include "port/linux/tool/engine.hpp"

#include <algorithm>
#include <cstdint>

#include "port/linux/cpu/vector_path.hpp"
#include "port/linux/files/input_error.hpp"

namespace flatpose::tool {
namespace {

constexpr int kSideMax_px = 32767;
constexpr std::int64_t kCellsMin = 1'000'000;
constexpr std::int64_t kCellsMax = 16'000'000;
constexpr std::int64_t kCellsPerPoint = 2;

}  // namespace

locate::Limits limits_for(const port::Scan& scan) noexcept {
  const std::int64_t points = static_cast<std::int64_t>(scan.width_px) * scan.height_px;
  return {scan.width_px, scan.height_px,
          static_cast<int>(std::clamp(kCellsPerPoint * points, kCellsMin, kCellsMax)),
          port::best_vector_path()};
}

locate::Limits larger(const locate::Limits& a, const locate::Limits& b) noexcept {
  return {std::max(a.scan_width_px, b.scan_width_px), std::max(a.scan_height_px, b.scan_height_px),
          std::max(a.cell_count, b.cell_count), a.vector_path};
}

void check_sides(const std::string& path, const port::Scan& scan) {
  const int side_px = std::max(scan.width_px, scan.height_px);
  if (side_px > kSideMax_px)
    throw port::InputError(path,
                           std::to_string(side_px) + " pixels along a side are more than " +
                               std::to_string(kSideMax_px),
                           "crop the scan");
}

}  // namespace flatpose::tool
