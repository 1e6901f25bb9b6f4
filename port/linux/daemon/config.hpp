#pragma once
// What the daemon is told by its file. A section of the file is a file here (NAME_section.cpp) and
// a line in load_config().

#include <cstdint>
#include <string>
#include <string_view>

#include "flatpose/locate/locator.hpp"
#include "port/linux/realtime/config.hpp"

namespace flatpose::daemon {

class Section;

/// [search]
struct SearchConfig {
  int thread_count = 1;
  /// The largest scan, and cells of the finest height map: they decide how much memory is taken at
  /// the start. A scan beyond them is refused.
  locate::Limits limits;
  /// What loading a scan may take of memory.
  std::int64_t max_scan_bytes = 256 << 20;
};

struct Config {
  SearchConfig search;
  port::RealtimeConfig realtime;
};

/// Fails: port::InputError, `FILE:LINE: WHAT; REMEDY`.
[[nodiscard]] Config load_config(const std::string& path);
[[nodiscard]] Config parse_config(const std::string& path, std::string_view text);

void read_search(Section section, Config& config);
/// After read_search(): there is a processor for each thread or none is given.
void read_realtime(Section section, Config& config);

/// What the daemon holds in memory while it runs, stacks and loading apart.
[[nodiscard]] std::int64_t held_bytes(const SearchConfig& search);
/// What it may take at most, so that limits and machine should allow it.
[[nodiscard]] std::int64_t taken_bytes_max(const SearchConfig& search);
/// "2 search threads"
[[nodiscard]] std::string threads_text(const SearchConfig& search);

}  // namespace flatpose::daemon
