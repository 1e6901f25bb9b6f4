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
const std::vector<std::string> kRooms{"core",  "geometry",   "autodiff", "rectify", "image",
                                      "scene", "model",      "search",   "refine",  "locate",
                                      "teach", "flatpose.h", "c_api"};

// What a PLC sees, without a socket: above all of lib, below port.
const std::vector<std::string> kBusRooms{"job", "result_map", "modbus", "can"};

// The same for port/linux: what asks the system for one thing, then what needs all of it.
const std::vector<std::string> kLinuxRooms{"clock",    "cpu",     "files",  "camera",
                                           "realtime", "threads", "modbus", "can",
                                           "tool",     "records", "daemon", "programs"};

struct Include {
  fs::path file;     // relative to the tree
  std::string what;  // as written, without brackets or quotes
};

/// Calls with the file, relative to the tree, and each of its lines.
template <class Visit>
void over_lines(const std::string& folder, const Visit& visit) {
  const std::vector<std::string> extensions{".hpp", ".cpp", ".h", ".inc"};
  const fs::path root = FLATPOSE_SOURCE_DIR;
  for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
    const std::string extension = entry.path().extension();
    if (std::find(extensions.begin(), extensions.end(), extension) == extensions.end()) continue;
    std::ifstream file(entry.path());
    for (std::string line; std::getline(file, line);) visit(fs::relative(entry.path(), root), line);
  }
}

