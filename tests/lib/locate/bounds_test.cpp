// Limits, memory, bad input, time, repeatability, and that nothing is ever allocated.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>
#include <vector>

#include "flatpose/rectify/survey.hpp"
#include "tests/lib/locate/allocation_guard.hpp"
#include "tests/lib/locate/made_bin.hpp"
#include "tests/lib/locate/simulated.hpp"

namespace flatpose::locate {
namespace {

using test::Locating;
using test::MadeScan;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

MadeScan three() { return test::bin_scan(test::three_blocks()); }

TEST(Limits, AScanBeyondThemIsTooLarge) {
  const MadeScan scan = three();
  Locating narrow({149, 120, 100'000});
  EXPECT_EQ(narrow.run(test::block_part(), scan.view()), Status::kTooLarge);
  Locating low({150, 119, 100'000});
  EXPECT_EQ(low.run(test::block_part(), scan.view()), Status::kTooLarge);
  Locating exact({150, 120, 100'000});
  EXPECT_EQ(exact.run(test::block_part(), scan.view()), Status::kOk);
}

TEST(Limits, AFieldBeyondThemIsTooLarge) {
  MadeScan scan = three();
  Locating few({150, 120, 150 * 119});
  EXPECT_EQ(few.run(test::block_part(), scan.view()), Status::kTooLarge);
  // One point far away makes the field large.
  Locating locating({150, 120, 30'000});
  EXPECT_EQ(locating.run(test::block_part(), scan.view()), Status::kOk);
  scan.at(149, 119)[0] = 5000.0F;
  EXPECT_EQ(locating.run(test::block_part(), scan.view()), Status::kTooLarge);
  EXPECT_EQ(locating.result.match_count, 0);
}

TEST(Limits, BadOnesAreRefused) {
  std::vector<std::byte> memory(1000);
  for (const Limits& limits :
       {Limits{0, 10, 10}, Limits{10, 0, 10}, Limits{10, 10, 0}, Limits{-5, 10, 10},
        Limits{10, 10, -1}, Limits{1 << 20, 10, 10}, Limits{10, 10, 2'000'000'000}}) {
    Locator locator;
    EXPECT_EQ(locator.init(limits, memory), Status::kInvalidArgument);
  }
}

TEST(Memory, OneByteLessIsRefused) {
  const Limits limits{150, 120, 30'000};
  std::vector<std::byte> memory(Locator::required_bytes(limits));
  Locator locator;
  EXPECT_EQ(locator.init(limits, std::span(memory).first(memory.size() - 1)), Status::kOutOfMemory);
  EXPECT_EQ(locator.init(limits, memory), Status::kOk);
}

TEST(Memory, ALocatorWithoutAnyReportsIt) {
  Locator locator;
  const MadeScan scan = three();
  LocateResult result;
  EXPECT_EQ(locator.locate(test::block_part(), scan.view(), frames_of_scan(true), {},
                           StoppedClock{}, result),
            Status::kOutOfMemory);
}

TEST(Memory, GrowsWithTheLimits) {
  const std::size_t small = Locator::required_bytes({150, 120, 30'000});
  EXPECT_LT(small, Locator::required_bytes({150, 120, 300'000}));
  EXPECT_LE(small, Locator::required_bytes({1500, 1200, 30'000}));
}

/// A pattern of blocks over a field of any shape.
MadeScan striped(int width_px, int height_px) {
  return {width_px, height_px, 1.0,
          [](double x, double y) {
            const bool block = std::fmod(x, 70.0) < 50.0 && std::fmod(y, 45.0) < 30.0;
            return block ? 10.0 : 0.0;
          },
          0.05};
}

TEST(Memory, SufficesForEveryShapeWithinTheLimits) {
  const model::Template part = test::block_part();
  const struct {
    int width_px, height_px;
  } shapes[] = {{2, 2},     {3, 300},   {300, 3},   {1, 200},  {200, 1},  {4000, 12},
                {12, 4000}, {257, 193}, {193, 257}, {65, 700}, {129, 400}};
  for (const auto& shape : shapes) {
    const MadeScan scan = striped(shape.width_px, shape.height_px);
    for (const double cell_mm : {1.0, 0.75}) {
      // As many cells as this field takes and not one more.
      rectify::Survey box;
      box.valid_count = 1;
      box.max_mm = {shape.width_px - 1.0, shape.height_px - 1.0, 10.0};
      rectify::GridConfig grid_config;
      grid_config.cell_mm = cell_mm;
      const auto grid = rectify::choose_grid(box, grid_config);
      ASSERT_TRUE(grid);
      const Limits limits{std::max(2, shape.width_px), std::max(2, shape.height_px),
                          grid->width_px * grid->height_px};
      const std::size_t required = Locator::required_bytes(limits);
      // At an address that is as badly aligned as can be.
      const auto memory = std::make_unique<std::byte[]>(required + 1);
      Locator locator;
      ASSERT_EQ(locator.init(limits, std::span(memory.get() + 1, required)), Status::kOk);
      for (const auto method : {rectify::Method::kPaint, rectify::Method::kBucket}) {
        LocateConfig config;
        config.method = method;
        config.cell_mm = cell_mm;
        config.max_matches = kMatchCountMax;
        LocateResult result;
        const Status s =
            locator.locate(part, scan.view(), frames_of_scan(true), config, StoppedClock{}, result);
        EXPECT_NE(s, Status::kOutOfMemory) << shape.width_px << " " << shape.height_px;
        EXPECT_TRUE(s == Status::kOk || s == Status::kTooLarge) << to_string(s);
        EXPECT_LE(result.peak_bytes, required);
      }
    }
  }
}

TEST(BadInput, CoordinatesThatAreNotFiniteAreRefused) {
  for (const float bad : {static_cast<float>(kInfinity), -static_cast<float>(kInfinity), 1e30F}) {
    for (int axis = 0; axis < 3; ++axis) {
      MadeScan scan = three();
      scan.at(77, 66)[axis] = bad;
      Locating locating;
      EXPECT_EQ(locating.run(test::block_part(), scan.view()), Status::kNotFinite) << bad;
      EXPECT_EQ(locating.result.match_count, 0);
    }
  }
}

TEST(BadInput, ALocatorIsAsGoodAsNewAfterIt) {
  const MadeScan scan = three();
  MadeScan broken = three();
  broken.at(5, 5)[2] = static_cast<float>(kInfinity);
  Locating locating;
  ASSERT_EQ(locating.run(test::block_part(), scan.view()), Status::kOk);
  const std::uint64_t before = digest(locating.result);
  ASSERT_EQ(locating.run(test::block_part(), broken.view()), Status::kNotFinite);
  ASSERT_EQ(locating.run(test::block_part(), scan.view()), Status::kOk);
  EXPECT_EQ(digest(locating.result), before);
}

TEST(BadInput, ConfigsOutsideTheirRangeAreRefused) {
  const MadeScan scan = three();
  Locating locating;
  const auto status_of = [&](auto&& change) {
    LocateConfig config;
    change(config);
    return locating.run(test::block_part(), scan.view(), config);
  };
  const std::vector<void (*)(LocateConfig&)> bad{
      [](LocateConfig& c) { c.max_matches = 0; },
      [](LocateConfig& c) { c.max_matches = kMatchCountMax + 1; },
      [](LocateConfig& c) { c.min_score = 1.01; },
      [](LocateConfig& c) { c.min_score = kNan; },
      [](LocateConfig& c) { c.min_visible = -0.01; },
      [](LocateConfig& c) { c.min_visible = 1.01; },
      [](LocateConfig& c) { c.min_visible = kNan; },
      [](LocateConfig& c) { c.max_tilt_rad = -0.1; },
      [](LocateConfig& c) { c.max_tilt_rad = 1.3; },
      [](LocateConfig& c) { c.max_tilt_rad = kNan; },
      [](LocateConfig& c) { c.cell_mm = -1.0; },
      [](LocateConfig& c) { c.cell_mm = kInfinity; },
      [](LocateConfig& c) { c.cell_mm = kNan; },
      [](LocateConfig& c) { c.deadline_us = -1; },
      [](LocateConfig& c) { c.region.kind = Region::Kind::kCircle; },
      [](LocateConfig& c) {
        c.region.kind = Region::Kind::kCircle;
        c.region.radius_mm = kNan;
      },
      [](LocateConfig& c) { c.region.kind = Region::Kind::kPolygon; },
  };
  for (std::size_t i = 0; i < bad.size(); ++i) {
    EXPECT_EQ(status_of(bad[i]), Status::kInvalidArgument) << i;
  }
  EXPECT_EQ(status_of([](LocateConfig&) {}), Status::kOk);
}

TEST(BadInput, TemplatesThatHoldNoPartAreRefused) {
  const MadeScan scan = three();
  Locating locating;
  EXPECT_EQ(locating.run(model::Template{}, scan.view()), Status::kInvalidArgument);
  const std::vector<void (*)(model::Template&)> bad{
      [](model::Template& t) { t.contour_count = -1; },
      [](model::Template& t) { t.contour_count = model::kContourPointCountMax + 1; },
      [](model::Template& t) { t.surface_count = 1000; },
      [](model::Template& t) { t.anchor_count = 0; },
      [](model::Template& t) { t.cell_mm = 0.0; },
      [](model::Template& t) { t.pitch_mm = kNan; },
      [](model::Template& t) { t.radius_mm = kInfinity; },
      [](model::Template& t) { t.contour[0].x_mm = static_cast<float>(kNan); },
      [](model::Template& t) { t.surface[3].nx = 3.0F; },
      [](model::Template& t) { t.symmetry.order = -2; },
      [](model::Template& t) { t.scan_T_object.rotation.m[0] = 2.0; },
  };
  for (std::size_t i = 0; i < bad.size(); ++i) {
    model::Template part = test::block_part();
    bad[i](part);
    EXPECT_EQ(locating.run(part, scan.view()), Status::kInvalidArgument) << i;
  }
}

/// A millisecond later at every look.
class TickingClock final : public Clock {
 public:
  [[nodiscard]] std::int64_t now_us() const noexcept override { return time_us_ += 1000; }

 private:
  mutable std::int64_t time_us_ = 0;
};

TEST(Timings, StagesAddUpToNoMoreThanTheWhole) {
  const MadeScan scan = three();
  Locating locating;
  ASSERT_EQ(locating.run(test::block_part(), scan.view(), {}, TickingClock{}), Status::kOk);
  const Timings& t = locating.result.timings;
  const std::int64_t stages_us[] = {t.rectify_us, t.features_us, t.search_us, t.refine_us,
                                    t.verify_us};
  std::int64_t sum_us = 0;
  for (const std::int64_t stage_us : stages_us) {
    EXPECT_GT(stage_us, 0);
    sum_us += stage_us;
  }
  EXPECT_LE(sum_us, t.total_us);
}

TEST(Digest, IsTheSameForTheSameScanWhereverTheMemoryLies) {
  const MadeScan scan = three();
  LocateConfig config;
  config.max_matches = 5;
  Locating locating;
  ASSERT_EQ(locating.run(test::block_part(), scan.view(), config), Status::kOk);
  const std::uint64_t first = digest(locating.result);
  ASSERT_EQ(locating.run(test::block_part(), scan.view(), config), Status::kOk);
  EXPECT_EQ(digest(locating.result), first);
  // What another search left in the memory does not matter.
  ASSERT_EQ(locating.run(test::block_part(), striped(290, 200).view(), config), Status::kOk);
  EXPECT_NE(digest(locating.result), first);
  ASSERT_EQ(locating.run(test::block_part(), scan.view(), config), Status::kOk);
  EXPECT_EQ(digest(locating.result), first);
  // Nor where the memory is, how much, or what it holds.
  const Limits limits{640, 480, 700'000};
  std::vector<std::byte> memory(Locator::required_bytes(limits) + 37, std::byte{0xA5});
  Locator other;
  ASSERT_EQ(other.init(limits, std::span(memory).subspan(37)), Status::kOk);
  LocateResult result;
  ASSERT_EQ(other.locate(test::block_part(), scan.view(), frames_of_scan(true), config,
                         StoppedClock{}, result),
            Status::kOk);
  EXPECT_EQ(digest(result), first);
}

TEST(Digest, TellsResultsApartButNotTimings) {
  const MadeScan scan = three();
  Locating locating;
  ASSERT_EQ(locating.run(test::block_part(), scan.view()), Status::kOk);
  const LocateResult result = locating.result;
  LocateResult other = result;
  other.timings.total_us += 5;
  other.peak_bytes += 5;
  other.candidate_count += 5;
  EXPECT_EQ(digest(other), digest(result));
  const auto changed = [&](auto&& change) {
    LocateResult copy = result;
    change(copy);
    return digest(copy) != digest(result);
  };
  EXPECT_TRUE(changed([](LocateResult& r) { r.outcome = Outcome::kAmbiguous; }));
  EXPECT_TRUE(changed([](LocateResult& r) { r.match_count = 0; }));
  EXPECT_TRUE(changed([](LocateResult& r) { r.matches[0].score += 1e-12; }));
  EXPECT_TRUE(changed([](LocateResult& r) { r.matches[0].face_T_object.position_mm.y += 1e-9; }));
  EXPECT_TRUE(changed([](LocateResult& r) { r.matches[0].face_T_object.rotation.m[3] += 1e-9; }));
  EXPECT_TRUE(changed([](LocateResult& r) { r.matches[0].sigma_mm.z += 1e-9; }));
}

TEST(Allocation, TheGuardFires) {
  const test::AllocationGuard guard;
  EXPECT_EQ(guard.count(), 0);
  void* volatile raw = std::malloc(10);
  EXPECT_GE(guard.count(), 1);
  std::free(raw);
  const test::AllocationGuard again;
  const std::unique_ptr<std::vector<int>> made = std::make_unique<std::vector<int>>(10);
  EXPECT_GE(again.count(), 2);
  EXPECT_EQ(made->size(), 10U);
  const test::AllocationGuard aligned;
  void* volatile wide = ::operator new (128, std::align_val_t{64});
  EXPECT_GE(aligned.count(), 1);
  ::operator delete (wide, std::align_val_t{64});
}

TEST(Allocation, LocateNeverAllocates) {
  const MadeScan scan = three();
  const MadeScan nothing(150, 120, 1.0, [](double, double) { return test::kLost; });
  const model::Template part = test::block_part();
  const Limits limits = test::small_limits();
  std::vector<std::byte> memory(Locator::required_bytes(limits));
  const Frames frames = frames_of_scan(true);
  LocateResult result;
  long count = -1;
  {
    const test::AllocationGuard guard;
    Locator locator;
    (void)Locator::required_bytes(limits);
    (void)locator.init(limits, memory);
    for (const auto method : {rectify::Method::kPaint, rectify::Method::kBucket}) {
      LocateConfig config;
      config.max_matches = 8;
      config.method = method;
      (void)locator.locate(part, nothing.view(), frames, config, StoppedClock{}, result);
      (void)locator.locate(part, scan.view(), frames, config, StoppedClock{}, result);
      (void)digest(result);
    }
    count = guard.count();
  }
  EXPECT_EQ(count, 0);
  EXPECT_EQ(result.match_count, 3);
}

TEST(Outcomes, HaveTheirNamesAndNumbers) {
  EXPECT_STREQ(to_string(Outcome::kOk), "ok");
  EXPECT_STREQ(to_string(Outcome::kAmbiguous), "ambiguous");
  EXPECT_STREQ(to_string(Outcome::kDeadline), "deadline");
  EXPECT_STREQ(to_string(Outcome::kNoMatch), "no_match");
  EXPECT_STREQ(to_string(Outcome::kEmptyScene), "empty_scene");
  EXPECT_STREQ(to_string(Outcome::kScanPoor), "scan_poor");
  EXPECT_STREQ(to_string(Outcome::kCancelled), "cancelled");
  for (const Outcome usable : {Outcome::kAmbiguous, Outcome::kDeadline})
    EXPECT_GT(static_cast<int>(usable), 0);
  for (const Outcome none : {Outcome::kNoMatch, Outcome::kEmptyScene, Outcome::kScanPoor})
    EXPECT_LT(static_cast<int>(none), 0);
}

}  // namespace
}  // namespace flatpose::locate
