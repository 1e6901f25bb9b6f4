// A job run in a scan by itself, on a clock of the test's.

#include "port/linux/daemon/job_search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "port/linux/files/scan.hpp"
#include "port/sim/simulate.hpp"
#include "tests/port/linux/files/temporary_folder.hpp"

namespace flatpose::daemon {
namespace {

using job::Answer;

/// Goes on by as much at each reading.
class TickingClock final : public Clock {
 public:
  explicit TickingClock(std::int64_t tick_us) : tick_us_(tick_us) {}
  [[nodiscard]] std::int64_t now_us() const noexcept override { return now_us_ += tick_us_; }

 private:
  std::int64_t tick_us_;
  mutable std::int64_t now_us_ = 0;
};

/// A job set up from its lines in the config, for one match of the pad.
class SearchedJob : public testing::Test {
 protected:
  SearchedJob() {
    held_.view = scan_.view();
    held_.up = scan_.up;
    set_up("");
  }
  void set_up(const std::string& lines_of_job) {
    config_ = load_config(
        folder_.write("f.toml",
                      "[search]\nscan_width_px = 400\nscan_height_px = 333\ncell_count = 600_000\n"
                      "[[part]]\nname = \"pad\"\nfile = \"" FLATPOSE_EXAMPLE
                      "/pad.fpt\"\n[[job]]\nparts = [\"pad\"]\n" +
                          lines_of_job));
    memory_.resize(locate::Locator::required_bytes(config_.search.limits));
    EXPECT_EQ(locator_.init(config_.search.limits, memory_), Status::kOk);
    jobs_ = load_jobs(config_);
  }
  job::ScanResult run(const Clock& clock) {
    job::Order order;
    order.kind = job::Order::Kind::kStart;
    order.job = 1;
    order.answer_by_us = INT64_MAX;
    return search_.run(order, held_, Host(clock));
  }

  port::TemporaryFolder folder_;
  Config config_;
  JobSet jobs_;
  port::Scan scan_ = port::read_scan(FLATPOSE_EXAMPLE "/scan.pcd");
  HeldScan held_;
  std::vector<std::byte> memory_;
  locate::Locator locator_;
  JobSearch search_{jobs_, locator_};
};

TEST_F(SearchedJob, FindsItsPart) {
  const job::ScanResult result = run(TickingClock(0));
  EXPECT_EQ(result.answer, Answer::kOk);
  EXPECT_EQ(result.match_count, 1);
}

TEST_F(SearchedJob, ThatRanOutOfTimeDoesNotCallTheSceneEmpty) {
  const std::int64_t second_us = 1'000'000;
  const job::ScanResult result = run(TickingClock(second_us));
  EXPECT_EQ(result.answer, Answer::kOutOfTime);
  EXPECT_EQ(result.match_count, 0);
}

// Of two pads the better one lies outside, and one match is wanted.
TEST_F(SearchedJob, GivesThePlaceOfAMatchOutsideToOneInside) {
  sim::SensorConfig sensor;
  sensor.columns = 400;
  sensor.rows = 333;
  sim::SceneConfig lone;
  lone.scene = "lone";
  const sim::SimulatedScan two = sim::simulate(lone, sensor, 3);
  held_.view = two.view();
  held_.up = port::Up::kPlusZ;
  set_up("max_matches = 2\n");
  const job::ScanResult all = run(TickingClock(0));
  ASSERT_EQ(all.match_count, 2);
  const double best_x_mm = all.matches[0].frame_T_pick.position_mm.x;
  const double other_x_mm = all.matches[1].frame_T_pick.position_mm.x;
  ASSERT_GT(std::fabs(best_x_mm - other_x_mm), 2.0);
  set_up("limit_x_mm = [" + std::to_string(other_x_mm - 1.0) + ", " +
         std::to_string(other_x_mm + 1.0) + "]\n");
  const job::ScanResult inside = run(TickingClock(0));
  EXPECT_EQ(inside.answer, Answer::kOk);
  ASSERT_EQ(inside.match_count, 1);
  EXPECT_NEAR(inside.matches[0].frame_T_pick.position_mm.x, other_x_mm, 1e-9);
}

}  // namespace
}  // namespace flatpose::daemon