std::vector<Include> includes_under(const std::string& folder) {
  const std::regex line_form(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  std::vector<Include> found;
  over_lines(folder, [&](const fs::path& file, const std::string& line) {
    std::smatch match;
    if (std::regex_search(line, match, line_form)) found.push_back({file, match[1]});
  });
  return found;
}

bool starts_with(const std::string& text, const std::string& start) {
  return text.rfind(start, 0) == 0;
}

std::ptrdiff_t rank_of(const std::string& room, const std::vector<std::string>& rooms = kRooms) {
  return std::find(rooms.begin(), rooms.end(), room) - rooms.begin();
}

std::string step_of(const fs::path& path, int index) { return *std::next(path.begin(), index); }

TEST(Layering, RoomsOfLibIncludeOnlyWhatStandsBelow) {
  const auto top = static_cast<std::ptrdiff_t>(kRooms.size());
  const auto includes = includes_under("lib/flatpose");
  ASSERT_GT(includes.size(), 100U);
  for (const Include& include : includes) {
    if (!starts_with(include.what, "flatpose/")) continue;
    const std::string from = step_of(include.file, 2);
    const std::string to = step_of(include.what, 1);
    EXPECT_LT(rank_of(from), top) << include.file << " is in a room that the drawing lacks";
    EXPECT_LE(rank_of(to), rank_of(from)) << include.file << " includes " << include.what;
  }
}

// Of the standard library, what needs neither a heap nor a system.
const std::vector<std::string> kFreestanding{
    "algorithm",        "array",   "atomic",   "bit",     "cassert",  "cmath",
    "compare",          "cstddef", "cstdint",  "cstdlib", "cstring",  "limits",
    "numbers",          "span",    "tuple",    "utility", "optional", "type_traits",
    "initializer_list", "new",     "stddef.h", "stdint.h"};

bool is_freestanding(const std::string& header) {
  return std::find(kFreestanding.begin(), kFreestanding.end(), header) != kFreestanding.end();
}

TEST(Layering, FieldbusKnowsNoSystemNoHeapAndNoOtherLibrary) {
  for (const Include& include : includes_under("fieldbus/flatpose")) {
    EXPECT_TRUE(starts_with(include.what, "flatpose/") || is_freestanding(include.what))
        << include.file << " includes <" << include.what << ">";
  }
}

TEST(Layering, LibKnowsNoSystemNoHeapAndNoOtherLibraryButEigenInRefine) {
  for (const Include& include : includes_under("lib/flatpose")) {
    if (starts_with(include.what, "flatpose/")) continue;
    const bool is_eigen = starts_with(include.what, "Eigen/");
    if (is_eigen) {
      EXPECT_TRUE(starts_with(include.file.string(), "lib/flatpose/refine/")) << include.file;
      continue;
    }
    // The processor's own instructions, where the compiler's vectors have no word for them.
    const bool is_vector_text =
        include.file.extension() == ".inc" || include.file == "lib/flatpose/rectify/lanes.hpp";
    if (is_vector_text && (include.what == "immintrin.h" || include.what == "arm_neon.h")) continue;
    EXPECT_TRUE(is_freestanding(include.what))
        << include.file << " includes <" << include.what << ">";
  }
}

TEST(Layering, RoomsOfFieldbusIncludeLibAndWhatStandsBelow) {
  const auto top = static_cast<std::ptrdiff_t>(kBusRooms.size());
  const auto lib_top = static_cast<std::ptrdiff_t>(kRooms.size());
  const auto includes = includes_under("fieldbus/flatpose");
  ASSERT_GT(includes.size(), 20U);
  for (const Include& include : includes) {
    if (!starts_with(include.what, "flatpose/")) continue;
    const std::string from = step_of(include.file, 2);
    const std::string to = step_of(include.what, 1);
    EXPECT_LT(rank_of(from, kBusRooms), top) << include.file << " is in a room of no rank";
    const bool is_of_lib = rank_of(to) < lib_top;
    EXPECT_TRUE(is_of_lib || rank_of(to, kBusRooms) <= rank_of(from, kBusRooms))
        << include.file << " includes " << include.what;
  }
}

TEST(Layering, RoomsOfPortLinuxIncludeOnlyWhatStandsBelow) {
  const auto top = static_cast<std::ptrdiff_t>(kLinuxRooms.size());
  const auto includes = includes_under("port/linux");
  ASSERT_GT(includes.size(), 100U);
  for (const Include& include : includes) {
    const std::string from = step_of(include.file, 2);
    EXPECT_LT(rank_of(from, kLinuxRooms), top) << include.file << " is in a room of no rank";
    if (!starts_with(include.what, "port/linux/")) continue;
    EXPECT_LE(rank_of(step_of(include.what, 2), kLinuxRooms), rank_of(from, kLinuxRooms))
        << include.file << " includes " << include.what;
  }
}

TEST(Layering, TheProductKnowsNeitherItsBenchesNorItsTests) {
  for (const std::string folder : {"lib/flatpose", "fieldbus", "port"}) {
    for (const Include& include : includes_under(folder)) {
      EXPECT_FALSE(starts_with(include.what, "bench/") || starts_with(include.what, "tests/"))
          << include.file << " includes " << include.what;
    }
  }
  for (const Include& include : includes_under("bench")) {
    EXPECT_FALSE(starts_with(include.what, "tests/"))
        << include.file << " includes " << include.what;
  }
}

TEST(Layering, OnlyPortLinuxKnowsTheSystem) {
  const std::regex system_form(
      R"(^(sys/.*|linux/.*|unistd\.h|fcntl\.h|pthread\.h|sched\.h|modbus.*|net/.*|time\.h|cpuid\.h)$)");
  for (const std::string folder : {"lib/flatpose", "port/sim"}) {
    for (const Include& include : includes_under(folder)) {
      EXPECT_FALSE(std::regex_match(include.what, system_form))
          << include.file << " includes " << include.what;
      const std::string forbidden = folder == "lib/flatpose" ? "port/" : "port/linux/";
      EXPECT_FALSE(starts_with(include.what, forbidden))
          << include.file << " includes " << include.what;
    }
  }
}

TEST(Layering, OnlyPortLinuxAsksTheProcessor) {
  for (const std::string folder : {"lib/flatpose", "fieldbus", "port/sim"}) {
    over_lines(folder, [&](const fs::path& file, const std::string& line) {
      EXPECT_EQ(line.find("__builtin_cpu"), std::string::npos) << file << ": " << line;
    });
  }
}

}  // namespace
