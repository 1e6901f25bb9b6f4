#pragma once
// The folder that records lie in: the last of all kinds, more of the failed, and what a master had
// saved. Bounded by count and by bytes at any time, also by what lay there before a restart; files
// of other names are nobody's business here. What is on disk is looked at anew each time: somebody
// may have taken files away.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "port/linux/files/atomic_file.hpp"
#include "port/linux/records/record_name.hpp"

namespace flatpose::port {

struct RecordLimits {
  int last_count = 100;    ///< Of all kinds.
  int failed_count = 100;  ///< Of those without a pose, whatever came after.
  int saved_count = 100;   ///< By save_scan: then no more are.
  std::int64_t bytes_max = std::int64_t{1000} << 20;  ///< Of last and failed; saved are apart.
};

class RecordFolder {
 public:
  RecordFolder(std::string path, const RecordLimits& limits)
      : path_(std::move(path)), limits_(limits) {}

  /// Makes the folder if its parent is there, takes away what a killed process left half-written,
  /// and what is beyond the limits.  Fails: InputError.
  void open();

  /// `name` with the next sequence.  Fails: InputError.
  [[nodiscard]] RecordName named(RecordName name);
  /// Writes NAME.pcd (none when `scan` is empty) and NAME.json; the oldest make room first.
  /// Fails: InputError; nothing of it is left then.
  void add(const RecordName& name, std::span<const std::byte> scan, std::string_view json);
  /// The same for kSaved, which make no room: refuses when there are saved_count.
  void save(const RecordName& name, std::span<const std::byte> scan, std::string_view json);
  /// Replaces a file that is not counted, as last.json.  Fails: InputError.
  void put(const std::string& file_name, std::span<const std::byte> bytes,
           NewName name = NewName::kOutlastsPower);

  /// The newest record of the master's number, none older than `sequence`.
  [[nodiscard]] std::optional<RecordName> find(std::uint16_t number, std::uint64_t sequence) const;
  [[nodiscard]] std::string path_of(const std::string& file_name) const {
    return path_ + "/" + file_name;
  }

 private:
  struct Found {
    RecordName name;
    std::int64_t bytes = 0;
    std::vector<std::string> files;
  };

  void make_folder() const;
  void sweep() const;
  [[nodiscard]] std::vector<Found> list() const;  ///< Newest first.
  void make_room(bool is_failed, std::int64_t bytes) const;
  void keep(int last_count, int failed_count, std::int64_t bytes_max) const;
  void write(const RecordName& name, std::span<const std::byte> scan, std::string_view json);

  std::string path_;
  RecordLimits limits_;
  std::uint64_t next_ = 1;
};

}  // namespace flatpose::port
