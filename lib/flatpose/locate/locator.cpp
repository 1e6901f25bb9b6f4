#include "flatpose/locate/locator.hpp"

#include "flatpose/locate/pipeline.hpp"
#include "flatpose/locate/workspace.hpp"
#include "flatpose/model/template_file.hpp"

namespace flatpose::locate {
namespace {

bool is_valid(const Limits& limits) noexcept {
  constexpr int kSideMax_px = 1 << 15;
  constexpr int kCellCountMax = kMapSideMax_px * kMapSideMax_px;
  return limits.scan_width_px >= 2 && limits.scan_width_px <= kSideMax_px &&
         limits.scan_height_px >= 2 && limits.scan_height_px <= kSideMax_px &&
         limits.cell_count >= 1 && limits.cell_count <= kCellCountMax;
}

}  // namespace

std::size_t Locator::required_bytes(const Limits& limits) noexcept {
  return is_valid(limits) ? workspace_required_bytes(limits) : 0;
}

Status Locator::init(const Limits& limits, std::span<std::byte> memory) noexcept {
  if (!is_valid(limits)) return Status::kInvalidArgument;
  if (memory.size() < required_bytes(limits)) return Status::kOutOfMemory;
  limits_ = limits;
  arena_ = Arena(memory);
  return Status::kOk;
}

Status Locator::locate(const model::Template& part, const RangeImageView& scan,
                       const Frames& frames, const LocateConfig& config, const Host& host,
                       LocateResult& result) noexcept {
  result = LocateResult{};
  if (const Status s = validate(config); s != Status::kOk) return s;
  if (!model::is_valid(part)) return Status::kInvalidArgument;
  if (scan.width_px > limits_.scan_width_px || scan.height_px > limits_.scan_height_px)
    return Status::kTooLarge;
  const ArenaScope scope(arena_);
  return run_pipeline(part, scan, frames, config, limits_, host, arena_, result);
}

}  // namespace flatpose::locate
