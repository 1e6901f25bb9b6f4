// [records]: what is kept on disk of searches, and where starts are counted.

#include "port/linux/daemon/config.hpp"
#include "port/linux/daemon/section.hpp"

namespace flatpose::daemon {
namespace {

constexpr Range kCounts{0, 10'000};
constexpr Range kMegabytes{1, 1'000'000};

int count(const std::optional<std::int64_t>& given, int usual) {
  return static_cast<int>(given.value_or(usual));
}

}  // namespace

void read_records(Section section, Config& config) {
  RecordsConfig& records = config.records;
  port::RecordLimits& limits = records.limits;
  records.folder = section.file("folder").value_or("");
  records.state_file = section.file("state").value_or("");
  limits.last_count = count(section.whole("last", kCounts), limits.last_count);
  limits.failed_count = count(section.whole("failed", kCounts), limits.failed_count);
  limits.saved_count = count(section.whole("saved", kCounts), limits.saved_count);
  if (const auto megabytes = section.whole("max_mb", kMegabytes))
    limits.bytes_max = *megabytes << 20;
  records.draws = section.flag("picture").value_or(records.draws);
  section.finish();
  if (section.is_there() && records.folder.empty() && records.state_file.empty())
    section.fail("folder", "[records] names no folder", "write folder = \"DIR\"");
}

std::string state_file_of(const RecordsConfig& records, const char* state_directory) {
  if (!records.state_file.empty()) return records.state_file;
  // Of several the first, as systemd lists them.
  const std::string folders = state_directory == nullptr ? "" : state_directory;
  const std::string first = folders.substr(0, folders.find(':'));
  const std::string folder = first.empty() ? records.folder : first;
  return folder.empty() ? "" : folder + "/state.json";
}

}  // namespace flatpose::daemon
