#pragma once
// A scan with the frames that it is seen in: as the sensor gave it, as a work file aligned it, or
// as a robot has it.

#include <cstdint>
#include <string>

#include "flatpose/geometry/frames.hpp"
#include "flatpose/job/command.hpp"
#include "port/linux/files/scan.hpp"

namespace flatpose::tool {

struct ScanOptions;

struct LoadedScan {
  std::string path;
  port::Scan scan;
  Frames frames;
  job::FrameName frame = job::FrameName::kScan;  ///< The face: that coordinates and poses are in.
  std::int64_t load_us = 0;

  /// "scan", "work" or "robot".
  [[nodiscard]] const char* frame_name() const noexcept {
    return job::name_of(job::frame_names(), static_cast<int>(frame));
  }
  /// Up in the frame at the face: all but a scan's have z up.
  [[nodiscard]] int up_sign() const noexcept {
    return frame != job::FrameName::kScan || scan.up == port::Up::kPlusZ ? 1 : -1;
  }
};

/// Fails: InputError for scan or work file, or when --up and the work file disagree.
[[nodiscard]] LoadedScan load_scan(const std::string& path, const ScanOptions& options);

/// Fails: NothingFound when every point is missing.
void require_points(const LoadedScan& loaded);

}  // namespace flatpose::tool
