#pragma once
// The register map in the forms that people and their tools read. All from the one table.

#include <string>

#include "flatpose/result_map/entry.hpp"

namespace flatpose::tool {

/// "position_x", "further_3_position_x".
[[nodiscard]] std::string name_of(const result_map::Entry& entry);
[[nodiscard]] const char* name_of(result_map::Type type);

[[nodiscard]] std::string map_json();
[[nodiscard]] std::string map_markdown();
[[nodiscard]] std::string map_csv();
[[nodiscard]] std::string map_c_header();

/// The function block FB_Flatpose: CODESYS's dialect, and Siemens's.
enum class PlcDialect { kCodesys, kScl };
[[nodiscard]] std::string map_function_block(PlcDialect dialect);

}  // namespace flatpose::tool
