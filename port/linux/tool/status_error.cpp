#include "port/linux/tool/status_error.hpp"

#include <stdexcept>

#include "port/linux/files/input_error.hpp"

namespace flatpose::tool {
namespace {

struct Words {
  const char* why;
  const char* remedy;
};

Words words_for_template(Status status) {
  switch (status) {
    case Status::kBadMagic:
      return {"it is no template", "give a .fpt file that flatpose teach wrote"};
    case Status::kBadVersion: return {"written by a newer flatpose", "update this one"};
    case Status::kBadChecksum:
      return {"damaged: its checksum does not match", "copy or teach it again"};
    case Status::kTruncated: return {"cut off: bytes are missing", "copy or teach it again"};
    case Status::kTooLarge: return {"longer than any template", "copy or teach it again"};
    default: return {"damaged: it holds values that no template has", "copy or teach it again"};
  }
}

Words words_for_scan(Status status, Doing doing) {
  const bool teaches = doing == Doing::kTeach;
  switch (status) {
    case Status::kNotFinite:
      return {"a coordinate is infinite or beyond 1e6 mm in the frame asked for",
              "check that scan and work file belong together and hold mm"};
    case Status::kTooLarge:
      return teaches ? Words{"its field is too large for its point distance",
                             "crop the scan to the part's surroundings"}
                     : Words{"its field has too many cells at this resolution",
                             "give a --region or a larger --resolution"};
    case Status::kTooFewPoints:
      return {"too few valid points",
              teaches ? "scan the part again, or draw a region in which it is seen"
                      : "scan again, with the part in the sensor's field"};
    case Status::kNoPart:
      return {"nothing stands out inside the region; no part to teach",
              "draw it around the part, with a margin"};
    case Status::kSeveralParts:
      return {"several parts stand out", "say which one by --region circle:X,Y,R"};
    case Status::kNoContour:
      return {"the part has no usable contour",
              "draw the region wider than the part, or scan it more finely"};
    case Status::kShapeMismatch:
      return {"the mask has another size", "paint it on a picture of the scan"};
    case Status::kInvalidArgument:
      return {"an option does not fit the scan",
              teaches ? "check --origin, --x-axis, --symmetry and the mask's origin"
                      : "check --resolution and --region against its size"};
    default: return {nullptr, nullptr};
  }
}

}  // namespace

void fail(Status status, Doing doing, const std::string& subject) {
  if (doing == Doing::kReadTemplate) {
    const Words words = words_for_template(status);
    throw port::InputError(subject, words.why, words.remedy);
  }
  const Words words =
      doing == Doing::kWriteTemplate ? Words{nullptr, nullptr} : words_for_scan(status, doing);
  if (words.why == nullptr) throw std::logic_error(subject + ": " + to_string(status));
  throw port::InputError(subject, words.why, words.remedy);
}

}  // namespace flatpose::tool
