#include "flatpose/core/status.hpp"

namespace flatpose {

const char* to_string(Status status) noexcept {
  switch (status) {
    case Status::kOk: return "ok";
    case Status::kInvalidArgument: return "invalid argument";
    case Status::kShapeMismatch: return "images differ in size";
    case Status::kOutOfMemory: return "memory given is too small";
    case Status::kTooLarge: return "a limit was passed";
    case Status::kNotFinite: return "a number is not finite";
    case Status::kTooFewPoints: return "too few valid points";
    case Status::kNoPart: return "no part stands out";
    case Status::kSeveralParts: return "several parts stand out";
    case Status::kNoContour: return "no usable contour";
    case Status::kBadMagic: return "not a file of this kind";
    case Status::kBadVersion: return "written by a newer version";
    case Status::kBadChecksum: return "checksum does not match";
    case Status::kTruncated: return "truncated";
    case Status::kStopped: return "stopped before it was done";
  }
  return "unknown status";
}

}  // namespace flatpose
