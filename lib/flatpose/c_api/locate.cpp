#include <cmath>
#include <span>

#include "flatpose/c_api/convert.hpp"
#include "flatpose/c_api/handles.hpp"
#include "flatpose/c_api/host_of.hpp"
#include "flatpose/c_api/versioned.hpp"
#include "flatpose/core/maths.hpp"
#include "flatpose/locate/sigma.hpp"
#include "flatpose/model/equivalents.hpp"

using namespace flatpose;
using namespace flatpose::c_api;

namespace {

static_assert(FLATPOSE_MATCH_COUNT_MAX == locate::kMatchCountMax);
static_assert(FLATPOSE_EXCLUSION_COUNT_MAX == locate::kExclusionCountMax);
static_assert(FLATPOSE_VERTEX_COUNT_MAX == Region::kVertexCountMax);

// Into `room`, which is too large for the stack.
Status read_exclusions(const flatpose_config& in, std::span<Region> room,
                       locate::LocateConfig& config) noexcept {
  if (in.exclusion_count == 0) return Status::kOk;
  if (in.exclusion_count < 0 || in.exclusion_count > FLATPOSE_EXCLUSION_COUNT_MAX ||
      in.exclusions == nullptr)
    return Status::kInvalidArgument;
  const std::span<Region> used = room.first(static_cast<std::size_t>(in.exclusion_count));
  for (std::size_t i = 0; i < used.size(); ++i)
    if (const Status s = from_c(in.exclusions[i], used[i]); s != Status::kOk) return s;
  config.exclusions = used;
  return Status::kOk;
}

Status read_config(const flatpose_config* given, std::span<Region> exclusions,
                   locate::LocateConfig& config) noexcept {
  flatpose_config in = FLATPOSE_CONFIG_INIT;
  if (given != nullptr) {
    if (const Status s = read(given, in); s != Status::kOk) return s;
  }
  switch (in.order) {
    case FLATPOSE_ORDER_SCORE: config.order = locate::Order::kScore; break;
    case FLATPOSE_ORDER_HEIGHT: config.order = locate::Order::kHeight; break;
    case FLATPOSE_ORDER_VISIBLE: config.order = locate::Order::kVisible; break;
    default: return Status::kInvalidArgument;
  }
  config.max_matches = in.max_matches;
  config.min_score = in.min_score;
  config.min_visible = in.min_visible;
  // A NaN is no default: it is passed on, and refused.
  if (!(in.max_tilt_deg < 0.0)) config.max_tilt_rad = in.max_tilt_deg * kRadPerDeg;
  config.cell_mm = in.cell_mm;
  config.deadline_us = in.deadline_us;
  if (in.has_heights != 0) {
    config.height_min_mm = in.height_min_mm;
    config.height_max_mm = in.height_max_mm;
  }
  if (const Status s = read_exclusions(in, exclusions, config); s != Status::kOk) return s;
  return from_c(in.region, config.region);
}

flatpose_result to_c(const locate::LocateResult& from) noexcept {
  flatpose_result out = FLATPOSE_RESULT_INIT;
  out.outcome = static_cast<std::int32_t>(from.outcome);
  out.match_count = from.match_count;
  out.is_exact = from.is_exact ? 1 : 0;
  out.bound_gap = from.bound_gap;
  out.hypothesis_count = from.hypothesis_count;
  out.evaluated_count = from.evaluated_count;
  out.rectify_us = from.timings.rectify_us;
  out.features_us = from.timings.features_us;
  out.search_us = from.timings.search_us;
  out.refine_us = from.timings.refine_us;
  out.verify_us = from.timings.verify_us;
  out.total_us = from.timings.total_us;
  out.peak_bytes = from.peak_bytes;
  out.digest = locate::digest(from);
  out.rival_score = from.rival_score;
  out.best_rejected_score = from.best_rejected_score;
  return out;
}

// Null: the last search found no such.
const locate::Match* match_of(const flatpose_finder* finder, std::int32_t index) noexcept {
  if (finder == nullptr || index < 0 || index >= finder->result.match_count) return nullptr;
  return &finder->result.matches[static_cast<std::size_t>(index)];
}

// The match as it is told at `face_T_told`.
flatpose_match to_c(const locate::Match& from, const Pose& face_T_told,
                    const locate::Sigma& sigma) noexcept {
  flatpose_match out = FLATPOSE_MATCH_INIT;
  out.score = from.score;
  out.visible = from.visible;
  out.pose = c_api::to_c(face_T_told);
  const double sigma_mm[] = {sigma.mm.x, sigma.mm.y, sigma.mm.z};
  const double sigma_rad[] = {sigma.rad.x, sigma.rad.y, sigma.rad.z};
  for (std::size_t i = 0; i < 3; ++i) {
    out.sigma_mm[i] = sigma_mm[i];
    out.sigma_deg[i] = sigma_rad[i] * kDegPerRad;
  }
  out.turn_is_free = from.turn_is_free ? 1 : 0;
  out.edge_rms_mm = from.edge_rms_mm;
  out.surface_rms_mm = from.surface_rms_mm;
  return out;
}

}  // namespace

