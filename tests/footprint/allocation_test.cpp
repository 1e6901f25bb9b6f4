// Whole searches with malloc interposed: after init nothing allocates, on any thread, however the
// search ends.

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <limits>
#include <string>
#include <tuple>
#include <vector>

#include "flatpose/locate/locator.hpp"
#include "flatpose/model/template_file.hpp"
#include "flatpose/teach/teacher.hpp"
#include "port/linux/cpu/vector_path.hpp"
#include "port/linux/threads/worker_pool.hpp"
#include "port/sim/simulate.hpp"
#include "tests/lib/locate/allocation_guard.hpp"

namespace flatpose {
namespace {

using locate::LocateConfig;
using locate::LocateResult;
using locate::Outcome;
using test::AllocationGuard;

constexpr locate::Limits kLimits{300, 250, 400'000};

sim::SimulatedScan simulated(const char* scene, std::uint64_t seed) {
  sim::SensorConfig sensor;
  sensor.columns = kLimits.scan_width_px;
  sensor.rows = kLimits.scan_height_px;
  sim::SceneConfig config;
  config.scene = scene;
  config.part = "pad";
  return sim::simulate(config, sensor, seed);
}

/// Made once: the simulator allocates as it likes.
struct Scans {
  sim::SimulatedScan first = simulated("single", 9001);
  sim::SimulatedScan second = simulated("single", 9002);
  sim::SimulatedScan pile = simulated("pile", 7);
  sim::SimulatedScan absent = simulated("absent", 3);
  sim::SimulatedScan empty = simulated("empty", 3);
  sim::SimulatedScan poor = empty;
  sim::SimulatedScan broken = pile;
  sim::SimulatedScan wide = first;
  model::Template part;

  Scans() {
    for (float& value : poor.xyz_mm) value = std::numeric_limits<float>::quiet_NaN();
    broken.xyz_mm[50'000] = std::numeric_limits<float>::infinity();
    wide.width_px = 500;
    wide.height_px = 150;
    std::vector<std::byte> memory(teach::Teacher::required_bytes(kLimits));
    const teach::TeachScan scan{first.view(), frames_of_scan(true)};
    teach::Teacher teacher;
    teach::TeachReport report;
    EXPECT_EQ(teacher.init(kLimits, memory), Status::kOk);
    EXPECT_EQ(teacher.teach({&scan, 1}, {}, part, report), Status::kOk);
  }
  static const Scans& made() {
    static const Scans scans;
    return scans;
  }
};

/// Stands still for some looks, then is past every deadline.
class JumpingClock final : public Clock {
 public:
  explicit JumpingClock(int look_count) : looks_left_(look_count) {}
  [[nodiscard]] std::int64_t now_us() const noexcept override {
    return looks_left_-- > 0 ? 0 : std::int64_t{1} << 40;
  }

 private:
  mutable std::atomic<int> looks_left_;  // any thread may look
};

TEST(Allocations, TheGuardFires) {
  const AllocationGuard guard;
  EXPECT_EQ(guard.count(), 0);
  void* volatile raw = std::malloc(10);
  EXPECT_EQ(guard.count(), 1);
  std::free(raw);
  int* volatile made = new int(3);
  EXPECT_EQ(guard.count(), 2);
  delete made;
  void* volatile zeroed = std::calloc(3, 5);
  EXPECT_EQ(guard.count(), 3);
  zeroed = std::realloc(zeroed, 5000);
  EXPECT_GE(guard.count(), 4);
  std::free(zeroed);
}

TEST(Allocations, TheGuardFiresWhateverThreadAllocates) {
  port::WorkerPool workers(3);
  auto body = [](int) {
    void* volatile raw = std::malloc(10);
    std::free(raw);
  };
  const AllocationGuard guard;
  for_each_chunk(workers, 20, body);
  EXPECT_EQ(guard.count(), 20);
}

using PathAndThreads = std::tuple<VectorPath, int>;

class AllocationsOf : public testing::TestWithParam<PathAndThreads> {
 protected:
  void SetUp() override {
    if (std::get<0>(GetParam()) > port::best_vector_path()) GTEST_SKIP() << "not on this processor";
    limits_.vector_path = std::get<0>(GetParam());
    memory_.resize(teach::Teacher::required_bytes(limits_));
    (void)Scans::made();
  }

  /// Searches under the guard; the locator is made anew under it too.
  Status locate(const sim::SimulatedScan& scan, const LocateConfig& config,
                const Clock& clock = StoppedClock{}) {
    const RangeImageView view = scan.view();
    const AllocationGuard guard;
    locate::Locator locator;
    Status s = locate::Locator::required_bytes(limits_) <= memory_.size() ? Status::kOk
                                                                          : Status::kOutOfMemory;
    if (s == Status::kOk) s = locator.init(limits_, memory_);
    if (s == Status::kOk)
      s = locator.locate(Scans::made().part, view, frames_of_scan(true), config,
                         Host{clock, workers_}, result_);
    (void)locate::digest(result_);
    (void)to_string(s);
    (void)locate::to_string(result_.outcome);
    EXPECT_EQ(guard.count(), 0);
    return s;
  }

  locate::Limits limits_ = kLimits;
  std::vector<std::byte> memory_;
  port::WorkerPool workers_{std::get<1>(GetParam())};
  LocateResult result_;
};

TEST_P(AllocationsOf, LocateAreNoneHoweverItEnds) {
  const Scans& scans = Scans::made();
  LocateConfig many;
  many.max_matches = locate::kMatchCountMax;
  EXPECT_EQ(locate(scans.pile, many), Status::kOk);
  EXPECT_GT(result_.match_count, 0);
  EXPECT_EQ(locate(scans.absent, {}), Status::kOk);
  EXPECT_EQ(result_.outcome, Outcome::kNoMatch);
  EXPECT_EQ(locate(scans.empty, {}), Status::kOk);
  EXPECT_EQ(result_.outcome, Outcome::kEmptyScene);
  EXPECT_EQ(locate(scans.poor, {}), Status::kOk);
  EXPECT_EQ(result_.outcome, Outcome::kScanPoor);
}

TEST_P(AllocationsOf, LocateAreNoneWhereverADeadlineStrikes) {
  LocateConfig config;
  config.max_matches = 5;
  config.deadline_us = 1000;
  for (const int look_count : {1, 4, 8, 12, 30}) {
    EXPECT_EQ(locate(Scans::made().pile, config, JumpingClock(look_count)), Status::kOk);
    EXPECT_EQ(result_.outcome, Outcome::kDeadline) << look_count;
  }
}

TEST_P(AllocationsOf, LocateAreNoneWhenTheCallIsWrong) {
  const Scans& scans = Scans::made();
  LocateConfig bad;
  bad.max_matches = 0;
  EXPECT_EQ(locate(scans.pile, bad), Status::kInvalidArgument);
  EXPECT_EQ(locate(scans.broken, {}), Status::kNotFinite);
  EXPECT_EQ(locate(scans.wide, {}), Status::kTooLarge);
  memory_.resize(1000);
  EXPECT_EQ(locate(scans.pile, {}), Status::kOutOfMemory);
}

TEST_P(AllocationsOf, LocateAreNoneByTheOtherMethods) {
  LocateConfig config;
  config.method = rectify::Method::kBucket;
  EXPECT_EQ(locate(Scans::made().first, config), Status::kOk);
  EXPECT_EQ(result_.match_count, 1);
  config.method = rectify::Method::kPaint;
  config.use_height = config.use_directions = false;
  EXPECT_EQ(locate(Scans::made().first, config), Status::kOk);
}

TEST_P(AllocationsOf, TeachingAndTheTemplatesFileAreNone) {
  const Scans& scans = Scans::made();
  const teach::TeachScan both[] = {{scans.first.view(), frames_of_scan(true)},
                                   {scans.second.view(), frames_of_scan(true)}};
  const teach::TeachScan none{scans.empty.view(), frames_of_scan(true)};
  std::vector<std::byte> file(model::kTemplateFileBytesMax);
  model::Template part;
  model::Template again;
  teach::TeachReport report;
  const AllocationGuard guard;
  teach::Teacher teacher;
  const Status ready = teacher.init(limits_, memory_);
  const Status taught = teacher.teach(both, {}, part, report);
  const int scan_count = report.scan_count_used;
  const auto size_bytes = model::write_template(part, file);
  const Status read =
      size_bytes ? model::read_template({file.data(), *size_bytes}, again) : size_bytes.status();
  file[40] ^= std::byte{1};
  const Status broken = model::read_template(file, again);
  const Status nothing = teacher.teach({&none, 1}, {}, part, report);
  EXPECT_EQ(guard.count(), 0);
  EXPECT_EQ(ready, Status::kOk);
  EXPECT_EQ(taught, Status::kOk);
  EXPECT_EQ(scan_count, 2);
  EXPECT_EQ(read, Status::kOk);
  EXPECT_NE(broken, Status::kOk);
  EXPECT_NE(nothing, Status::kOk);
}

std::string name_of(const testing::TestParamInfo<PathAndThreads>& info) {
  const char* const paths[] = {"Portable", "Avx2", "Avx512"};
  return std::string(paths[static_cast<int>(std::get<0>(info.param))]) + "On" +
         std::to_string(std::get<1>(info.param));
}

INSTANTIATE_TEST_SUITE_P(Every, AllocationsOf,
                         testing::Combine(testing::Values(VectorPath::kPortable, VectorPath::kAvx2,
                                                          VectorPath::kAvx512),
                                          testing::Values(1, 3)),
                         name_of);

}  // namespace
}  // namespace flatpose
