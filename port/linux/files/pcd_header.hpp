#pragma once
// The lines above a PCD's data. They are only understood and held against each other here; whether
// the data keeps their promises is for pcd_body.hpp to see.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "flatpose/geometry/vec3.hpp"
#include "port/linux/files/scan.hpp"

namespace flatpose::port {

/// A comment by which a PCD says that no sensor took it.
inline constexpr std::string_view kPcdSimulatedLine = "# flatpose: simulated";

inline constexpr std::size_t kPcdLineBytesMax = 4096;
inline constexpr std::size_t kPcdLinesMax = 200;
inline constexpr std::size_t kPcdFieldsMax = 256;
inline constexpr std::uint64_t kPcdFieldCountMax = 65'536;     // values of one field
inline constexpr std::uint64_t kPcdPointBytesMax = 1'048'576;  // so that no product overflows

enum class PcdData { kAscii, kBinary, kBinaryCompressed };

struct PcdHeader {
  int width_px = 0;
  int height_px = 0;
  Vec3 viewpoint_mm;  // where the sensor stands
  bool is_simulated = false;
  PcdData data = PcdData::kAscii;
  std::size_t data_offset_bytes = 0;  // where the lines end
  std::size_t line_count = 0;
  std::uint64_t point_bytes = 0;   // of all fields of a point
  std::uint64_t point_values = 0;  // numbers of a point
  // Of x, y and z: where they stand in a point, as bytes and as numbers.
  std::array<std::uint64_t, 3> offset_bytes{};
  std::array<std::uint64_t, 3> value_index{};

  [[nodiscard]] std::uint64_t point_count() const noexcept {
    return static_cast<std::uint64_t>(width_px) * static_cast<std::uint64_t>(height_px);
  }
};

/// Fails: InputError naming the line.
[[nodiscard]] PcdHeader parse_pcd_header(const std::string& path, std::span<const std::byte> bytes,
                                         const ReadLimits& limits);

}  // namespace flatpose::port
