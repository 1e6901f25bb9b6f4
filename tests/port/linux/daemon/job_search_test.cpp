// A job run in a scan by itself, on a clock of the test's.

#include "port/linux/daemon/job_search.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "port/linux/files/scan.hpp"
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

/// A pad to be found, and nothing in the way.
class SearchedJob : public testing::Test {
 protected:
  SearchedJob() : jobs_(load_jobs(config_)) {
    const Status status = locator_.init(config_.search.limits, memory_);
    EXPECT_EQ(status, Status::kOk);
    held_.view = scan_.view();
    held_.up = scan_.up;
  }
  job::ScanResult run(const Clock& clock) {
    job::Order order;
    order.kind = job::Order::Kind::kStart;
    order.job = 1;
    order.answer_by_us = INT64_MAX;
    return search_.run(order, held_, Host(clock));
  }

  port::TemporaryFolder folder_;
  Config config_ = load_config(
      folder_.write("f.toml",
                    "[search]\nscan_width_px = 400\nscan_height_px = 333\ncell_count = 600_000\n"
                    "[[part]]\nname = \"pad\"\nfile = \"" FLATPOSE_EXAMPLE
                    "/pad.fpt\"\n[[job]]\nparts = [\"pad\"]\n"));
  JobSet jobs_;
  port::Scan scan_ = port::read_scan(FLATPOSE_EXAMPLE "/scan.pcd");
  HeldScan held_;
  std::vector<std::byte> memory_ =
      std::vector<std::byte>(locate::Locator::required_bytes(config_.search.limits));
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

}  // namespace
}  // namespace flatpose::daemon
