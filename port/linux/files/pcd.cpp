#include "port/linux/files/pcd.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <string_view>

#include "port/linux/files/atomic_file.hpp"
#include "port/linux/files/pcd_body.hpp"
#include "port/linux/files/pcd_header.hpp"
#include "port/linux/files/words.hpp"

namespace flatpose::port {
namespace {

// The sensor looks at the median point from above or from below.
void decide_up(Scan& scan, double viewpoint_z_mm) {
  std::vector<float> z_mm;
  z_mm.reserve(scan.xyz_mm.size() / 3);
  for (std::size_t i = 0; i < scan.xyz_mm.size(); i += 3) {
    const float* p = &scan.xyz_mm[i];
    if (std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2])) z_mm.push_back(p[2]);
  }
  if (z_mm.empty()) {
    scan.up_reason = "default";
    return;
  }
  const auto middle = z_mm.begin() + static_cast<std::ptrdiff_t>(z_mm.size() / 2);
  std::nth_element(z_mm.begin(), middle, z_mm.end());
  scan.up = viewpoint_z_mm > static_cast<double>(*middle) ? Up::kPlusZ : Up::kMinusZ;
  scan.up_reason = "viewpoint";
}

// The shortest text that reads back as the same number.
std::string shortest(double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof(text), value).ptr;
  return {text, end};
}

}  // namespace

bool is_pcd(std::span<const std::byte> bytes) noexcept {
  std::string_view text = as_text(bytes).substr(0, kPcdLineBytesMax);
  if (text.starts_with("# .PCD")) return true;
  while (text.starts_with('#')) (void)take_line(text);
  return text.starts_with("VERSION") || text.starts_with("FIELDS");
}

Scan read_pcd(const std::string& path, std::span<const std::byte> bytes, const ReadLimits& limits) {
  const PcdHeader header = parse_pcd_header(path, bytes, limits);
  Scan scan;
  scan.xyz_mm = read_pcd_body(path, header, bytes.subspan(header.data_offset_bytes), limits);
  scan.width_px = header.width_px;
  scan.height_px = header.height_px;
  scan.viewpoint_mm = header.viewpoint_mm;
  scan.is_simulated = header.is_simulated;
  check_coordinates(path, scan);
  decide_up(scan, header.viewpoint_mm.z);
  return scan;
}

std::vector<std::byte> pcd_bytes(const RangeImageView& scan, const Vec3& viewpoint_mm,
                                 bool is_simulated) {
  const std::string header =
      "# .PCD v0.7 - Point Cloud Data file format\n" +
      (is_simulated ? std::string(kPcdSimulatedLine) + "\n" : std::string()) +
      "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " +
      std::to_string(scan.width_px) + "\nHEIGHT " + std::to_string(scan.height_px) +
      "\nVIEWPOINT " + shortest(viewpoint_mm.x) + " " + shortest(viewpoint_mm.y) + " " +
      shortest(viewpoint_mm.z) + " 1 0 0 0\nPOINTS " + std::to_string(scan.size()) +
      "\nDATA binary\n";
  constexpr std::size_t kPointBytes = 3 * sizeof(float);
  std::vector<std::byte> bytes(header.size() + scan.size() * kPointBytes);
  std::memcpy(bytes.data(), header.data(), header.size());
  std::byte* to = bytes.data() + header.size();
  for (int row = 0; row < scan.height_px; ++row) {
    for (int column = 0; column < scan.width_px; ++column, to += kPointBytes) {
      const Vec3 p_mm = scan(column, row);
      const float xyz_mm[] = {static_cast<float>(p_mm.x), static_cast<float>(p_mm.y),
                              static_cast<float>(p_mm.z)};
      std::memcpy(to, xyz_mm, kPointBytes);
    }
  }
  return bytes;
}

void write_pcd(const std::string& path, const RangeImageView& scan, const Vec3& viewpoint_mm,
               bool is_simulated) {
  write_file_atomically(path, pcd_bytes(scan, viewpoint_mm, is_simulated));
}

}  // namespace flatpose::port
