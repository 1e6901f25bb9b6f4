#include "flatpose/job/rules.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "tests/fieldbus/job/desk.hpp"

namespace flatpose::job {
namespace {

TEST(Config, DefaultsAreValidAndEveryBadFieldIsRefused) {
  EXPECT_EQ(validate(Config{}), Status::kOk);
  const std::vector<std::function<void(Config&)>> spoilers{
      [](Config& c) { c.session_id = 0; }, [](Config& c) { c.lease_us = 99'999; },
      [](Config& c) { c.lease_us = 3'600'000'001; }, [](Config& c) { c.liveness_limit_us = 0; },
      [](Config& c) { c.handshake = static_cast<Handshake>(2); }};
  for (const auto& spoil : spoilers) {
    Config config;
    spoil(config);
    EXPECT_EQ(validate(config), Status::kInvalidArgument);
    Machine machine;
    EXPECT_EQ(machine.init(config, {}, 0), Status::kInvalidArgument);
  }
}

TEST(JobTable, EveryBadFieldIsRefused) {
  EXPECT_EQ(validate(two_jobs()), Status::kOk);
  const std::vector<std::function<void(JobTable&)>> spoilers{
      [](JobTable& t) { t.count = kJobCountMax + 1; },
      [](JobTable& t) { t.count = -1; },
      [](JobTable& t) { t.rules[1].job = 1; },  // twice
      [](JobTable& t) { t.rules[0].job = 0; },
      [](JobTable& t) { t.rules[0].max_age_us = -1; },
      [](JobTable& t) { t.rules[0].answer_by_us = 0; },
      [](JobTable& t) { t.rules[0].convention = static_cast<Convention>(6); },
      [](JobTable& t) { t.rules[0].frame = static_cast<FrameName>(3); }};
  for (const auto& spoil : spoilers) {
    JobTable jobs = two_jobs();
    spoil(jobs);
    EXPECT_EQ(validate(jobs), Status::kInvalidArgument);
  }
  JobTable jobs = two_jobs();
  jobs.rules[1].reference[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(validate(jobs), Status::kNotFinite);
}

TEST(JobTable, FindsByNumberOnly) {
  const JobTable jobs = two_jobs();
  EXPECT_EQ(jobs.find(7), &jobs.rules[1]);
  EXPECT_EQ(jobs.find(2), nullptr);
}

}  // namespace
}  // namespace flatpose::job
