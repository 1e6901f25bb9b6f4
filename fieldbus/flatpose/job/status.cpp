#include "flatpose/job/status.hpp"

namespace flatpose::job {
namespace {

constexpr AnswerText kTexts[] = {
    {Answer::kOk, "ok", "found, or the command was done", "none needed"},
    {Answer::kAmbiguous, "ambiguous", "a second pose of the same part explains the scan as well",
     "declare the part's symmetry, or teach it with what tells the poses apart"},
    {Answer::kDeadline, "deadline",
     "time ran out; the pose is verified, but a better match may have been missed",
     "give the job more time, or a smaller region"},
    {Answer::kFaceUnsure, "face_unsure", "what tells the part's faces apart was hardly seen",
     "look at the part from where its holes show, or check the face before gripping"},
    {Answer::kNoMatch, "no_match", "nothing in the scan reached the part's threshold",
     "check that it is the part of this job, that it is in the region, and the overlay"},
    {Answer::kEmptyScene, "empty_scene", "nothing stands in the scene that could be a part",
     "feed the next part, or check the region's height range"},
    {Answer::kScanPoor, "scan_poor", "too little of the scan is valid to call anything empty",
     "check the laser, the exposure, ambient light and dirt on the window"},
    {Answer::kCancelled, "cancelled", "cancelled by command, or the owner's lease ran out",
     "poll at least once in the lease, and trigger again"},
    {Answer::kNoScan, "no_scan", "no scan was acquired after the trigger",
     "check that the camera runs and is triggered; for next, locate first"},
    {Answer::kOutsideLimits, "outside_limits",
     "every match lies outside the job's workspace, tilt or reach",
     "move the part, or widen the limits of the job"},
    {Answer::kNoAlignment, "no_alignment", "the job's frame needs an alignment and there is none",
     "align the work plane or the robot (flatpose align) and reload"},
    {Answer::kAlignmentMoved, "alignment_moved", "the alignment does not hold any more",
     "check what was moved, then align again"},
    {Answer::kBadJob, "bad_job", "the job's part or settings cannot be used",
     "read the log, mend the job and reload"},
    {Answer::kInternal, "internal", "a defect in flatpose", "report it with the log and the scan"},
    {Answer::kExpired, "expired", "the pose is older than the job's max_age_ms",
     "trigger again, and read the result sooner"},
    {Answer::kSimulated, "simulated", "the scan is simulated and that is not allowed",
     "use the camera, or set allow_simulated for a dry run"},
    {Answer::kAnswerLate, "answer_late", "no answer by answer_by_ms: search or camera hang",
     "check the camera and the log; trigger again when READY"},
    {Answer::kNotSaved, "not_saved", "the scan could not be saved",
     "free the disk, and check the record folder"},
    {Answer::kJobsRefused, "jobs_refused", "the new jobs have an error; the old ones are in force",
     "run flatposed --check on the config"},
    {Answer::kPending, "pending", "no result: none was asked for yet, or the command is running",
     "wait until done_number is the command_number"},
    {Answer::kOutOfTime, "out_of_time",
     "time ran out before anything was verified: a part may lie there all the same",
     "give the job more time, or a smaller region; then trigger again"},
    {Answer::kOutOfRange, "out_of_range",
     "the pose does not fit the numbers of CAN's PDOs: farther than 8388.607 mm, or a quaternion",
     "take another frame or convention in the job, or read the result over SDO"},
};

}  // namespace

bool is_fault(Answer answer) noexcept {
  switch (answer) {
    case Answer::kNoScan:
    case Answer::kNoAlignment:
    case Answer::kAlignmentMoved:
    case Answer::kBadJob:
    case Answer::kInternal:
    case Answer::kSimulated:
    case Answer::kAnswerLate:
    case Answer::kNotSaved:
    case Answer::kJobsRefused: return true;
    default: return false;
  }
}

std::span<const AnswerText> answer_texts() noexcept { return kTexts; }

const char* to_string(Answer answer) noexcept {
  for (const AnswerText& text : kTexts) {
    if (text.answer == answer) return text.name;
  }
  return "unknown";
}

}  // namespace flatpose::job
