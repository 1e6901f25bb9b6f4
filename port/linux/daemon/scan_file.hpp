#pragma once
// A scan's file brought into a buffer of the daemon's.

#include <cstddef>
#include <ctime>
#include <optional>
#include <span>
#include <string>

#include "port/linux/daemon/scan_source.hpp"

namespace flatpose::daemon {

/// Which file it was when it was read: another one under the name is another scan.
struct FileState {
  std::uint64_t device = 0;
  std::uint64_t inode = 0;
  std::int64_t bytes = 0;
  timespec changed{};

  [[nodiscard]] static FileState of(const std::string& path) noexcept;
  [[nodiscard]] bool operator==(const FileState& other) const noexcept;
};

class ScanFileReader {
 public:
  explicit ScanFileReader(const Config& config);

  /// Reads into `buffer`, and all that the file says into `scan`. Returns how many floats there
  /// are.  Memory: some of the file's size, for as long as it takes.  Fails: port::InputError,
  /// std::bad_alloc.
  std::size_t read(const std::string& path, std::span<float> buffer, HeldScan& scan) const;

 private:
  port::ReadLimits limits_;
  int width_px_max_;
  int height_px_max_;
  std::optional<port::Up> up_;
};

/// Organized x y z, one after the other.
[[nodiscard]] RangeImageView interleaved_view(std::span<const float> xyz_mm, int width_px,
                                              int height_px) noexcept;

}  // namespace flatpose::daemon
