#pragma once
// Guards before a command's outputs are written.

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace flatpose::tool {

/// Fails: InputError when an output is one of the inputs or given twice, by whatever name.
void check_outputs(std::span<const std::string> inputs, std::span<const std::string> outputs);

/// Of two outputs that belong together, the one that is written first. Unless keep() is reached,
/// its path is as it was before: without a file, or with the old one.
class FirstOutput {
 public:
  explicit FirstOutput(std::string path);
  ~FirstOutput();
  FirstOutput(const FirstOutput&) = delete;
  FirstOutput& operator=(const FirstOutput&) = delete;

  void keep() noexcept { is_kept_ = true; }

 private:
  std::string path_;
  bool was_there_ = false;
  std::optional<std::vector<std::byte>> before_;  ///< Nothing when it could not be read.
  bool is_kept_ = false;
};

/// The file's name without folder and extension.
[[nodiscard]] std::string stem_of(const std::string& path);
/// The file's name without folder.
[[nodiscard]] std::string name_of(const std::string& path);

}  // namespace flatpose::tool
