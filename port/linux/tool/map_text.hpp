#pragma once
// The register map in the forms that people and their tools read. All from the one table.

#include <string>

#include "flatpose/result_map/entry.hpp"
#include "port/linux/tool/served_map.hpp"

namespace flatpose::tool {

/// "position_x", "further_3_position_x".
[[nodiscard]] std::string name_of(const result_map::Entry& entry);
[[nodiscard]] const char* name_of(result_map::Type type);

[[nodiscard]] std::string map_json(const ServedMap& served = {});
[[nodiscard]] std::string map_markdown(const ServedMap& served = {});
[[nodiscard]] std::string map_csv(const ServedMap& served = {});
[[nodiscard]] std::string map_c_header(const ServedMap& served = {});

/// The function block FB_Flatpose: CODESYS's dialect, and Siemens's.
/// Fails: port::InputError for a word order that it does not read.
enum class PlcDialect { kCodesys, kScl };
[[nodiscard]] std::string map_function_block(PlcDialect dialect, const ServedMap& served = {});

}  // namespace flatpose::tool
