#pragma once
// A scan with the frames that it is seen in: as the sensor gave it, or as a work file aligned it.

#include <cstdint>
#include <string>

#include "flatpose/geometry/frames.hpp"
#include "flatpose/model/template.hpp"
#include "port/linux/files/scan.hpp"

namespace flatpose::tool {

struct ScanOptions;

struct LoadedScan {
  std::string path;
  port::Scan scan;
  Frames frames;
  model::Frame frame = model::Frame::kScan;  ///< That coordinates and poses are in.
  std::int64_t load_us = 0;

  /// "scan" or "work".
  [[nodiscard]] const char* frame_name() const noexcept {
    return frame == model::Frame::kWork ? "work" : "scan";
  }
  /// Up in the frame at the face: a work frame has z up always.
  [[nodiscard]] int up_sign() const noexcept {
    return frame == model::Frame::kWork || scan.up == port::Up::kPlusZ ? 1 : -1;
  }
};

/// Fails: InputError for scan or work file, or when --up and the work file disagree.
[[nodiscard]] LoadedScan load_scan(const std::string& path, const ScanOptions& options);

/// Fails: NothingFound when every point is missing.
void require_points(const LoadedScan& loaded);

}  // namespace flatpose::tool
