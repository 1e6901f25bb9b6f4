#pragma once
// Memory for the library, sized by the scans at hand.

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "flatpose/locate/locator.hpp"
#include "port/linux/files/scan.hpp"

namespace flatpose::tool {

/// Bytes that nobody has written to: pages the library does not touch cost nothing.
class Memory {
 public:
  explicit Memory(std::size_t size_bytes)
      : bytes_(std::make_unique_for_overwrite<std::byte[]>(size_bytes)), size_bytes_(size_bytes) {}
  [[nodiscard]] std::span<std::byte> span() noexcept { return {bytes_.get(), size_bytes_}; }
  [[nodiscard]] std::size_t size_bytes() const noexcept { return size_bytes_; }

 private:
  std::unique_ptr<std::byte[]> bytes_;
  std::size_t size_bytes_;
};

/// What suffices for a scan of this size at any sensible resolution.
[[nodiscard]] locate::Limits limits_for(const port::Scan& scan) noexcept;
/// What suffices for both.
[[nodiscard]] locate::Limits larger(const locate::Limits& a, const locate::Limits& b) noexcept;

/// Fails: InputError when rows or columns are more than the library takes.
void check_sides(const std::string& path, const port::Scan& scan);

}  // namespace flatpose::tool
