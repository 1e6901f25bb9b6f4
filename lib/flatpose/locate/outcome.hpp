#pragma once
// How a search ended: one enumeration for JSON, C and the bus. Positive: usable, with a warning.
// Negative: no pose.

namespace flatpose::locate {

enum class Outcome : int {
  kOk = 0,
  kAmbiguous = 1,    ///< A second pose of the same instance explains it about as well.
  kDeadline = 2,     ///< Time ran out; what is returned is verified, but more may have been found.
  kNoMatch = -1,     ///< Nothing reached the part's threshold.
  kEmptyScene = -2,  ///< Nothing stands in the scene that could be a part.
  kScanPoor = -3,    ///< Too little valid data to call anything empty.
  kCancelled = -4,
};

/// The name at the face: "ok", "no_match", ...
[[nodiscard]] const char* to_string(Outcome outcome) noexcept;

}  // namespace flatpose::locate
