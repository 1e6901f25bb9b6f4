// A controller's clock that starts anywhere, drifts, starts again, stands still; and interrupts
// that take their time.

#include "port/linux/can/hardware_clock.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

namespace flatpose::port {
namespace {

constexpr std::int64_t kSecond_us = 1'000'000;
constexpr std::int64_t kQuickest_us = 20;

struct Frame {
  std::int64_t arrived_us = 0;
  std::int64_t hardware_us = 0;
  std::int64_t software_us = 0;
};

/// Frames some milliseconds apart, most interrupts quick, one in twenty slow.
std::vector<Frame> frames(std::uint32_t seed, double drift_ppm, int count,
                          std::int64_t start_us = 5 * kSecond_us) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<std::int64_t> gap(50, 20'000), quick(kQuickest_us, 200),
      slow(1'000, 40'000), twenty(0, 19);
  std::vector<Frame> made;
  std::int64_t now_us = 1'000 * kSecond_us;
  std::int64_t last_us = 0;
  for (int i = 0; i < count; ++i) {
    now_us += gap(random);
    const auto since = static_cast<double>(now_us - 1'000 * kSecond_us);
    const auto hardware_us =
        start_us + static_cast<std::int64_t>(std::floor(since * (1 + drift_ppm * 1e-6)));
    const std::int64_t delay_us = twenty(random) == 0 ? slow(random) : quick(random);
    last_us = std::max(last_us, now_us + delay_us);  // one interrupt after the other
    made.push_back({now_us, hardware_us, last_us});
  }
  return made;
}

TEST(HardwareClock, TakesTheInterruptsDelayOutWhateverTheDrift) {
  for (const double drift_ppm : {0.0, 20.0, -20.0, 100.0, -100.0}) {
    HardwareClock clock;
    std::int64_t begun_us = -1;
    double sum_us = 0, plain_us = 0;
    int count = 0;
    for (const Frame& frame : frames(1, drift_ppm, 5000)) {
      const std::int64_t got_us = clock.arrived_us(frame.hardware_us, frame.software_us);
      EXPECT_LE(got_us, frame.software_us);
      if (begun_us < 0) begun_us = frame.arrived_us;
      if (frame.arrived_us - begun_us < kSecond_us) continue;
      EXPECT_GE(got_us, frame.arrived_us - 205 - 1) << drift_ppm;
      EXPECT_LE(got_us, frame.arrived_us + 200 + 205) << drift_ppm;
      sum_us += std::abs(static_cast<double>(got_us - frame.arrived_us));
      plain_us += std::abs(static_cast<double>(frame.software_us - frame.arrived_us));
      ++count;
    }
    EXPECT_LT(sum_us / count, 210) << drift_ppm;
    EXPECT_GT(plain_us / count, 700) << "what software stamps alone are off by";
  }
}

TEST(HardwareClock, OfAGoodClockErrsByNoMoreThanTheQuickestInterrupt) {
  HardwareClock clock;
  const auto all = frames(2, 0.0, 4000);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::int64_t got_us = clock.arrived_us(all[i].hardware_us, all[i].software_us);
    EXPECT_GE(got_us, all[i].arrived_us);
    if (i > 300) {
      EXPECT_LE(got_us, all[i].arrived_us + kQuickest_us + 10);
    }
  }
}

TEST(HardwareClock, ThatStartsAgainIsLearntAnew) {
  for (const std::int64_t jump_us :
       {std::int64_t{3'600} * kSecond_us, kSecond_us / 5, std::int64_t{1} << 32, -kSecond_us / 5,
        std::int64_t{-3'600} * kSecond_us}) {
    HardwareClock clock;
    auto all = frames(3, 30.0, 3000, 8'000 * kSecond_us);
    for (std::size_t i = 1500; i < all.size(); ++i) all[i].hardware_us -= jump_us;
    int after = 0;
    for (const Frame& frame : all) {
      const std::int64_t got_us = clock.arrived_us(frame.hardware_us, frame.software_us);
      EXPECT_LE(got_us, frame.software_us);
      EXPECT_GE(got_us, frame.arrived_us - 205) << jump_us;
      if (&frame - all.data() > 1900) {
        EXPECT_LE(got_us, frame.arrived_us + 405) << jump_us;
        ++after;
      }
    }
    EXPECT_GT(after, 1000);
  }
}

// It stood for a while on a quiet bus: later than the last stamp, and yet all too early.
TEST(HardwareClock, ThatLosesTimeIsLearntAnew) {
  HardwareClock clock;
  auto all = frames(6, 0.0, 2000);
  for (std::size_t i = 1000; i < all.size(); ++i) {
    all[i].arrived_us += 500'000;
    all[i].software_us += 500'000;
    all[i].hardware_us += 300'000;
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::int64_t got_us = clock.arrived_us(all[i].hardware_us, all[i].software_us);
    EXPECT_GE(got_us, all[i].arrived_us) << i;
    if (i > 1300) {
      EXPECT_LE(got_us, all[i].arrived_us + 60) << i;
    }
  }
}

TEST(HardwareClock, ThatStandsStillOrHasNoStampIsNotUsed) {
  for (const std::int64_t stuck_us :
       {std::int64_t{77}, std::int64_t{0}, std::int64_t{-5}, std::int64_t{1} << 62}) {
    HardwareClock clock;
    for (const Frame& frame : frames(4, 0.0, 500))
      EXPECT_EQ(clock.arrived_us(stuck_us, frame.software_us), frame.software_us);
  }
}

TEST(HardwareClock, StampsThatNoClockHasAreNotUsed) {
  HardwareClock clock;
  constexpr std::int64_t kLeast = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  for (const std::int64_t odd_us :
       {kLeast, kLeast + 7, std::int64_t{-1}, kMost - 1, kMost, kMost / 2, kLeast / 2})
    EXPECT_EQ(clock.arrived_us(odd_us, 5'000'000), 5'000'000);
}

TEST(HardwareClock, FramesWithoutAStampAmongOthersDoNotDisturb) {
  HardwareClock clock;
  const auto all = frames(5, 0.0, 2000);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i % 3 == 0) {
      EXPECT_EQ(clock.arrived_us(0, all[i].software_us), all[i].software_us);
      continue;
    }
    const std::int64_t got_us = clock.arrived_us(all[i].hardware_us, all[i].software_us);
    if (i > 600) {
      EXPECT_LE(got_us, all[i].arrived_us + 60);
    }
  }
}

TEST(HardwareClock, WhatIsLongAgoIsForgotten) {
  HardwareClock clock;
  EXPECT_EQ(clock.arrived_us(1'000, 50'000'000), 50'000'000);
  // 100 ppm slow for an hour: 360 ms, by small steps of a quiet bus
  for (std::int64_t i = 1; i <= 1'200; ++i) {
    const std::int64_t now_us = 50'000'000 + i * 3 * kSecond_us;
    const std::int64_t hardware_us = 1'000 + i * 3 * kSecond_us - i * 300;
    EXPECT_EQ(clock.arrived_us(hardware_us, now_us), now_us) << i;
  }
}

}  // namespace
}  // namespace flatpose::port
