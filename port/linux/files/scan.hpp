#pragma once
// A range image on its way from disk to the library: organized x, y, z in mm, NaN where missing,
// and which side of it is up. Which kind of file it is, its content says:
//   PCD 0.7      fields x y z float32; up by VIEWPOINT against the median point (pcd.hpp)
//   PNG, 16 bit  depth image with NAME.json beside it; up is -z (depth_png.hpp)
//   JSON         height map of SICK AppSpace; up is +z (sick_json.hpp)
// Limits: ReadLimits, kDimensionMax and kCoordinateMax_mm; nothing is allocated on a header's word
// alone.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "flatpose/geometry/range_image.hpp"
#include "flatpose/geometry/vec3.hpp"

namespace flatpose::port {

inline constexpr int kDimensionMax_px = 1'000'000;  // columns or rows
inline constexpr double kCoordinateMax_mm = 1.0e6;  // a kilometre: beyond it a file is damaged
inline constexpr double kViewpointMax_mm = 1.0e9;   // a sensor may be given as far away

struct ReadLimits {
  std::int64_t max_points = 4'000'000;          ///< Columns times rows.
  std::int64_t max_file_bytes = 1'073'741'824;  ///< Of the file, and of what it unpacks to.
};

/// The side of the scan the sensor looks from.
enum class Up { kPlusZ, kMinusZ };

/// "+z" or "-z".
[[nodiscard]] const char* to_string(Up up) noexcept;
/// The side `text` ("+z", "-z") names, if any.
[[nodiscard]] std::optional<Up> parse_up(std::string_view text) noexcept;

struct Scan {
  std::vector<float> xyz_mm;  ///< x, y, z of every pixel, row by row; NaN where missing.
  int width_px = 0;
  int height_px = 0;
  Up up = Up::kMinusZ;
  std::string up_reason;      ///< "viewpoint", "depth image", "height map", "option" or "default".
  bool is_simulated = false;  ///< The file says that no sensor took it.
  std::optional<Vec3> viewpoint_mm;  ///< Where the sensor stands, when the file says it.

  /// The scan as the library takes it; valid while the scan lives and its vector is not changed.
  [[nodiscard]] RangeImageView view() const noexcept;
};

/// Reads the scan at `path`; `up_option`, when given, overrides which side is up.
/// Fails: InputError that says what, where (byte, line or pixel) and what to do.
/// Memory: a few times the file's length at most.  Thread: reentrant.
[[nodiscard]] Scan read_scan(const std::string& path, const ReadLimits& limits = {},
                             std::optional<Up> up_option = {});

/// Takes `up` because the user said so.
void override_up(Scan& scan, Up up);

// What the readers of the formats share.

/// The float nearest to `value_mm`; infinite beyond the floats, for check_coordinates to find.
[[nodiscard]] float to_coordinate(double value_mm) noexcept;

/// Fails: InputError when the size is no range image's or more than the limits allow.
/// `how_to_organize` is the remedy for a single row or column.
void check_shape(const std::string& path, std::uint64_t width_px, std::uint64_t height_px,
                 const ReadLimits& limits, std::string_view how_to_organize);
/// Fails: InputError naming the first pixel with an infinite or absurdly large coordinate.
void check_coordinates(const std::string& path, const Scan& scan);

}  // namespace flatpose::port
