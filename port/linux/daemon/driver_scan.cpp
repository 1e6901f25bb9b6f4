#include "port/linux/daemon/driver_scan.hpp"

#include <bit>
#include <cstring>
#include <limits>

#include "port/linux/daemon/scan_file.hpp"
#include "port/linux/files/scan.hpp"

namespace flatpose::daemon {
namespace {

constexpr std::size_t kBytesPerPointMax = 16;
constexpr std::size_t kPageBytes = 4096;
constexpr std::size_t kPointBytes = 3 * sizeof(float);

bool lies_within(const flatpose_camera_done_message& done, std::uint64_t offset,
                 std::uint64_t memory_bytes) noexcept {
  if (offset % sizeof(float) != 0 || offset > memory_bytes) return false;
  // Strides below 2^40, sides below 2^15: no sum overflows.
  const std::uint64_t last =
      offset + static_cast<std::uint64_t>(done.height_px - 1) * done.row_stride_bytes +
      static_cast<std::uint64_t>(done.width_px - 1) * done.pixel_stride_bytes;
  return last + sizeof(float) <= memory_bytes;
}

bool is_stride(std::uint64_t stride, std::uint64_t memory_bytes) noexcept {
  return stride > 0 && stride % sizeof(float) == 0 && stride <= memory_bytes;
}

std::string ms_text(std::int64_t time_us) {
  return std::to_string(time_us / 1000) + "." + std::to_string(time_us / 100 % 10) + " ms";
}

std::string fault_of_times(const flatpose_camera_done_message& done, const ScanOrder& order,
                           std::int64_t now_us) {
  if (done.start_us < 0) return "its times are negative; times are CLOCK_MONOTONIC";
  if (done.start_us < order.accepted_us)
    return "its acquisition began " + ms_text(order.accepted_us - done.start_us) +
           " before the command; let older scans go";
  if (done.end_us < done.start_us) return "its acquisition ends before it begins";
  if (done.end_us > now_us) return "its acquisition ends in the future; times are CLOCK_MONOTONIC";
  return {};
}

/// One row, out of memory that may change, to where it does not.
void copy_row(const std::byte* x, const std::byte* y, const std::byte* z, std::size_t stride_bytes,
              std::span<float> row) noexcept {
  const bool is_interleaved =
      stride_bytes == kPointBytes && y == x + sizeof(float) && z == y + sizeof(float);
  if (is_interleaved) {
    std::memcpy(row.data(), x, row.size_bytes());
    return;
  }
  for (std::size_t i = 0; i < row.size(); i += 3) {
    std::memcpy(&row[i], x, sizeof(float));
    std::memcpy(&row[i + 1], y, sizeof(float));
    std::memcpy(&row[i + 2], z, sizeof(float));
    x += stride_bytes;
    y += stride_bytes;
    z += stride_bytes;
  }
}

/// NaN is missing, and legal. In whole numbers, which order floats without a sign as they are and
/// are compared many at a time.
bool has_absurd(std::span<const float> row) noexcept {
  constexpr auto kMost = std::bit_cast<std::int32_t>(static_cast<float>(port::kCoordinateMax_mm));
  constexpr auto kInfinite = std::bit_cast<std::int32_t>(std::numeric_limits<float>::infinity());
  int has = 0;
  for (const float value_mm : row) {
    const std::int32_t bits = std::bit_cast<std::int32_t>(value_mm) & 0x7fffffff;
    has |= static_cast<int>(bits > kMost) & static_cast<int>(bits <= kInfinite);
  }
  return has != 0;
}

}  // namespace

std::size_t driver_memory_bytes(const locate::Limits& limits) noexcept {
  const std::size_t bytes = kBytesPerPointMax * static_cast<std::size_t>(limits.scan_width_px) *
                            static_cast<std::size_t>(limits.scan_height_px);
  return (bytes + kPageBytes - 1) / kPageBytes * kPageBytes;
}

std::string fault_of(const flatpose_camera_done_message& done, std::size_t memory_bytes,
                     const locate::Limits& limits, const ScanOrder& order, std::int64_t now_us) {
  const std::string shape = std::to_string(done.width_px) + " x " + std::to_string(done.height_px);
  if (done.width_px < 2 || done.height_px < 2)
    return shape + " pixels are not organized as an image";
  if (done.width_px > limits.scan_width_px || done.height_px > limits.scan_height_px)
    return shape + " pixels are more than [search] has memory for; raise scan_width_px and " +
           "scan_height_px";
  const bool is_within = is_stride(done.pixel_stride_bytes, memory_bytes) &&
                         is_stride(done.row_stride_bytes, memory_bytes) &&
                         lies_within(done, done.x_offset_bytes, memory_bytes) &&
                         lies_within(done, done.y_offset_bytes, memory_bytes) &&
                         lies_within(done, done.z_offset_bytes, memory_bytes);
  if (!is_within) return "its layout leaves the memory, or is not made of whole floats";
  if (done.up != FLATPOSE_CAMERA_UP_PLUS_Z && done.up != FLATPOSE_CAMERA_UP_MINUS_Z)
    return "it does not say which side is up";
  if ((done.flags & ~std::uint32_t{FLATPOSE_CAMERA_IS_SIMULATED}) != 0)
    return "it has flags that are not known";
  return fault_of_times(done, order, now_us);
}

std::string copy_points(const flatpose_camera_done_message& done, std::span<const std::byte> memory,
                        const ScanHandover::Blank& blank) {
  const std::size_t row_values = 3 * static_cast<std::size_t>(done.width_px);
  const std::size_t value_count = row_values * static_cast<std::size_t>(done.height_px);
  const std::span<float> xyz_mm = blank.xyz_mm.first(value_count);
  bool is_repeated = blank.last_xyz_mm.size() == value_count;
  for (int row = 0; row < done.height_px; ++row) {
    const std::byte* const start =
        memory.data() + static_cast<std::size_t>(row) * done.row_stride_bytes;
    const std::size_t at = row_values * static_cast<std::size_t>(row);
    const std::span<float> copied = xyz_mm.subspan(at, row_values);
    copy_row(start + done.x_offset_bytes, start + done.y_offset_bytes, start + done.z_offset_bytes,
             done.pixel_stride_bytes, copied);
    if (has_absurd(copied))
      return "row " + std::to_string(row) + " has a coordinate beyond +-1e6 mm; write mm, and " +
             "NaN where a point is missing";
    is_repeated = is_repeated && are_same_bits(copied, blank.last_xyz_mm.subspan(at, row_values));
  }
  blank.scan.view = interleaved_view(xyz_mm, done.width_px, done.height_px);
  blank.scan.is_repeated = is_repeated;
  blank.value_count = value_count;
  return {};
}

}  // namespace flatpose::daemon
