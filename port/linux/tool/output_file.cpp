#include "port/linux/tool/output_file.hpp"

#include <filesystem>
#include <system_error>
#include <utility>

#include "port/linux/files/atomic_file.hpp"
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

FirstOutput::FirstOutput(std::string path) : path_(std::move(path)) {
  constexpr std::int64_t kKeptBytesMax = 1'073'741'824;
  std::error_code ignored;
  was_there_ = std::filesystem::exists(path_, ignored);
  if (!was_there_) return;
  try {
    before_ = port::read_file(path_, kKeptBytesMax);
  } catch (const port::InputError&) {
    // May be written but not read: what is there now is then all there is.
  }
}

FirstOutput::~FirstOutput() {
  if (is_kept_) return;
  std::error_code ignored;
  try {
    if (!was_there_) std::filesystem::remove(path_, ignored);
    if (before_) port::write_file_atomically(path_, *before_);
  } catch (...) {  // the failure that brought us here is the one to tell of
  }
}

std::string stem_of(const std::string& path) { return std::filesystem::path(path).stem().string(); }
std::string name_of(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

}  // namespace flatpose::tool
