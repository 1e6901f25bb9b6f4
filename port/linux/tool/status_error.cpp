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

// Nothing is searched for where the part was painted: the paint is what can be wrong.
Words words_for_mask(Status status) {
  switch (status) {
    case Status::kNoPart:
      return {"too little of its blue lies on valid points of the scan; no part to teach",
              "paint the whole upper side of the part blue"};
    case Status::kNoContour:
      return {"too few edges of the scan lie under its red; no usable contour",
              "paint the part's edges red, where the height falls"};
    case Status::kTooFewPoints:
      return {"too few valid points of the scan lie under it", "scan the part again"};
    default: return words_for_scan(status, Doing::kTeach);
  }
}

Words words_for(Status status, Doing doing) {
  switch (doing) {
    case Doing::kReadTemplate: return words_for_template(status);
    case Doing::kWriteTemplate: return {nullptr, nullptr};
    case Doing::kTeachByMask: return words_for_mask(status);
    default: return words_for_scan(status, doing);
  }
}

}  // namespace

void fail(Status status, Doing doing, const std::string& subject) {
  const Words words = words_for(status, doing);
  if (words.why == nullptr) throw std::logic_error(subject + ": " + to_string(status));
  throw port::InputError(subject, words.why, words.remedy);
}

}  // namespace flatpose::tool