flatpose_status flatpose_locate(flatpose_finder* finder, const flatpose_part* part,
                                const flatpose_scan* scan, const flatpose_config* config,
                                const flatpose_host* host, flatpose_result* result) {
  if (finder == nullptr) return c_api::to_c(Status::kInvalidArgument);
  finder->result = {};  // nothing of the last search, whatever comes
  if (part == nullptr) return c_api::to_c(Status::kInvalidArgument);
  // Also tells that there is room for a result before any work is done.
  if (const Status s = write(to_c(finder->result), result); s != Status::kOk) return c_api::to_c(s);
  SeenScan seen;
  if (const Status s = from_c(scan, seen); s != Status::kOk) return c_api::to_c(s);
  locate::LocateConfig wanted;
  if (const Status s = read_config(config, finder->exclusions, wanted); s != Status::kOk)
    return c_api::to_c(s);
  flatpose_host callbacks = FLATPOSE_HOST_INIT;
  if (host != nullptr) {
    if (const Status s = read(host, callbacks); s != Status::kOk) return c_api::to_c(s);
  }
  HostOf host_of(callbacks);
  finder->symmetry = part->part.symmetry;
  Status s = finder->locator.locate(part->part, seen.view, seen.frames, wanted, host_of.host(),
                                    finder->result);
  if (s == Status::kOk) s = write(to_c(finder->result), result);
  return c_api::to_c(s);
}

flatpose_status flatpose_match_at(const flatpose_finder* finder, int32_t index,
                                  flatpose_match* match) {
  const locate::Match* const from = match_of(finder, index);
  if (from == nullptr) return c_api::to_c(Status::kInvalidArgument);
  return c_api::to_c(
      write(to_c(*from, from->face_T_object, {from->sigma_mm, from->sigma_rad}), match));
}

flatpose_status flatpose_pick_at(const flatpose_finder* finder, int32_t index,
                                 const flatpose_pick* pick, flatpose_match* match) {
  const locate::Match* const from = match_of(finder, index);
  if (from == nullptr) return c_api::to_c(Status::kInvalidArgument);
  flatpose_pick in = FLATPOSE_PICK_INIT;
  if (const Status s = read(pick, in); s != Status::kOk) return c_api::to_c(s);
  Pose object_T_pick;
  if (const Status s = from_c(in.object_T_pick, object_T_pick); s != Status::kOk)
    return c_api::to_c(s);
  if (in.has_preferred_angle != 0) {
    constexpr double kTurnMax_deg = 360.0;
    if (!(std::fabs(in.preferred_angle_deg) <= kTurnMax_deg))
      return c_api::to_c(Status::kInvalidArgument);
    object_T_pick = model::told_at_angle(from->face_T_object.rotation, finder->symmetry,
                                         object_T_pick, in.preferred_angle_deg * kRadPerDeg);
  }
  return c_api::to_c(write(
      to_c(*from, from->face_T_object * object_T_pick, locate::sigma_of(*from, object_T_pick)),
      match));
}
