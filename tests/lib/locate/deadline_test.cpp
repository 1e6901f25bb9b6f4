// Time: what a deadline or a cancel leaves, how soon it is heeded, and how often the clock is
// looked at.

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <functional>

#include "tests/lib/image/executors.hpp"
#include "tests/lib/locate/made_bin.hpp"
#include "tests/lib/locate/simulated.hpp"

namespace flatpose::locate {
namespace {

using test::Locating;
using test::MadeScan;

MadeScan three() { return test::bin_scan(test::three_blocks()); }

/// Shows how often it was read, in microseconds; from a given reading on, what no deadline
/// outlasts.
class CountingClock final : public Clock {
 public:
  explicit CountingClock(int strikes_at = INT32_MAX) : strikes_at_(strikes_at) {}
  [[nodiscard]] std::int64_t now_us() const noexcept override {
    const int count = ++count_;
    return count < strikes_at_ ? count : kLate_us;
  }
  [[nodiscard]] int count() const noexcept { return count_; }

  static constexpr std::int64_t kLate_us = 2'000'000'000;

 private:
  int strikes_at_;
  mutable std::atomic<int> count_{0};
};

LocateConfig with_deadline() {
  LocateConfig config;
  config.max_matches = 5;
  config.deadline_us = CountingClock::kLate_us / 2;
  return config;
}

/// Readings of a search that no deadline ends.
int readings_of_a_whole_search(const model::Template& part, const RangeImageView& scan,
                               LocateResult& whole) {
  Locating locating;
  const CountingClock patient;
  EXPECT_EQ(locating.run(part, scan, with_deadline(), patient), Status::kOk);
  whole = locating.result;
  return patient.count();
}

void expect_cut_short(const LocateResult& found, const LocateResult& whole) {
  EXPECT_FALSE(found.is_exact);
  const double best =
      found.match_count > 0
          ? std::max_element(found.found().begin(), found.found().end(),
                             [](const Match& a, const Match& b) { return a.score < b.score; })
                ->score
          : 0.0;
  EXPECT_EQ(found.bound_gap, 1.0 - best);
  for (const Match& m : whole.found()) EXPECT_LE(m.score - best, found.bound_gap);
  for (const Match& m : found.found()) {
    EXPECT_TRUE(std::any_of(whole.found().begin(), whole.found().end(), [&](const Match& other) {
      return other.face_T_object.position_mm == m.face_T_object.position_mm &&
             other.score == m.score;
    }));
  }
}

TEST(Deadline, LeavesVerifiedMatchesOnlyWheneverItStrikes) {
  const MadeScan scan = three();
  const model::Template part = test::block_part();
  LocateResult whole;
  const int reading_count = readings_of_a_whole_search(part, scan.view(), whole);
  ASSERT_EQ(whole.outcome, Outcome::kOk);
  ASSERT_EQ(whole.match_count, 3);
  EXPECT_TRUE(whole.is_exact);
  EXPECT_EQ(whole.bound_gap, 0.0);
  EXPECT_GT(whole.evaluated_count, 0);
  EXPECT_LE(whole.evaluated_count, whole.hypothesis_count);

  Locating locating;
  std::array<int, 4> seen{};
  int last_count = 0;
  for (int reading = 2; reading <= reading_count; reading += reading < reading_count / 2 ? 5 : 1) {
    const CountingClock clock(reading);
    ASSERT_EQ(locating.run(part, scan.view(), with_deadline(), clock), Status::kOk);
    const LocateResult& found = locating.result;
    // At the last readings there is nothing left to cut short.
    if (found.outcome == Outcome::kOk) {
      EXPECT_EQ(digest(found), digest(whole)) << reading;
    } else {
      ASSERT_EQ(found.outcome, Outcome::kDeadline) << reading;
      expect_cut_short(found, whole);
      // Once it has struck the clock is read for the timings only.
      constexpr int kTimings = 5;
      EXPECT_LE(clock.count() - reading, kTimings) << reading;
    }
    EXPECT_GE(found.match_count, last_count) << reading;
    last_count = found.match_count;
    ++seen[static_cast<std::size_t>(last_count)];
  }
  // It struck where nothing was known yet, where one was, and two, and all.
  EXPECT_GT(*std::min_element(seen.begin(), seen.end()), 0);
}

TEST(Deadline, NoneMeansNone) {
  const MadeScan scan = three();
  Locating locating;
  const CountingClock clock(3);
  ASSERT_EQ(locating.run(test::block_part(), scan.view(), {}, clock), Status::kOk);
  EXPECT_EQ(locating.result.outcome, Outcome::kOk);
  EXPECT_EQ(locating.result.match_count, 1);
}

TEST(Deadline, StrikesOnThreadsToo) {
  const MadeScan scan = three();
  const model::Template part = test::block_part();
  LocateResult whole;
  const int reading_count = readings_of_a_whole_search(part, scan.view(), whole);
  ThreadExecutor threads(3);
  Locating locating;
  for (int reading = 2; reading < reading_count; reading += 7) {
    const CountingClock clock(reading);
    ASSERT_EQ(locating.run(part, scan.view(), with_deadline(), {clock, threads}), Status::kOk);
    if (locating.result.outcome == Outcome::kDeadline) expect_cut_short(locating.result, whole);
  }
}

/// Sets a flag at a given reading.
class CancellingClock final : public Clock {
 public:
  CancellingClock(int at, CancelFlag& flag) : left_(at), flag_(flag) {}
  [[nodiscard]] std::int64_t now_us() const noexcept override {
    if (--left_ == 0) flag_.set(true);
    return 1;
  }

