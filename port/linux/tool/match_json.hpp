#pragma once
// What a search found, as JSON. It pulls nlohmann-json in: for .cpp files.

#include <cstddef>

#include "flatpose/locate/locator.hpp"
#include "port/linux/tool/loaded_scan.hpp"
#include "port/linux/tool/pose_json.hpp"

namespace flatpose::tool {

[[nodiscard]] Json json_of(const locate::Match& match);
/// The object that `flatpose locate --json` prints.
[[nodiscard]] Json json_of(const model::Template& part, const LoadedScan& loaded,
                           const locate::LocateResult& result, std::size_t arena_bytes);

}  // namespace flatpose::tool
