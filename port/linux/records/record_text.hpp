#pragma once
// A record as files: its scan as PCD, its result as JSON like that of `flatpose locate --json` with
// what was asked and told added, and its picture.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "port/linux/records/record.hpp"
#include "port/linux/records/record_name.hpp"

namespace flatpose::port {

/// The name but for its sequence.
[[nodiscard]] RecordName name_of(const Record& record);

[[nodiscard]] std::string record_json(const Record& record, const RecordName& name);
/// Of a scan that is kept because a master said so.
[[nodiscard]] std::string saved_json(const Record& record, const RecordName& name);
/// The scan; VIEWPOINT says which side is up, a comment that it was simulated.
[[nodiscard]] std::vector<std::byte> record_pcd(const Record& record);

/// How a pick went, added to the text of record_json().  Fails: InputError when it is no such text.
struct Pick {
  std::uint16_t number = 0;   ///< Of the command whose pose was tried.
  std::uint16_t outcome = 0;  ///< As the master wrote it.
  std::int64_t since_1970_us = 0;
};
[[nodiscard]] std::string with_pick(const std::string& path, const std::string& json,
                                    const Pick& pick);
/// Counts it in {"picked":1,"missed":0,...}; an empty text is all zeros.  Fails: InputError.
[[nodiscard]] std::string with_pick_counted(const std::string& path, const std::string& json,
                                            const Pick& pick);

/// All matches in the scan, as `flatpose locate --overlay` draws them.  Fails: InputError,
/// std::bad_alloc.
[[nodiscard]] std::vector<std::byte> record_picture(const Record& record);

}  // namespace flatpose::port
