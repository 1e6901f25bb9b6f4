// [search]: threads, and the limits that memory is taken for.

#include <algorithm>

#include "port/linux/cpu/vector_path.hpp"
#include "port/linux/daemon/config.hpp"
#include "port/linux/daemon/driver_scan.hpp"
#include "port/linux/daemon/plane_check.hpp"
#include "port/linux/daemon/scan_buffer.hpp"
#include "port/linux/daemon/section.hpp"

namespace flatpose::daemon {
namespace {

constexpr Range kThreads{1, 64};
constexpr Range kSides_px{2, 32767};
constexpr Range kCells{10'000, 16'777'216};
constexpr Range kScanBytes{1 << 20, std::int64_t{16} << 30};

/// Program, libraries, stacks and what else is in a process.
constexpr std::int64_t kRest_bytes = 64 << 20;
/// Records in memory: one to be filled, and the one before, to be drawn.
constexpr int kRecordCount = 2;
/// Drawing it.
constexpr std::int64_t kPicture_bytes = 96 << 20;

int small(std::optional<std::int64_t> given, int usual) {
  return static_cast<int>(given.value_or(usual));
}

}  // namespace

void read_search(Section section, Config& config) {
  SearchConfig& search = config.search;
  locate::Limits& limits = search.limits;
  search.thread_count = small(section.whole("threads", kThreads), search.thread_count);
  limits.scan_width_px = small(section.whole("scan_width_px", kSides_px), limits.scan_width_px);
  limits.scan_height_px = small(section.whole("scan_height_px", kSides_px), limits.scan_height_px);
  limits.cell_count = small(section.whole("cell_count", kCells), limits.cell_count);
  limits.vector_path = port::best_vector_path();
  search.max_scan_bytes =
      section.whole("max_scan_bytes", kScanBytes).value_or(search.max_scan_bytes);
  section.finish();
}

std::size_t search_arena_bytes(const locate::Limits& limits) noexcept {
  return std::max(locate::Locator::required_bytes(limits), plane_check_bytes(limits));
}

std::int64_t held_bytes(const Config& config) {
  const locate::Limits& limits = config.search.limits;
  const int scan_count = kScanBufferCount + (config.records.folder.empty() ? 0 : kRecordCount);
  const std::size_t driver_bytes = config.source.driver.empty() ? 0 : driver_memory_bytes(limits);
  return static_cast<std::int64_t>(search_arena_bytes(limits) + driver_bytes) +
         scan_count * static_cast<std::int64_t>(scan_buffer_bytes(limits));
}

std::int64_t taken_bytes_max(const Config& config) {
  const auto scan_bytes = static_cast<std::int64_t>(scan_buffer_bytes(config.search.limits));
  const std::int64_t record_bytes = config.records.folder.empty() ? 0 : scan_bytes + kPicture_bytes;
  return held_bytes(config) + config.search.max_scan_bytes + record_bytes + kRest_bytes;
}

std::string threads_text(const SearchConfig& search) {
  return std::to_string(search.thread_count) + " search thread" +
         (search.thread_count == 1 ? "" : "s");
}

}  // namespace flatpose::daemon
