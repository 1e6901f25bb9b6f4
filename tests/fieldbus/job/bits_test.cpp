// The four-phase handshake, for masters that know bits only.

#include "tests/fieldbus/job/desk.hpp"

namespace flatpose::job {
namespace {

struct BitsDesk : Desk {
  BitsDesk() : Desk(Config{.session_id = 321, .handshake = Handshake::kBits}) {
    live();
    control(0);
  }
};

TEST(BitsHandshake, RunsThroughItsFourPhasesAgainAndAgain) {
  BitsDesk desk;
  for (std::uint16_t round = 1; round <= 3; ++round) {
    EXPECT_TRUE(desk.has(kReady));
    desk.control(kTrigger);
    EXPECT_TRUE(desk.has(kAck) && desk.has(kBusy));
    EXPECT_FALSE(desk.has(kReady) || desk.has(kDone) || desk.has(kValid));
    desk.control(0);
    EXPECT_FALSE(desk.has(kAck));
    desk.finish(desk.found());
    EXPECT_TRUE(desk.has(kDone) && desk.has(kValid));
    EXPECT_FALSE(desk.has(kReady));
    EXPECT_EQ(desk.see().done_number, round);
    desk.control(kResultRead);
    EXPECT_FALSE(desk.has(kDone));
    desk.control(0);
  }
}

TEST(BitsHandshake, ATriggerLeftHighStartsNothing) {
  Desk desk(Config{.handshake = Handshake::kBits});
  desk.live();
  desk.control(kTrigger);  // the first thing seen: no edge
  EXPECT_FALSE(desk.has(kBusy) || desk.has(kAck));
  desk.control(kTrigger);
  EXPECT_FALSE(desk.has(kBusy));
  desk.control(0);
  desk.control(kTrigger);
  EXPECT_TRUE(desk.has(kBusy));
  desk.pass(5 * kSecond_us);
  desk.live();
  desk.control(kTrigger, kBob);  // another master: its own low must be seen
  EXPECT_FALSE(desk.has(kBusy));
  desk.control(0, kBob);
  desk.control(kTrigger, kBob);
  EXPECT_TRUE(desk.has(kBusy));
}

TEST(BitsHandshake, AHeldTriggerRunsOnce) {
  BitsDesk desk;
  for (int i = 0; i < 5; ++i) desk.control(kTrigger);
  desk.finish(desk.found());
  for (int i = 0; i < 5; ++i) desk.control(kTrigger);
  EXPECT_FALSE(desk.has(kBusy));
  EXPECT_EQ(desk.see().last_number, 1);
}

TEST(BitsHandshake, ATriggerWhileBusyIsRefusedWithoutAck) {
  BitsDesk desk;
  desk.control(kTrigger);
  desk.control(0);
  desk.control(kTrigger);
  EXPECT_FALSE(desk.has(kAck));
  EXPECT_TRUE(desk.has(kError) && desk.has(kBusy));
  EXPECT_EQ(desk.see().refused_status, Refusal::kBusy);
  desk.finish(desk.found());
  EXPECT_EQ(desk.see().done_number, 1);
}

TEST(BitsHandshake, ATriggerBeforeTheResultWasReadIsNoDeadEnd) {
  BitsDesk desk;
  desk.control(kTrigger);
  desk.control(0);
  desk.finish(desk.found());
  desk.control(kTrigger);
  EXPECT_TRUE(desk.has(kBusy) && desk.has(kAck));
  EXPECT_FALSE(desk.has(kDone));
}

TEST(Handshake, IsNeverBothWaysAtOnce) {
  BitsDesk by_bits;
  EXPECT_EQ(by_bits.write(1), Verdict::kBadValue);
  EXPECT_FALSE(by_bits.has(kBusy));
  EXPECT_EQ(by_bits.write(std::uint16_t{0}), Verdict::kGranted);
  Desk by_number;
  by_number.live();
  EXPECT_EQ(by_number.control(kTrigger), Verdict::kBadValue);
  EXPECT_EQ(by_number.control(kResultRead), Verdict::kBadValue);
  EXPECT_EQ(by_number.control(0), Verdict::kGranted);
  EXPECT_FALSE(by_number.has(kBusy));
}

TEST(BitsHandshake, NumbersSkipZero) {
  BitsDesk desk;
  for (int i = 0; i < 65536; ++i) {
    desk.control(kTrigger);
    ASSERT_NE(desk.see().accepted_number, 0);
    desk.control(0);
    desk.finish(desk.found());
  }
  EXPECT_EQ(desk.see().done_number, 1);
}

}  // namespace
}  // namespace flatpose::job
