#pragma once
// Point clouds in PCL's format PCD 0.7, organized ones only: WIDTH x HEIGHT is the sensor's grid.
// Read are the fields x, y, z (F 4, one value each); others of any type, size and count are
// skipped. DATA is ascii, binary (points one after the other) or binary_compressed (all x, then all
// y, ..., packed by LZF). NaN is a missing point, infinity an error. VIEWPOINT's position says
// which side is up; its rotation is not applied, as PCL does not apply it either. The comment
// kPcdSimulatedLine says that no sensor took the scan. Limits: the lines
// of the header (pcd_header.hpp) and ReadLimits.

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "flatpose/geometry/range_image.hpp"
#include "port/linux/files/scan.hpp"

namespace flatpose::port {

/// Whether the file starts like a PCD.
[[nodiscard]] bool is_pcd(std::span<const std::byte> bytes) noexcept;

/// The scan in the bytes of a PCD file; `path` is for messages.
/// Cost: linear in the bytes.  Fails: InputError.
[[nodiscard]] Scan read_pcd(const std::string& path, std::span<const std::byte> bytes,
                            const ReadLimits& limits = {});

/// The bytes of a binary PCD of x, y, z; one that is simulated says so in a comment.
[[nodiscard]] std::vector<std::byte> pcd_bytes(const RangeImageView& scan, const Vec3& viewpoint_mm,
                                               bool is_simulated = false);
/// Writes a binary PCD of x, y, z.  Fails: InputError; nothing is left then.
void write_pcd(const std::string& path, const RangeImageView& scan, const Vec3& viewpoint_mm,
               bool is_simulated = false);

}  // namespace flatpose::port
