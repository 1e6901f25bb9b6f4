#include <cmath>

#include "flatpose/core/fnv.hpp"
#include "flatpose/locate/locator.hpp"

namespace flatpose::locate {

const char* to_string(Outcome outcome) noexcept {
  switch (outcome) {
    case Outcome::kOk: return "ok";
    case Outcome::kAmbiguous: return "ambiguous";
    case Outcome::kDeadline: return "deadline";
    case Outcome::kNoMatch: return "no_match";
    case Outcome::kEmptyScene: return "empty_scene";
    case Outcome::kScanPoor: return "scan_poor";
    case Outcome::kCancelled: return "cancelled";
  }
  return "unknown";
}

std::uint64_t digest(const LocateResult& result) noexcept {
  Fnv1a64 hash;
  hash.add(static_cast<double>(static_cast<int>(result.outcome)));
  hash.add(static_cast<double>(result.match_count));
  for (const Match& match : result.found()) {
    hash.add(match.score);
    hash.add(match.visible);
    for (const double v : {match.face_T_object.position_mm.x, match.face_T_object.position_mm.y,
                           match.face_T_object.position_mm.z}) {
      hash.add(v);
    }
    for (const double m : match.face_T_object.rotation.m) hash.add(m);
    for (const Vec3& sigma : {match.sigma_mm, match.sigma_rad}) {
      for (const double v : {sigma.x, sigma.y, sigma.z}) hash.add(v);
    }
  }
  return hash.value();
}

Status validate(const LocateConfig& c) noexcept {
  const auto within = [](double value, double low, double high) {
    return value >= low && value <= high;
  };
  constexpr double kTiltMax_rad = 1.2;
  constexpr double kCellMax_mm = 1000.0;
  const bool ok = c.max_matches >= 1 && c.max_matches <= kMatchCountMax && c.min_score <= 1.0 &&
                  within(c.min_visible, 0.0, 1.0) && within(c.max_tilt_rad, 0.0, kTiltMax_rad) &&
                  within(c.cell_mm, 0.0, kCellMax_mm) && is_valid(c.region) && c.deadline_us >= 0;
  if (c.exclusions.size() > kExclusionCountMax || !(c.height_min_mm <= c.height_max_mm))
    return Status::kInvalidArgument;
  for (const Region& region : c.exclusions)
    if (region.kind == Region::Kind::kAll || !is_valid(region)) return Status::kInvalidArgument;
  return ok ? Status::kOk : Status::kInvalidArgument;
}

}  // namespace flatpose::locate
