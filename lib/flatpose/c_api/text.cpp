// Names and numbers of the C API.

#include "flatpose/core/status.hpp"
#include "flatpose/flatpose.h"
#include "flatpose/locate/outcome.hpp"

using flatpose::Status;
using flatpose::locate::Outcome;

static_assert(FLATPOSE_STATUS_OK == static_cast<int>(Status::kOk) &&
              FLATPOSE_STATUS_INVALID_ARGUMENT == static_cast<int>(Status::kInvalidArgument) &&
              FLATPOSE_STATUS_SHAPE_MISMATCH == static_cast<int>(Status::kShapeMismatch) &&
              FLATPOSE_STATUS_OUT_OF_MEMORY == static_cast<int>(Status::kOutOfMemory) &&
              FLATPOSE_STATUS_TOO_LARGE == static_cast<int>(Status::kTooLarge) &&
              FLATPOSE_STATUS_NOT_FINITE == static_cast<int>(Status::kNotFinite) &&
              FLATPOSE_STATUS_TOO_FEW_POINTS == static_cast<int>(Status::kTooFewPoints) &&
              FLATPOSE_STATUS_NO_PART == static_cast<int>(Status::kNoPart) &&
              FLATPOSE_STATUS_SEVERAL_PARTS == static_cast<int>(Status::kSeveralParts) &&
              FLATPOSE_STATUS_NO_CONTOUR == static_cast<int>(Status::kNoContour) &&
              FLATPOSE_STATUS_BAD_MAGIC == static_cast<int>(Status::kBadMagic) &&
              FLATPOSE_STATUS_BAD_VERSION == static_cast<int>(Status::kBadVersion) &&
              FLATPOSE_STATUS_BAD_CHECKSUM == static_cast<int>(Status::kBadChecksum) &&
              FLATPOSE_STATUS_TRUNCATED == static_cast<int>(Status::kTruncated) &&
              FLATPOSE_STATUS_STOPPED == static_cast<int>(Status::kStopped));
static_assert(FLATPOSE_OUTCOME_OK == static_cast<int>(Outcome::kOk) &&
              FLATPOSE_OUTCOME_AMBIGUOUS == static_cast<int>(Outcome::kAmbiguous) &&
              FLATPOSE_OUTCOME_DEADLINE == static_cast<int>(Outcome::kDeadline) &&
              FLATPOSE_OUTCOME_NO_MATCH == static_cast<int>(Outcome::kNoMatch) &&
              FLATPOSE_OUTCOME_EMPTY_SCENE == static_cast<int>(Outcome::kEmptyScene) &&
              FLATPOSE_OUTCOME_SCAN_POOR == static_cast<int>(Outcome::kScanPoor) &&
              FLATPOSE_OUTCOME_CANCELLED == static_cast<int>(Outcome::kCancelled));

const char* flatpose_status_text(flatpose_status status) {
  return flatpose::to_string(static_cast<Status>(status));
}

const char* flatpose_outcome_name(int32_t outcome) {
  return flatpose::locate::to_string(static_cast<Outcome>(outcome));
}

uint32_t flatpose_version(void) { return FLATPOSE_VERSION_NUMBER; }
