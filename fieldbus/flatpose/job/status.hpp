#pragma once
// How a command ended, as the bus tells it: the numbers of locate::Outcome, continued by what only
// a bus can meet. One enumeration for JSON, C and the bus: 0 found (or done), positive usable with
// a warning, negative no pose.

#include <cstdint>
#include <span>

#include "flatpose/locate/outcome.hpp"

namespace flatpose::job {

enum class Answer : std::int16_t {
  kOk = 0,
  kAmbiguous = 1,
  kDeadline = 2,
  kFaceUnsure = 3,
  kNoMatch = -1,
  kEmptyScene = -2,
  kScanPoor = -3,
  kCancelled = -4,
  kNoScan = -5,
  kOutsideLimits = -6,
  kNoAlignment = -7,
  kAlignmentMoved = -8,
  kBadJob = -9,
  kInternal = -10,
  kExpired = -11,
  kSimulated = -12,
  kAnswerLate = -13,
  kNotSaved = -14,
  kJobsRefused = -15,
  kPending = -16,
  kOutOfTime = -17,
  kOutOfRange = -18,
};

[[nodiscard]] constexpr Answer answer_of(locate::Outcome outcome) noexcept {
  return static_cast<Answer>(outcome);
}
static_assert(answer_of(locate::Outcome::kOk) == Answer::kOk);
static_assert(answer_of(locate::Outcome::kAmbiguous) == Answer::kAmbiguous);
static_assert(answer_of(locate::Outcome::kDeadline) == Answer::kDeadline);
static_assert(answer_of(locate::Outcome::kNoMatch) == Answer::kNoMatch);
static_assert(answer_of(locate::Outcome::kEmptyScene) == Answer::kEmptyScene);
static_assert(answer_of(locate::Outcome::kScanPoor) == Answer::kScanPoor);
static_assert(answer_of(locate::Outcome::kCancelled) == Answer::kCancelled);

/// Whether this ending may carry a pose.
[[nodiscard]] constexpr bool may_have_pose(Answer answer) noexcept {
  return static_cast<int>(answer) >= 0;
}

/// Whether the machine is at fault, not the scene: the ERROR bit.
[[nodiscard]] bool is_fault(Answer answer) noexcept;

struct AnswerText {
  Answer answer;
  const char* name;
  const char* cause;
  const char* remedy;
};

/// Every answer, from 0 up, then from -1 down.
[[nodiscard]] std::span<const AnswerText> answer_texts() noexcept;

/// "ok", "no_match", ...
[[nodiscard]] const char* to_string(Answer answer) noexcept;

}  // namespace flatpose::job
