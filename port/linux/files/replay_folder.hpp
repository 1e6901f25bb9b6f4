#pragma once
// Which file a replay shows next: the one file, or a folder's scans by name, round and round.

#include <string>
#include <vector>

namespace flatpose::port {

class ReplayFolder {
 public:
  /// A file or a folder.
  explicit ReplayFolder(std::string path) : path_(std::move(path)) {}

  /// The next one; empty when there is none. A folder is read each time, so files may come and go.
  [[nodiscard]] std::string next();
  /// Whether there is a file to show.
  [[nodiscard]] bool has_any() const;

 private:
  std::string path_;
  std::string last_name_;
};

/// The scans in a folder, by name: *.pcd, *.png with a NAME.json beside it, and *.json that belongs
/// to neither.
[[nodiscard]] std::vector<std::string> scan_names_in(const std::string& folder);

}  // namespace flatpose::port
