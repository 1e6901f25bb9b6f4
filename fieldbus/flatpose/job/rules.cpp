#include "flatpose/job/rules.hpp"

#include <cmath>

namespace flatpose::job {
namespace {

constexpr std::int64_t kHour_us = 3'600'000'000;
constexpr std::int64_t kLeastPatience_us = 100'000;

bool is_within(std::int64_t value, std::int64_t low, std::int64_t high) noexcept {
  return value >= low && value <= high;
}

Status validate(const JobRule& rule) noexcept {
  const bool is_right = rule.job != 0 && rule.frame <= FrameName::kRobot &&
                        static_cast<int>(rule.convention) < kConventionCount &&
                        is_within(rule.max_age_us, 0, kHour_us) &&
                        is_within(rule.answer_by_us, 1'000, kHour_us);
  if (!is_right) return Status::kInvalidArgument;
  for (const double number : rule.reference) {
    if (!std::isfinite(number)) return Status::kNotFinite;
  }
  return Status::kOk;
}

}  // namespace

Status validate(const Config& config) noexcept {
  const bool is_right = config.session_id != 0 && config.handshake <= Handshake::kBits &&
                        is_within(config.lease_us, kLeastPatience_us, kHour_us) &&
                        is_within(config.liveness_limit_us, kLeastPatience_us, kHour_us);
  return is_right ? Status::kOk : Status::kInvalidArgument;
}

Status validate(const JobTable& jobs) noexcept {
  if (jobs.count < 0 || jobs.count > kJobCountMax) return Status::kInvalidArgument;
  for (int i = 0; i < jobs.count; ++i) {
    const Status status = validate(jobs.rules[i]);
    if (status != Status::kOk) return status;
    if (jobs.find(jobs.rules[i].job) != &jobs.rules[i]) return Status::kInvalidArgument;
  }
  return Status::kOk;
}

}  // namespace flatpose::job
