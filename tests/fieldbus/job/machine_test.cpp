#include "flatpose/job/machine.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "tests/fieldbus/job/desk.hpp"

namespace flatpose::job {
namespace {

struct ReadyDesk : Desk {
  ReadyDesk() : ReadyDesk(Config{.session_id = 321}) {}
  explicit ReadyDesk(const Config& config) : Desk(config) { live(); }
  void locate_done(std::uint16_t number, int count = 3) {
    write(number);
    now_us += 1000;
    finish(found(count));
  }
};

TEST(JobMachine, AnOrderBearsWhatWasWrittenWithTheNumber) {
  ReadyDesk desk;
  CommandImage image = desk.image(9, Command::kReportPick);
  image.job = 7;
  image.pick_number = 8;
  image.pick_outcome = 2;
  desk.write(image);
  EXPECT_EQ(desk.order.number, 9);
  EXPECT_EQ(desk.order.pick_number, 8);
  EXPECT_EQ(desk.order.pick_outcome, 2);
  EXPECT_EQ(desk.order.accepted_us, desk.now_us);
  EXPECT_EQ(desk.order.job, 0);  // no job has to do with it
  desk.finish({.answer = Answer::kOk});
  image.command = 1;
  image.command_number = 10;
  desk.write(image);
  EXPECT_EQ(desk.order.job, 7);
  EXPECT_EQ(desk.order.answer_by_us, desk.now_us + 9 * kSecond_us);
  EXPECT_EQ(desk.see().answer_by_ms, 9000U);
}

TEST(JobMachine, ALateAnswerOfACancelledCommandIsNobodys) {
  ReadyDesk desk;
  desk.write(1);
  const Order first = desk.order;
  desk.write(2, Command::kCancel);
  EXPECT_EQ(desk.see().cancelled_number, 1);
  desk.write(1);  // the same number again, as a new command
  desk.tell(SearchEvent::Kind::kScanned, first.ticket);
  desk.tell(SearchEvent::Kind::kFinished, first.ticket, desk.found());
  EXPECT_TRUE(desk.has(kBusy));
  EXPECT_EQ(desk.see().scanned_number, 0);
  desk.finish(desk.found());
  EXPECT_EQ(desk.see().done_number, 1);
  EXPECT_TRUE(desk.has(kValid));
}

TEST(JobMachine, ARefusedNumberIsUsedUp) {
  ReadyDesk desk;
  CommandImage image = desk.image(4);
  image.command_session = 99;
  desk.write(image);
  EXPECT_EQ(desk.see().refused_status, Refusal::kStaleSession);
  EXPECT_TRUE(desk.has(kError));
  image.command_session = 321;  // mended, but the number was seen
  desk.write(image);
  EXPECT_FALSE(desk.has(kBusy));
  EXPECT_EQ(desk.see().refused_number, 4);
  image.command_number = 5;
  desk.write(image);
  EXPECT_TRUE(desk.has(kBusy));
  EXPECT_FALSE(desk.has(kError));
  EXPECT_EQ(desk.see().refused_number, 0);
}

TEST(JobMachine, AnExceptionUsesNoNumberUp) {
  ReadyDesk desk;
  desk.write(1);
  desk.finish(desk.found());
  EXPECT_EQ(desk.write(6, Command::kLocate, kBob), Verdict::kNotOwner);
  EXPECT_EQ(desk.see(kBob).last_number, 0);
  EXPECT_TRUE(desk.has(kValid));  // Ada's result is as it was
  desk.pass(5 * kSecond_us);
  desk.live();
  EXPECT_EQ(desk.write(6, Command::kLocate, kBob), Verdict::kGranted);
  EXPECT_TRUE(desk.has(kBusy));
}

TEST(JobMachine, ANumberIsNotExecutedTwiceThoughAnotherWroteBetween) {
  ReadyDesk desk;
  desk.locate_done(7);
  desk.pass(5 * kSecond_us);
  desk.live();
  desk.write(7, Command::kLocate, kBob);  // Bob's own seven
  EXPECT_TRUE(desk.has(kBusy));
  desk.finish(desk.found());
  EXPECT_TRUE(desk.see(kBob).result_is_readers);
  EXPECT_FALSE(desk.see(kAda).result_is_readers);
  desk.pass(5 * kSecond_us);
  desk.live();
  desk.order = {};
  desk.write(7);  // Ada's cyclic exchange goes on with what it had
  EXPECT_EQ(desk.order.kind, Order::Kind::kNone);
  EXPECT_EQ(desk.see().done_number, 0);  // nor is Bob's seven there for her
}

TEST(JobMachine, WhatAnotherWroteIsNoDefault) {
  ReadyDesk desk;
  CommandImage image = desk.image(1, Command::kCapture);
  image.job = 7;
  image.command_session = 321;
  desk.write(image);
  desk.pass(5 * kSecond_us);
  EXPECT_EQ(desk.machine.image_for({kBob, 1}), CommandImage{});
  EXPECT_EQ(desk.machine.image_for({kAda, 2}), image);
}

TEST(JobMachine, TheLeaseEndsARunningCommandAsCancelled) {
  ReadyDesk desk;
  CommandImage image = desk.image(3);
  image.job = 7;  // would wait for 9 s
  desk.write(image);
  EXPECT_EQ(desk.out.next_us, desk.now_us + 2 * kSecond_us);  // liveness first
  desk.pass(3 * kSecond_us);
  desk.read();
  EXPECT_EQ(desk.out.next_us, desk.now_us + 5 * kSecond_us);
  desk.pass(5 * kSecond_us - 1);
  EXPECT_TRUE(desk.has(kBusy));
  desk.pass(1);
  EXPECT_EQ(desk.order.kind, Order::Kind::kStop);
  EXPECT_EQ(desk.see().done_number, 3);
  EXPECT_EQ(desk.see().answer, Answer::kCancelled);
  EXPECT_EQ(desk.see().owner_address, kNobody);
}

TEST(JobMachine, AnotherConnectionOfTheOwnerNeitherCancelsNorInvalidates) {
  ReadyDesk desk;
  EXPECT_EQ(desk.write(desk.image(1), kAda, 5), Verdict::kGranted);
  EXPECT_EQ(desk.write(desk.image(1), kAda, 6), Verdict::kGranted);
  EXPECT_TRUE(desk.has(kBusy));
  desk.finish(desk.found());
  EXPECT_EQ(desk.write(desk.image(1), kAda, 7), Verdict::kGranted);
  EXPECT_TRUE(desk.has(kValid));
}

TEST(JobMachine, AnAnswerTooLateIsAnAnswerOfItsOwn) {
  ReadyDesk desk;
  desk.write(1);
  EXPECT_EQ(desk.see().answer_by_ms, 2000U);
  desk.pass(2 * kSecond_us);
  EXPECT_EQ(desk.see().answer, Answer::kAnswerLate);
  EXPECT_EQ(desk.order.kind, Order::Kind::kStop);
  EXPECT_TRUE(desk.has(kError));
  desk.tell(SearchEvent::Kind::kFinished, desk.order.ticket - 1, desk.found());
  EXPECT_FALSE(desk.has(kValid));
}

TEST(JobMachine, OnlyAScanAcquiredAfterAcceptanceCounts) {
  ReadyDesk desk;
  ScanResult old = desk.found();
  desk.pass(1);
  desk.write(1);
  desk.finish(old);
  EXPECT_EQ(desk.see().answer, Answer::kNoScan);
  EXPECT_FALSE(desk.has(kValid));
  EXPECT_EQ(desk.see().match.index, 0);
  desk.write(2, Command::kLocateInLast);  // there it is what was asked for
  desk.finish(old);
  EXPECT_TRUE(desk.has(kValid));
}

TEST(JobMachine, AnUnsoundResultIsNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::function<void(ScanResult&)>> spoilers{
      [](ScanResult& r) { r.match_count = 0; },
      [](ScanResult& r) { r.match_count = kMatchesPerScanMax + 1; },
      [](ScanResult& r) { r.frame = FrameName::kRobot; },
      [nan](ScanResult& r) { r.matches[1].frame_T_pick.position_mm.y = nan; },
      [nan](ScanResult& r) { r.matches[0].frame_T_pick.rotation.m[4] = nan; }};
  for (const auto& spoil : spoilers) {
    ReadyDesk desk;
    desk.write(1);
    ScanResult result = desk.found(2);
    spoil(result);
    desk.finish(result);
    EXPECT_EQ(desk.see().answer, Answer::kInternal);
    EXPECT_FALSE(desk.has(kValid));
    EXPECT_EQ(desk.see().match_count, 0);
  }
}

TEST(JobMachine, ASimulatedScanMakesNoPoseUnlessAllowed) {
  for (const bool is_allowed : {false, true}) {
    ReadyDesk desk(Config{.allow_simulated = is_allowed});
    desk.write(1);
    ScanResult result = desk.found();
    result.is_simulated = true;
    desk.finish(result);
    EXPECT_TRUE(desk.has(kSimulated));
    EXPECT_EQ(desk.has(kValid), is_allowed);
    EXPECT_EQ(desk.see().match.index, is_allowed ? 1 : 0);
    EXPECT_EQ(desk.see().answer, is_allowed ? Answer::kOk : Answer::kSimulated);
  }
}

TEST(JobMachine, ASimulatedSourceIsToldBeforeAnyScan) {
  ReadyDesk desk;
  EXPECT_FALSE(desk.has(kSimulated));
  desk.tell(SearchEvent::Kind::kSourceAlive, 0, {.is_simulated = true});
  EXPECT_TRUE(desk.has(kSimulated));
  desk.tell(SearchEvent::Kind::kSourceAlive, 0, {.is_simulated = false});
  EXPECT_FALSE(desk.has(kSimulated));
}

TEST(JobMachine, APoseExpiresAndItsAgeIsLive) {
  ReadyDesk desk;
  desk.locate_done(1);
  EXPECT_EQ(desk.see().age_ms, 0U);
  desk.pass(1'234'567);
  EXPECT_EQ(desk.see().age_ms, 1234U);
  EXPECT_TRUE(desk.has(kValid));
  desk.pass(3 * kSecond_us - 1'234'567);
  EXPECT_TRUE(desk.has(kValid));
  EXPECT_EQ(desk.out.next_us, desk.now_us + 1);
  desk.pass(1);
  EXPECT_FALSE(desk.has(kValid));
  EXPECT_TRUE(desk.has(kDone));
  EXPECT_EQ(desk.see().answer, Answer::kExpired);
  EXPECT_EQ(desk.see().match.index, 0);
  EXPECT_EQ(desk.see().further[0].index, 0);
  desk.write(2, Command::kNext);  // of the same scan, as old
  EXPECT_EQ(desk.see().answer, Answer::kExpired);
}

TEST(JobMachine, NextGoesThroughTheMatchesOfTheScan) {
  ReadyDesk desk;
  desk.locate_done(1, 3);
  EXPECT_EQ(desk.see().match_count, 3);
  for (std::uint16_t i = 0; i < 3; ++i) {
    const Snapshot s = desk.see();
    EXPECT_EQ(s.done_number, 1 + i);
    EXPECT_EQ(s.match.index, 1 + i);
    EXPECT_EQ(s.matches_left, 2 - i);
    EXPECT_EQ(s.match.position_mm.x, 10.0 * (1 + i));
    EXPECT_EQ(s.further[0].index, i == 2 ? 0 : 2 + i);
    EXPECT_EQ(s.further[2].index, 0);
    EXPECT_EQ(s.scan_number, 1000U);
    desk.write(static_cast<std::uint16_t>(2 + i), Command::kNext);
  }
  EXPECT_EQ(desk.see().answer, Answer::kNoMatch);
  EXPECT_EQ(desk.see().match.index, 0);
  desk.write(9, Command::kNext);
  EXPECT_EQ(desk.see().answer, Answer::kNoMatch);
}

TEST(JobMachine, APickEndsInOneOfTheWaysThatThereAre) {
  ReadyDesk desk;
  std::uint16_t number = 1;
  for (const int outcome : {0, 1, 2, 3, 4, 5, 77, 256, 65535}) {
    SCOPED_TRACE(outcome);
    CommandImage image = desk.image(number, Command::kReportPick);
    image.pick_outcome = static_cast<std::uint16_t>(outcome);
    desk.write(image);
    const bool is_one = std::string(name_of(pick_outcome_names(), outcome)) != "unknown";
    EXPECT_EQ(desk.has(kBusy), is_one);
    EXPECT_EQ(desk.see().refused_number, is_one ? 0 : number);
    EXPECT_EQ(desk.see().refused_status, is_one ? Refusal::kNone : Refusal::kBadCommand);
    if (is_one) desk.finish({.answer = Answer::kOk});
    ++number;
  }
  CommandImage locate = desk.image(number);
  locate.pick_outcome = 77;
  desk.write(locate);
  EXPECT_TRUE(desk.has(kBusy)) << "of another command it says nothing";
}

TEST(JobMachine, NextKeepsFrameAndConventionThoughOtherCommandsCameBetween) {
  ReadyDesk desk;
  CommandImage image = desk.image(1);
  image.job = 7;
  desk.write(image);
  desk.finish(desk.found(2, FrameName::kRobot));
  desk.write(2, Command::kReportPick);
  EXPECT_TRUE(desk.has(kBusy));
  desk.finish({.answer = Answer::kOk});
  EXPECT_FALSE(desk.has(kValid));
  desk.write(3, Command::kClearError);
  desk.write(4, Command::kNext);
  const Snapshot s = desk.see();
  EXPECT_EQ(s.frame, FrameName::kRobot);
  EXPECT_EQ(s.convention, Convention::kAbbQuaternion);
  EXPECT_EQ(s.job, 7);
  EXPECT_EQ(s.match.index, 2);
  EXPECT_EQ(s.match.rotation[0], 1.0);
}

TEST(JobMachine, ANewScanLeavesNothingOfTheOldForNext) {
  for (const Command command : {Command::kLocate, Command::kCapture, Command::kLocateInLast,
                                Command::kVerifyAlignment, Command::kReloadJobs}) {
    ReadyDesk desk;
    desk.locate_done(1);
    desk.write(2, command);
    desk.write(3, Command::kCancel);
    desk.write(4, Command::kNext);
    EXPECT_EQ(desk.see().answer, Answer::kNoScan);
    EXPECT_EQ(desk.see().match.index, 0);
  }
}

TEST(JobMachine, ACaptureHasAScanAndNoPose) {
  ReadyDesk desk;
  desk.write(1, Command::kCapture);
  desk.tell(SearchEvent::Kind::kScanned, desk.order.ticket);
  EXPECT_EQ(desk.see().scanned_number, 1);
  EXPECT_TRUE(desk.has(kBusy));
  desk.finish(desk.found());
  EXPECT_EQ(desk.see().answer, Answer::kOk);
  EXPECT_FALSE(desk.has(kValid));
  EXPECT_EQ(desk.see().match_count, 0);
  EXPECT_EQ(desk.see().scan_number, 1000U);
  desk.pass(kSecond_us);
  EXPECT_EQ(desk.see().age_ms, 1000U);
}

TEST(JobMachine, ANegativeAnswerCarriesNoPoseWhateverTheSearchSent) {
  for (const AnswerText& text : answer_texts()) {
    if (may_have_pose(text.answer)) continue;
    ReadyDesk desk;
    desk.write(1);
    ScanResult result = desk.found(4);
    result.answer = text.answer;
    desk.finish(result);
    EXPECT_FALSE(desk.has(kValid)) << text.name;
    EXPECT_EQ(desk.see().match.index, 0);
    EXPECT_EQ(desk.see().match_count, 0);
    EXPECT_EQ(desk.has(kError), is_fault(text.answer));
    desk.write(2, Command::kNext);
    EXPECT_EQ(desk.see().match.index, 0);
  }
}

TEST(JobMachine, ReloadedJobsCountFromTheirCallOn) {
  ReadyDesk desk;
  desk.write(1, Command::kReloadJobs);
  JobTable jobs;
  jobs.count = 1;
  jobs.rules[0].job = 2;
  const SearchEvent event{SearchEvent::Kind::kFinished, desk.order.ticket, {.answer = Answer::kOk}};
  desk.process({.jobs = &jobs, .event = &event});
  EXPECT_EQ(desk.see().answer, Answer::kOk);
  desk.write(2);
  EXPECT_EQ(desk.see().refused_status, Refusal::kBadJob);
  CommandImage image = desk.image(3);
  image.job = 2;
  desk.write(image);
  EXPECT_TRUE(desk.has(kBusy));
}

TEST(JobMachine, TheHeartbeatNeedsBothToLive) {
  ReadyDesk desk;
  const std::uint16_t start = desk.see().heartbeat;
  desk.tell(SearchEvent::Kind::kSearchAlive);
  desk.tell(SearchEvent::Kind::kSearchAlive);
  EXPECT_EQ(desk.see().heartbeat, start);
  desk.tell(SearchEvent::Kind::kSourceAlive);
  EXPECT_EQ(desk.see().heartbeat, start + 1);
  EXPECT_TRUE(desk.has(kReady));
  desk.pass(kSecond_us);
  desk.tell(SearchEvent::Kind::kSearchAlive);
  EXPECT_TRUE(desk.has(kReady));
  desk.pass(kSecond_us);  // the source is silent for two seconds
  EXPECT_FALSE(desk.has(kReady));
  desk.write(1);
  EXPECT_EQ(desk.see().refused_status, Refusal::kNotReady);
  desk.write(2, Command::kLocateInLast);  // needs no source
  EXPECT_TRUE(desk.has(kBusy));
}

TEST(JobMachine, ASourceThatIsGoneIsNotWaitedForAndEndsNoCommand) {
  ReadyDesk desk;
  const std::uint16_t start = desk.see().heartbeat;
  desk.tell(SearchEvent::Kind::kSourceGone);
  EXPECT_FALSE(desk.has(kReady));
  desk.tell(SearchEvent::Kind::kSearchAlive);
  EXPECT_FALSE(desk.has(kReady));
  EXPECT_EQ(desk.see().heartbeat, start);
  desk.write(1);
  EXPECT_EQ(desk.see().refused_status, Refusal::kNotReady);
  desk.tell(SearchEvent::Kind::kSourceAlive);
  EXPECT_TRUE(desk.has(kReady));
  desk.write(2);
  desk.tell(SearchEvent::Kind::kSourceGone);
  EXPECT_TRUE(desk.has(kBusy));  // its scan may be taken already: the search says how it ends
  desk.finish(desk.found());
  EXPECT_TRUE(desk.has(kValid));
  EXPECT_FALSE(desk.has(kReady));
}

TEST(JobMachine, RotationsStayNearTheJobsReference) {
  ReadyDesk desk;
  JobTable jobs = two_jobs();
  jobs.rules[0].has_reference = true;
  jobs.rules[0].reference = {3.1, 0, 0, 0};
  desk.process({.jobs = &jobs});
  desk.write(1);
  ScanResult result = desk.found();
  result.matches[0].frame_T_pick.rotation = rotation_about_z(-3.1);
  desk.finish(result);
  EXPECT_NEAR(desk.see().match.rotation[0], 2 * 3.14159265358979 - 3.1, 1e-12);
}

TEST(JobMachine, AClockThatRunsBackStandsStill) {
  ReadyDesk desk;
  desk.locate_done(1);
  desk.pass(kSecond_us);
  desk.machine.process(desk.now_us - 10 * kSecond_us, {});
  EXPECT_EQ(desk.see().age_ms, 1000U);
}

TEST(JobMachine, SaysWhoItIsAndForHowLong) {
  Desk desk;
  desk.pass(61 * kSecond_us);
  const Snapshot s = desk.see();
  EXPECT_EQ(s.session_id, 321);
  EXPECT_EQ(s.boot_count, 5);
  EXPECT_EQ(s.uptime_s, 61U);
  EXPECT_EQ(s.answer, Answer::kPending);
  EXPECT_EQ(s.bits, 0);
}

TEST(JobMachine, WritingAnotherRegisterTriggersNothing) {
  ReadyDesk desk;
  const Request request{{kAda, 1}, true, desk.image(5), false, false};
  desk.process({.request = &request});
  EXPECT_FALSE(desk.has(kBusy));
  EXPECT_EQ(desk.see().last_number, 0);
}

}  // namespace
}  // namespace flatpose::job
