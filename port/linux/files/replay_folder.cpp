#include "port/linux/files/replay_folder.hpp"

#include <algorithm>
#include <filesystem>

namespace flatpose::port {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kNamesMax = 100'000;

bool has_beside(fs::path path, const char* extension) {
  std::error_code ignored;
  return fs::is_regular_file(path.replace_extension(extension), ignored);
}

bool is_scan(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) return false;
  const fs::path extension = path.extension();
  if (extension == ".png") return has_beside(path, ".json");
  if (extension == ".json") return !has_beside(path, ".png") && !has_beside(path, ".pcd");
  return extension == ".pcd";
}

}  // namespace

std::vector<std::string> scan_names_in(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code error;
  fs::directory_iterator entry(folder, error);
  const fs::directory_iterator end;
  while (!error && entry != end && names.size() < kNamesMax) {
    if (is_scan(entry->path())) names.push_back(entry->path().filename().string());
    entry.increment(error);
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string ReplayFolder::next() {
  std::error_code error;
  if (!fs::is_directory(path_, error)) return has_any() ? path_ : std::string();
  const std::vector<std::string> names = scan_names_in(path_);
  if (names.empty()) return {};
  const auto after = std::upper_bound(names.begin(), names.end(), last_name_);
  last_name_ = after == names.end() ? names.front() : *after;
  return (fs::path(path_) / last_name_).string();
}

bool ReplayFolder::has_any() const {
  std::error_code error;
  if (fs::is_directory(path_, error)) return !scan_names_in(path_).empty();
  return fs::is_regular_file(path_, error);
}

}  // namespace flatpose::port