 private:
  mutable int left_;
  CancelFlag& flag_;
};

TEST(Cancel, LeavesNoPoseAndALocatorAsGoodAsNew) {
  const MadeScan scan = three();
  const model::Template part = test::block_part();
  LocateResult whole;
  const int reading_count = readings_of_a_whole_search(part, scan.view(), whole);
  Locating locating;
  int cancelled_count = 0;
  for (int reading = 2; reading < reading_count; reading += 11) {
    CancelFlag flag;
    const CancellingClock clock(reading, flag);
    ASSERT_EQ(locating.run(part, scan.view(), with_deadline(), {clock, callers_thread, &flag}),
              Status::kOk);
    const LocateResult& found = locating.result;
    if (found.outcome == Outcome::kOk) continue;  // too late
    ++cancelled_count;
    ASSERT_EQ(found.outcome, Outcome::kCancelled) << reading;
    EXPECT_EQ(found.match_count, 0);
    EXPECT_FALSE(found.is_exact);
  }
  EXPECT_GT(cancelled_count, 20);
  ASSERT_EQ(locating.run(part, scan.view(), with_deadline()), Status::kOk);
  EXPECT_EQ(digest(locating.result), digest(whole));
}

TEST(Cancel, BeforeTheStartIsHeededWithoutAClock) {
  const MadeScan scan = three();
  Locating locating;
  CancelFlag flag;
  flag.set(true);
  const StoppedClock clock;
  ASSERT_EQ(locating.run(test::block_part(), scan.view(), {}, {clock, callers_thread, &flag}),
            Status::kOk);
  EXPECT_EQ(locating.result.outcome, Outcome::kCancelled);
}

// With a clock that counts, a stage's time is how often it looked: at least once for every so many
// rows that each of its passes goes through, blocks of places, and refinements.
TEST(Looks, ComeAsOftenAsTheWorkGrows) {
  for (const int side_px : {150, 300}) {
    const MadeScan scan(side_px, side_px, 1.0, [](double x, double y) {
      const bool is_block = x > 30.0 && x < 90.0 && y > 40.0 && y < 80.0;
      return is_block ? 20.0 : 0.0;
    });
    Locating locating({300, 300, 120'000});
    const CountingClock clock;
    ASSERT_EQ(locating.run(test::block_part(), scan.view(), with_deadline(), clock), Status::kOk);
    const Timings& t = locating.result.timings;
    const int per_pass = side_px / kRowsPerLook;
    // Survey, clearing, painting; fill down and up when points miss; edges.
    EXPECT_GE(t.rectify_us, 5 * per_pass);
    // Distances down and up, normals; on half as many rows distances, fill and tilt.
    EXPECT_GE(t.features_us, 3 * per_pass + 2 * per_pass);
    // A block holds no more than 64 places.
    const std::int64_t angle_count = 53;
    EXPECT_GE(t.search_us, locating.result.hypothesis_count / angle_count / 64 / kBlocksPerLook);
    EXPECT_GE(t.refine_us + t.verify_us, locating.result.candidate_count / 4);
  }
}

}  // namespace
}  // namespace flatpose::locate
