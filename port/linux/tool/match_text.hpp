#pragma once
// Results of a search as JSON and as a table for people.

#include <cstddef>
#include <string>

#include "flatpose/locate/locator.hpp"
#include "flatpose/model/template.hpp"
#include "port/linux/tool/loaded_scan.hpp"

namespace flatpose::tool {

/// How far a pose leans off the work plane, and its turn about up; both for people.
struct Lean {
  double tilt_deg = 0.0;
  double turn_deg = 0.0;
};
[[nodiscard]] Lean lean_of(const Frames& frames, const Pose& face_T_object) noexcept;

[[nodiscard]] std::string match_json(const model::Template& part, const LoadedScan& loaded,
                                     const locate::LocateResult& result, std::size_t arena_bytes);
[[nodiscard]] std::string match_table(const model::Template& part, const LoadedScan& loaded,
                                      const locate::LocateResult& result);

}  // namespace flatpose::tool
