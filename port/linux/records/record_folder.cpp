#include "port/linux/records/record_folder.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <map>

#include "port/linux/files/input_error.hpp"

namespace flatpose::port {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTemporary = ".flatpose-";
constexpr const char* kRemedy = "check the path, its rights and the disk";

[[noreturn]] void fail(const std::string& path, const std::error_code& error) {
  throw InputError(path, "cannot keep records there: " + error.message(), kRemedy);
}

/// The process that writes `.flatpose-PID-N.tmp`; 0: it is no such name.
pid_t writer_of(const std::string& name) {
  if (name.rfind(kTemporary, 0) != 0 || !name.ends_with(".tmp")) return 0;
  pid_t pid = 0;
  const char* const start = name.data() + std::strlen(kTemporary);
  const auto [stop, error] = std::from_chars(start, name.data() + name.size(), pid);
  return error == std::errc() && *stop == '-' && pid > 0 ? pid : 0;
}

bool lives(pid_t pid) { return ::kill(pid, 0) == 0 || errno != ESRCH; }

/// Calls with each regular file of the folder.
template <class Visit>
void over_files(const std::string& path, const Visit& visit) {
  std::error_code error;
  fs::directory_iterator entry(path, error);
  if (error) fail(path, error);
  for (const fs::directory_iterator end; entry != end; entry.increment(error)) {
    if (error) fail(path, error);
    std::error_code vanished;
    if (fs::is_regular_file(entry->symlink_status(vanished))) visit(*entry);
  }
}

}  // namespace

void RecordFolder::open() {
  make_folder();
  sweep();
  keep(limits_.last_count, limits_.failed_count, limits_.bytes_max);
}

void RecordFolder::make_folder() const {
  if (::mkdir(path_.c_str(), 0777) != 0 && errno != EEXIST)
    fail(path_, std::error_code(errno, std::generic_category()));
}

// Whoever wrote them is dead, or bore the number that this process has now and wrote nothing yet.
void RecordFolder::sweep() const {
  over_files(path_, [](const fs::directory_entry& entry) {
    const pid_t writer = writer_of(entry.path().filename().string());
    std::error_code ignored;
    if (writer != 0 && (writer == ::getpid() || !lives(writer))) fs::remove(entry.path(), ignored);
  });
}

std::vector<RecordFolder::Found> RecordFolder::list() const {
  std::map<std::string, Found> by_stem;
  over_files(path_, [&](const fs::directory_entry& entry) {
    const fs::path& file = entry.path();
    if (file.extension() != ".pcd" && file.extension() != ".json") return;
    const auto name = RecordName::parse(file.stem().string());
    if (!name) return;
    std::error_code vanished;
    const auto bytes = static_cast<std::int64_t>(entry.file_size(vanished));
    Found& found = by_stem[file.stem().string()];
    found.name = *name;
    found.bytes += vanished ? 0 : bytes;
    found.files.push_back(file.string());
  });
  std::vector<Found> list;
  for (auto& [stem, found] : by_stem) list.push_back(std::move(found));
  std::sort(list.begin(), list.end(), [](const Found& a, const Found& b) {
    return a.name.sequence != b.name.sequence ? a.name.sequence > b.name.sequence
                                              : a.name.text() > b.name.text();
  });
  return list;
}

RecordName RecordFolder::named(RecordName name) {
  make_folder();
  for (const Found& found : list()) next_ = std::max(next_, found.name.sequence + 1);
  name.sequence = next_++;
  return name;
}

void RecordFolder::keep(int last_count, int failed_count, std::int64_t bytes_max) const {
  int seen = 0;
  int seen_failed = 0;
  std::int64_t bytes = 0;
  bool is_full = false;
  for (const Found& found : list()) {
    if (found.name.kind == RecordName::Kind::kSaved) continue;
    const bool is_failed = found.name.kind == RecordName::Kind::kFailed;
    const bool is_wanted = seen < last_count || (is_failed && seen_failed < failed_count);
    ++seen;
    if (is_failed) ++seen_failed;
    is_full = is_full || (is_wanted && bytes + found.bytes > bytes_max);
    if (is_wanted && !is_full) {
      bytes += found.bytes;
      continue;
    }
    std::error_code ignored;  // what cannot be taken away is seen again next time
    for (const std::string& file : found.files) fs::remove(file, ignored);
  }
}

void RecordFolder::make_room(bool is_failed, std::int64_t bytes) const {
  if (bytes > limits_.bytes_max)
    throw InputError(path_, "a record of " + std::to_string(bytes) + " bytes is beyond max_mb",
                     "raise it");
  keep(std::max(limits_.last_count - 1, 0), std::max(limits_.failed_count - (is_failed ? 1 : 0), 0),
       limits_.bytes_max - bytes);
}

void RecordFolder::add(const RecordName& name, std::span<const std::byte> scan,
                       std::string_view json) {
  const bool is_failed = name.kind == RecordName::Kind::kFailed;
  if (limits_.last_count == 0 && !(is_failed && limits_.failed_count > 0)) return;
  make_room(is_failed, static_cast<std::int64_t>(scan.size() + json.size()));
  write(name, scan, json);
}

void RecordFolder::save(const RecordName& name, std::span<const std::byte> scan,
                        std::string_view json) {
  const auto all = list();
  const auto saved = std::count_if(all.begin(), all.end(), [](const Found& found) {
    return found.name.kind == RecordName::Kind::kSaved;
  });
  if (saved >= limits_.saved_count)
    throw InputError(path_, std::to_string(saved) + " saved scans are all that are allowed",
                     "take some away, or raise 'saved' in [records]");
  write(name, scan, json);
}

void RecordFolder::write(const RecordName& name, std::span<const std::byte> scan,
                         std::string_view json) {
  const std::string stem = path_of(name.text());
  // One sync of the folder is for both names.
  if (!scan.empty()) write_file_atomically(stem + ".pcd", scan, NewName::kMayBeLost);
  try {
    write_file_atomically(stem + ".json", json);
  } catch (...) {
    ::unlink((stem + ".pcd").c_str());
    throw;
  }
}

void RecordFolder::put(const std::string& file_name, std::span<const std::byte> bytes,
                       NewName name) {
  write_file_atomically(path_of(file_name), bytes, name);
}

std::optional<RecordName> RecordFolder::find(std::uint16_t number, std::uint64_t sequence) const {
  for (const Found& found : list()) {
    const bool is_it = found.name.number == number && found.name.sequence >= sequence;
    if (is_it && found.name.kind != RecordName::Kind::kSaved) return found.name;
  }
  return std::nullopt;
}

}  // namespace flatpose::port
