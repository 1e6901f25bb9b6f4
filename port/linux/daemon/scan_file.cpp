#include "port/linux/daemon/scan_file.hpp"

#include <sys/stat.h>

#include <algorithm>

#include "port/linux/clock/steady_clock.hpp"
#include "port/linux/files/input_error.hpp"

namespace flatpose::daemon {

FileState FileState::of(const std::string& path) noexcept {
  struct stat found {};
  if (::stat(path.c_str(), &found) != 0) return {};
  return {found.st_dev, found.st_ino, found.st_size, found.st_mtim};
}

bool FileState::operator==(const FileState& other) const noexcept {
  return device == other.device && inode == other.inode && bytes == other.bytes &&
         changed.tv_sec == other.changed.tv_sec && changed.tv_nsec == other.changed.tv_nsec;
}

ScanFileReader::ScanFileReader(const Config& config)
    : limits_{static_cast<std::int64_t>(config.search.limits.scan_width_px) *
                  config.search.limits.scan_height_px,
              config.search.max_scan_bytes},
      width_px_max_(config.search.limits.scan_width_px),
      height_px_max_(config.search.limits.scan_height_px),
      up_(config.source.up) {}

std::size_t ScanFileReader::read(const std::string& path, std::span<float> buffer,
                                 HeldScan& scan) const {
  const port::SteadyClock clock;
  const std::int64_t start_us = clock.now_us();
  const port::Scan read = port::read_scan(path, limits_, up_);
  if (read.width_px > width_px_max_ || read.height_px > height_px_max_)
    throw port::InputError(path,
                           std::to_string(read.width_px) + " x " + std::to_string(read.height_px) +
                               " pixels are more than [search] has memory for",
                           "raise scan_width_px and scan_height_px");
  std::copy(read.xyz_mm.begin(), read.xyz_mm.end(), buffer.begin());
  scan.view = interleaved_view(buffer, read.width_px, read.height_px);
  scan.up = read.up;
  scan.up_reason = read.up_reason;
  scan.is_simulated = read.is_simulated;
  scan.load_us = clock.now_us() - start_us;
  return read.xyz_mm.size();
}

RangeImageView interleaved_view(std::span<const float> xyz_mm, int width_px,
                                int height_px) noexcept {
  constexpr std::ptrdiff_t kPixelBytes = 3 * sizeof(float);
  const float* const first = xyz_mm.data();
  return {first, first + 1, first + 2, width_px, height_px, kPixelBytes, kPixelBytes * width_px};
}

}  // namespace flatpose::daemon
