#include "flatpose/c_api/convert.hpp"

#include <cmath>
#include <cstdint>

#include "flatpose/c_api/versioned.hpp"

namespace flatpose::c_api {
namespace {

constexpr double kDriftMax = 1e-3;

}  // namespace

Status from_c(const flatpose_pose& pose, Pose& out) noexcept {
  for (std::size_t i = 0; i < 9; ++i) out.rotation.m[i] = pose.rotation[i];
  out.position_mm = {pose.position_mm[0], pose.position_mm[1], pose.position_mm[2]};
  if (!is_valid(out.position_mm)) return Status::kNotFinite;
  const Rotation square = out.rotation * out.rotation.inverse();
  const Rotation identity;
  for (std::size_t i = 0; i < 9; ++i) {
    if (!(std::fabs(square.m[i] - identity.m[i]) <= kDriftMax)) return Status::kInvalidArgument;
  }
  // Orthogonal, but a mirror image?
  if (dot(cross(out.rotation.column(0), out.rotation.column(1)), out.rotation.column(2)) < 0.0)
    return Status::kInvalidArgument;
  out.rotation = orthonormalized(out.rotation);
  return Status::kOk;
}

Status from_c(const flatpose_scan* scan, SeenScan& out) noexcept {
  flatpose_scan given = FLATPOSE_SCAN_INIT;
  if (const Status s = read(scan, given); s != Status::kOk) return s;
  if (given.x_mm == nullptr || given.y_mm == nullptr || given.z_mm == nullptr ||
      given.width_px < 0 || given.height_px < 0 || (given.up != 1 && given.up != -1))
    return Status::kInvalidArgument;
  constexpr std::int64_t kAligned = alignof(float);
  if (given.pixel_stride_bytes % kAligned != 0 || given.row_stride_bytes % kAligned != 0)
    return Status::kInvalidArgument;
  out.view = {given.x_mm,
              given.y_mm,
              given.z_mm,
              given.width_px,
              given.height_px,
              static_cast<std::ptrdiff_t>(given.pixel_stride_bytes),
              static_cast<std::ptrdiff_t>(given.row_stride_bytes)};
  out.is_in_work = given.work_T_scan != nullptr;
  out.frames = frames_of_scan(given.up > 0);
  if (!out.is_in_work) return Status::kOk;
  Pose work_T_scan;
  const Status s = from_c(*given.work_T_scan, work_T_scan);
  out.frames = frames_of_work(work_T_scan);
  return s;
}

Status from_c(const flatpose_region& region, Region& out) noexcept {
  out = Region{};
  switch (region.kind) {
    case FLATPOSE_REGION_ALL: return Status::kOk;
    case FLATPOSE_REGION_CIRCLE: out.kind = Region::Kind::kCircle; break;
    case FLATPOSE_REGION_BOX: out.kind = Region::Kind::kBox; break;
    case FLATPOSE_REGION_POLYGON: out.kind = Region::Kind::kPolygon; break;
    default: return Status::kInvalidArgument;
  }
  out.x_mm = region.x_mm;
  out.y_mm = region.y_mm;
  out.radius_mm = region.radius_mm;
  if (out.kind != Region::Kind::kCircle) {
    if (region.vertices_xy_mm == nullptr || region.vertex_count < 2 ||
        region.vertex_count > Region::kVertexCountMax)
      return Status::kInvalidArgument;
    out.vertex_count = region.vertex_count;
    for (int i = 0; i < region.vertex_count; ++i) {
      out.vertex_x_mm[i] = region.vertices_xy_mm[2 * i];
      out.vertex_y_mm[i] = region.vertices_xy_mm[2 * i + 1];
    }
  }
  return is_valid(out) ? Status::kOk : Status::kInvalidArgument;
}

}  // namespace flatpose::c_api
