#include <array>

#include "flatpose/c_api/convert.hpp"
#include "flatpose/c_api/handles.hpp"
#include "flatpose/c_api/versioned.hpp"

using namespace flatpose;
using namespace flatpose::c_api;

namespace {

teach::PlanePoint point_of(std::int32_t is_given, const double* xy) noexcept {
  return {is_given != 0, xy[0], xy[1]};
}

Status read_config(const flatpose_teach_config* given, const SeenScan& first,
                   teach::TeachConfig& config) noexcept {
  flatpose_teach_config in = FLATPOSE_TEACH_CONFIG_INIT;
  if (given != nullptr) {
    if (const Status s = read(given, in); s != Status::kOk) return s;
  }
  if (in.name != nullptr) {
    std::size_t length = 0;
    for (; in.name[length] != '\0'; ++length) {
      if (length + 1 == config.name.size()) return Status::kInvalidArgument;
      config.name[length] = in.name[length];
    }
  }
  config.symmetry_order = in.symmetry_order;
  config.origin = point_of(in.has_origin, in.origin_xy_mm);
  config.x_axis = point_of(in.has_x_axis, in.x_axis_xy);
  config.symmetry_center = point_of(in.has_symmetry_center, in.symmetry_center_xy_mm);
  config.frame = first.is_in_work ? model::Frame::kWork : model::Frame::kScan;
  config.up = first.frames.work_T_scan.rotation.m[8] < 0.0 ? std::int8_t{-1} : std::int8_t{1};
  return from_c(in.region, config.region);
}

}  // namespace

flatpose_status flatpose_teach(flatpose_finder* finder, const flatpose_scan* const* scans,
                               int32_t scan_count, const flatpose_teach_config* config,
                               void* part_memory, size_t part_memory_bytes, flatpose_part** part) {
  if (part == nullptr) return to_c(Status::kInvalidArgument);
  *part = nullptr;
  if (finder == nullptr || !finder->can_teach || scans == nullptr || part_memory == nullptr ||
      scan_count < 1 || scan_count > FLATPOSE_TEACH_SCAN_COUNT_MAX)
    return to_c(Status::kInvalidArgument);
  if (part_memory_bytes < kHandleBytes<flatpose_part>) return to_c(Status::kOutOfMemory);

  std::array<teach::TeachScan, FLATPOSE_TEACH_SCAN_COUNT_MAX> lesson;
  SeenScan first;
  for (int i = 0; i < scan_count; ++i) {
    SeenScan seen;
    if (const Status s = from_c(scans[i], seen); s != Status::kOk) return to_c(s);
    lesson[static_cast<std::size_t>(i)] = {seen.view, seen.frames};
    if (i == 0) first = seen;
  }
  teach::TeachConfig wanted;
  if (const Status s = read_config(config, first, wanted); s != Status::kOk) return to_c(s);
  auto* const made = make_handle<flatpose_part>(part_memory);
  teach::TeachReport report;
  const Status s = finder->teacher.teach(
      std::span(lesson).first(static_cast<std::size_t>(scan_count)), wanted, made->part, report);
  if (s == Status::kOk) *part = made;
  return to_c(s);
}
