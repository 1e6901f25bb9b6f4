#pragma once
// Guards before a command's outputs are written.

#include <span>
#include <string>

namespace flatpose::tool {

/// Fails: InputError when an output is one of the inputs or given twice, by whatever name.
void check_outputs(std::span<const std::string> inputs, std::span<const std::string> outputs);

/// The file's name without folder and extension.
[[nodiscard]] std::string stem_of(const std::string& path);
/// The file's name without folder.
[[nodiscard]] std::string name_of(const std::string& path);

}  // namespace flatpose::tool
