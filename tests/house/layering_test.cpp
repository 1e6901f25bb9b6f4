// Reads the tree and holds it against the house that ARCHITECTURE.md draws.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

// From the ground up: a room may include what stands before it.
const std::vector<std::string> kRooms{"core",  "geometry", "autodiff", "rectify", "image", "scene",
                                      "model", "search",   "refine",   "locate",  "teach"};

struct Include {
  fs::path file;     // relative to the tree
  std::string what;  // as written, without brackets or quotes
};

std::vector<Include> includes_under(const std::string& folder) {
  const std::regex line_form(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  const fs::path root = FLATPOSE_SOURCE_DIR;
  std::vector<Include> found;
  for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
    const std::string extension = entry.path().extension();
    if (extension != ".hpp" && extension != ".cpp" && extension != ".h") continue;
    std::ifstream file(entry.path());
    for (std::string line; std::getline(file, line);) {
      std::smatch match;
      if (std::regex_search(line, match, line_form)) {
        found.push_back({fs::relative(entry.path(), root), match[1]});
      }
    }
  }
  return found;
}

bool starts_with(const std::string& text, const std::string& start) {
  return text.rfind(start, 0) == 0;
}

std::ptrdiff_t rank_of(const std::string& room) {
  return std::find(kRooms.begin(), kRooms.end(), room) - kRooms.begin();
}

TEST(Layering, RoomsOfLibIncludeOnlyWhatStandsBelow) {
  const auto top = static_cast<std::ptrdiff_t>(kRooms.size());
  const auto includes = includes_under("lib/flatpose");
  ASSERT_GT(includes.size(), 100U);
  for (const Include& include : includes) {
    if (!starts_with(include.what, "flatpose/")) continue;
    const std::string from = *std::next(include.file.begin(), 2);
    const std::string to = *std::next(fs::path(include.what).begin(), 1);
    EXPECT_LT(rank_of(from), top) << include.file << " is in a room that the drawing lacks";
    EXPECT_LE(rank_of(to), rank_of(from)) << include.file << " includes " << include.what;
  }
}

TEST(Layering, LibKnowsNoSystemNoHeapAndNoOtherLibraryButEigenInRefine) {
  const std::vector<std::string> allowed{
      "algorithm", "array",   "bit",     "cassert",  "cmath",       "compare",
      "cstddef",   "cstdint", "cstdlib", "cstring",  "limits",      "numbers",
      "span",      "tuple",   "utility", "optional", "type_traits", "initializer_list"};
  for (const Include& include : includes_under("lib/flatpose")) {
    if (starts_with(include.what, "flatpose/")) continue;
    const bool is_eigen = starts_with(include.what, "Eigen/");
    if (is_eigen) {
      EXPECT_TRUE(starts_with(include.file.string(), "lib/flatpose/refine/")) << include.file;
      continue;
    }
    EXPECT_NE(std::find(allowed.begin(), allowed.end(), include.what), allowed.end())
        << include.file << " includes <" << include.what << ">";
  }
}

TEST(Layering, OnlyPortLinuxKnowsTheSystem) {
  const std::regex system_form(
      R"(^(sys/.*|linux/.*|unistd\.h|fcntl\.h|pthread\.h|sched\.h|modbus.*|net/.*|time\.h)$)");
  for (const std::string folder : {"lib/flatpose", "port/sim"}) {
    for (const Include& include : includes_under(folder)) {
      EXPECT_FALSE(std::regex_match(include.what, system_form))
          << include.file << " includes " << include.what;
      EXPECT_FALSE(starts_with(include.what, "port/linux/"))
          << include.file << " includes " << include.what;
      if (folder == "lib/flatpose") {
        EXPECT_FALSE(starts_with(include.what, "port/"))
            << include.file << " includes " << include.what;
      }
    }
  }
}

}  // namespace
