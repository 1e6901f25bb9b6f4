#pragma once
// Names of records: they count up, so they sort by time whatever the machine's clock does, and say
// what there is to see:
//   record-0000000042-20260131T235959Z-n00021-failed-no_match.pcd, .json
//   saved-0000000043-20260131T235959Z-n00022.pcd, .json

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace flatpose::port {

struct RecordName {
  /// kDone: what makes no pose.
  enum class Kind : std::uint8_t { kFound, kFailed, kDone, kSaved };

  std::uint64_t sequence = 0;
  std::string time;          ///< By utc_text().
  std::uint16_t number = 0;  ///< The master's.
  Kind kind = Kind::kDone;
  std::string status;  ///< None with kSaved.

  /// Without extension.
  [[nodiscard]] std::string text() const;
  /// Nothing for any name that text() does not write.
  [[nodiscard]] static std::optional<RecordName> parse(std::string_view stem);
};

/// "20260131T235959Z"
[[nodiscard]] std::string utc_text(std::int64_t since_1970_us);

}  // namespace flatpose::port
