// When a frame arrived, by stamps of a clock that anybody may set.

#include "port/linux/can/arrival_clock.hpp"

#include <gtest/gtest.h>

namespace flatpose::port {
namespace {

constexpr std::int64_t kReal_us = 1'700'000'000'000'000;
constexpr std::int64_t kSecond_us = 1'000'000;

TEST(ArrivalClock, IsAsLongAgoAsTheStampIsOld) {
  ArrivalClock clock;
  clock.look(5'000'000, kReal_us);
  for (const std::int64_t age_us : {0, 1, 999, 20'000, 3'000'000})
    EXPECT_EQ(clock.arrived_us({kReal_us - age_us, 0}), 5'000'000 - age_us);
}

TEST(ArrivalClock, IsNowWithoutAStampAndNeverLaterNorVeryLongAgo) {
  ArrivalClock clock;
  clock.look(50'000'000, kReal_us);
  EXPECT_EQ(clock.arrived_us({}), 50'000'000);
  EXPECT_EQ(clock.arrived_us({kReal_us + 700, 0}), 50'000'000);
  EXPECT_EQ(clock.arrived_us({1, 0}), 40'000'000);
}

// Ten frames wait, a tenth of a second apart; before one of them the clock is set.
TEST(ArrivalClock, ThatWasSetWhileFramesWaitedTellsWhenTheyCame) {
  for (const std::int64_t step_us : {3'600 * kSecond_us, -3'600 * kSecond_us, 20 * kSecond_us}) {
    for (std::int64_t set_before = 0; set_before <= 10; ++set_before) {
      ArrivalClock clock;
      clock.look(5'000'000, kReal_us + 5'000'000);
      clock.drained();
      clock.look(5'000'100, kReal_us + 5'000'100);
      for (std::int64_t i = 0; i < 10; ++i) {
        const std::int64_t arrived_us = 5'100'000 + i * 100'000;
        const std::int64_t read_us = 6'200'000 + i * 50;
        clock.look(read_us, kReal_us + read_us + step_us);
        const std::int64_t stamp_us = kReal_us + arrived_us + (i >= set_before ? step_us : 0);
        EXPECT_EQ(clock.arrived_us({stamp_us, 0}), arrived_us) << step_us << ", " << set_before;
      }
      clock.drained();
      clock.look(6'300'000, kReal_us + 6'300'000 + step_us);
      EXPECT_EQ(clock.arrived_us({kReal_us + 6'299'990 + step_us, 0}), 6'299'990);
    }
  }
}

TEST(ArrivalClock, WhereBothFitItIsTheLaterAndWhereNoneDoesItIsNow) {
  ArrivalClock clock;
  clock.look(5'000'000, kReal_us + 5'000'000);
  clock.drained();
  clock.look(6'000'000, kReal_us + 6'000'000 - 300'000);
  EXPECT_EQ(clock.arrived_us({kReal_us + 4'600'000, 0}), 6'000'000) << "before all was read";
  clock.drained();
  clock.look(6'000'000, kReal_us + 5'700'000);
  clock.look(7'000'000, kReal_us + 6'400'000);
  EXPECT_EQ(clock.arrived_us({kReal_us + 5'800'000, 0}), 6'400'000) << "or 6.1 s";
  EXPECT_EQ(clock.arrived_us({kReal_us + 5'700'001, 0}), 7'000'000) << "before the last";
  EXPECT_EQ(clock.arrived_us({kReal_us + 99'000'000, 0}), 7'000'000);
  EXPECT_EQ(clock.arrived_us({}), 7'000'000);
}

TEST(ArrivalClock, ThatWasSetTwiceSaysNowToWhatCameBetween) {
  ArrivalClock clock;
  clock.look(5'000'000, kReal_us);
  clock.drained();
  clock.look(5'100'000, kReal_us + 60 * kSecond_us);
  clock.look(5'200'000, kReal_us - 60 * kSecond_us);
  EXPECT_EQ(clock.arrived_us({kReal_us + 50'000, 0}), 5'050'000);
  EXPECT_EQ(clock.arrived_us({kReal_us + 60 * kSecond_us + 50'000, 0}), 5'200'000);
}

TEST(ArrivalClock, ThatWasSetWhileTheQueueWasFoundEmptyIsStillFoundOut) {
  ArrivalClock clock;
  clock.look(5'000'000, kReal_us);
  clock.drained();
  clock.look(5'000'100, kReal_us + 100 - 60 * kSecond_us);
  EXPECT_EQ(clock.arrived_us({kReal_us + 50, 0}), 5'000'050);
}

TEST(ArrivalClock, StandsAClockThatIsSlewed) {
  ArrivalClock clock;
  for (std::int64_t i = 0; i < 7'200; ++i) {  // an hour, 500 ppm, looked at twice a second
    const std::int64_t now_us = i * 500'000;
    const std::int64_t real_us = kReal_us + i * 500'250;
    clock.look(now_us, real_us);
    ASSERT_EQ(clock.arrived_us({real_us - 40, 0}), now_us - 40);
  }
}

TEST(ArrivalClock, TakesTheControllersStampWhereThereIsOne) {
  ArrivalClock clock;
  for (std::int64_t i = 1; i <= 100; ++i) {
    const std::int64_t arrived_us = i * 10'000;
    const std::int64_t delay_us = i % 7 == 1 ? 30 : 30 + 100 * (i % 5);
    const std::int64_t read_us = arrived_us + delay_us + 2'000;
    clock.look(read_us, kReal_us + read_us);
    const std::int64_t got_us =
        clock.arrived_us({kReal_us + arrived_us + delay_us, 42 + arrived_us});
    EXPECT_EQ(got_us, arrived_us + 30) << i;
  }
}

}  // namespace
}  // namespace flatpose::port
