// What the log says of an interface that goes down, off and back, and how seldom of one that does
// so all the time.

#include "port/linux/daemon/can_log.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace flatpose::daemon {
namespace {

using can::BusState;
using port::CanCondition;
using Lines = std::vector<std::string>;

constexpr std::int64_t kCalm_us = 200'000'000;

class Told {
 public:
  explicit Told(const CanCondition& start = {}) : log("can0", 10, start) {}

  /// Long after what was said before.
  std::string calmly(const CanCondition& fresh, bool is_there = true) {
    now_us += kCalm_us;
    std::string all;
    for (const std::string& line : log.lines(now_us, fresh, is_there)) all += line + "\n";
    EXPECT_TRUE(log.lines(now_us, fresh, is_there).empty()) << "once";
    return all;
  }

  CanLog log;
  std::int64_t now_us = 0;
};

bool begins(const std::string& text, const std::string& part) { return text.rfind(part, 0) == 0; }

TEST(CanLog, IsSilentOfWhatTheStartHasTold) {
  const CanCondition down{.bus = BusState::kOff, .is_down = true};
  EXPECT_EQ(Told(down).calmly(down), "");
  EXPECT_EQ(Told().calmly({}), "");
}

TEST(CanLog, TellsOfAnInterfaceThatIsDownOrGoneAndBack) {
  Told told;
  CanCondition at{.down_count = 1, .bus = BusState::kOff, .is_down = true};
  EXPECT_EQ(told.calmly(at), "warning: can0 is down: the CAN node waits for it\n");
  at = {.down_count = 1};
  EXPECT_EQ(told.calmly(at), "can0 is back\n");
  at = {.down_count = 2, .bus = BusState::kOff, .is_down = true};
  EXPECT_EQ(told.calmly(at, false), "warning: can0 is gone: the CAN node waits for it\n");
  at = {.down_count = 2, .carries_fd = true};
  EXPECT_EQ(told.calmly(at), "can0 is back: it carries FD frames now\n");
  at = {.down_count = 3};
  EXPECT_EQ(told.calmly(at),
            "can0 was down and is back: it is classic now, the FD frame stays out\n");
  at = {.down_count = 6};
  EXPECT_EQ(told.calmly(at), "can0 was down 3 times and is back\n");
}

TEST(CanLog, TellsOfBusOffAndOfTheRestartAlsoWhenNobodyLookedInBetween) {
  Told told;
  CanCondition at{.off_count = 1, .bus = BusState::kOff};
  EXPECT_TRUE(begins(told.calmly(at), "warning: can0 is bus-off: see wiring"));
  at.bus = BusState::kActive;
  EXPECT_EQ(told.calmly(at), "can0 is restarted\n");
  at.off_count = 2;
  EXPECT_EQ(told.calmly(at), "warning: can0 was bus-off and is restarted\n");
  at.off_count = 9;
  at.bus = BusState::kOff;
  EXPECT_TRUE(begins(told.calmly(at), "warning: can0 is bus-off, it was 7 times: see"));
  at.is_down = true;
  at.down_count = 1;
  EXPECT_EQ(told.calmly(at), "warning: can0 is down: the CAN node waits for it\n");
  at = {.down_count = 1, .off_count = 9};
  EXPECT_EQ(told.calmly(at), "can0 is back\n");
}

TEST(CanLog, TellsOfFailingFramesAndOfATwin) {
  Told told;
  CanCondition at{.bus = BusState::kErrorPassive};
  EXPECT_TRUE(begins(told.calmly(at), "warning: can0 is error passive: frames fail"));
  at.bus = BusState::kActive;
  EXPECT_EQ(told.calmly(at), "can0 is error active again\n");
  at.has_twin = true;
  EXPECT_EQ(told.calmly(at),
            "warning: another node 10 is on can0: give one of them another number\n");
  EXPECT_EQ(told.calmly(at), "");
}

TEST(CanLog, OfWhatChangesAllTheTimeSpeaksLessAndLessOftenAndThenOfTheNewest) {
  Told told;
  CanCondition at;
  std::vector<std::int64_t> said_us;
  for (int i = 0; i < 7200; ++i, told.now_us += 500'000) {  // an hour, bus-off five times a second
    at.off_count = static_cast<std::uint16_t>(at.off_count + 2);
    const Lines lines = told.log.lines(told.now_us, at, true);
    EXPECT_LE(lines.size(), 1U);
    if (!lines.empty()) said_us.push_back(told.now_us);
  }
  ASSERT_GT(said_us.size(), 8U);
  EXPECT_LT(said_us.size(), 70U);
  EXPECT_EQ(said_us[0], 0) << "the first at once";
  for (std::size_t i = 1; i < said_us.size(); ++i) {
    const std::int64_t pause_us = said_us[i] - said_us[i - 1];
    EXPECT_EQ(pause_us, std::min(CanLog::kPause_us << std::min<std::size_t>(i - 1, 6),
                                 CanLog::kPauseMost_us));
  }
  at.off_count = static_cast<std::uint16_t>(at.off_count + 1);
  EXPECT_NE(told.calmly(at), "") << "what was not said is said later";
  at.is_down = true;
  ++at.down_count;
  EXPECT_NE(told.calmly(at), "");
  at.is_down = false;
  told.now_us += CanLog::kPause_us;
  EXPECT_EQ(told.log.lines(told.now_us, at, true), Lines{"can0 is back"}) << "after a calm time";
}

}  // namespace
}  // namespace flatpose::daemon
