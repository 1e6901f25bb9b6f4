#include "port/linux/tool/output_file.hpp"

#include <filesystem>
#include <system_error>

#include "port/linux/files/input_error.hpp"

namespace flatpose::tool {
namespace {

bool is_same_file(const std::string& a, const std::string& b) {
  std::error_code ignored;
  return a == b || std::filesystem::equivalent(a, b, ignored);
}

}  // namespace

void check_outputs(std::span<const std::string> inputs, std::span<const std::string> outputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (outputs[i].empty()) continue;
    for (const std::string& input : inputs) {
      if (is_same_file(outputs[i], input))
        throw port::InputError(outputs[i], "it is read and would be written over",
                               "name another output");
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (is_same_file(outputs[i], outputs[j]))
        throw port::InputError(outputs[i], "it is named for two outputs", "name another");
    }
  }
}

std::string stem_of(const std::string& path) { return std::filesystem::path(path).stem().string(); }
std::string name_of(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

}  // namespace flatpose::tool
