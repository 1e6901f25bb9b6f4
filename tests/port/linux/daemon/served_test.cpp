// The daemon serving a dry run to a PLC of raw sockets, held against the library's own answer.

#include "tests/port/linux/daemon/served.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <random>
#include <thread>

namespace flatpose::daemon {
namespace {

using job::Answer;
using job::Refusal;

TEST_F(Served, PoseIsTheLibrarysOwnInEveryConvention) {
  std::string more;
  for (int i = 1; i < kConventionCount; ++i)
    more += "[[job]]\nparts = [\"pad\"]\nnumber = " + std::to_string(i + 1) + "\nconvention = \"" +
            to_string(static_cast<Convention>(i)) + "\"\n";
  const std::string config = dry_run({}, more);
  const auto own = located(config, kScan);
  ASSERT_EQ(own->match_count, 1);
  RunningDaemon daemon({"--config", config});
  Plc plc(daemon.port());
  ASSERT_TRUE(plc.waits_until_ready());
  EXPECT_EQ(plc.block()[Field::kPositionX], INT32_MIN);
  for (std::uint16_t job = 1; job <= kConventionCount; ++job) {
    const auto number = static_cast<std::uint16_t>(40 + job);
    const Plc::Block block = plc.trigger(number, 0, 1, job);
    EXPECT_EQ(block[Field::kDoneNumber], number);
    EXPECT_EQ(block[Field::kScannedNumber], number);
    EXPECT_EQ(block[Field::kStatus], static_cast<int>(own->outcome));
    EXPECT_EQ(block[Field::kConvention], job - 1);
    EXPECT_EQ(block[Field::kMatchCount], 1);
    EXPECT_TRUE(block.has(job::kValid));
    EXPECT_TRUE(block.has(job::kSimulated));
    EXPECT_FALSE(block.has(job::kError));
    expect_pose(block, own->matches[0].face_T_object, static_cast<Convention>(job - 1));
  }
  EXPECT_EQ(daemon.stop(SIGTERM), 0) << daemon.log();
}

TEST_F(Served, NumberRunsOnce) {
  RunningDaemon daemon({"--config", dry_run()});
  Plc plc(daemon.port());
  ASSERT_TRUE(plc.waits_until_ready());
  EXPECT_EQ(plc.trigger(5)[Field::kScanNumber], 1);
  EXPECT_TRUE(plc.write({5, 0, 1, 1}));  // the same number: nothing
  EXPECT_EQ(plc.block()[Field::kScanNumber], 1);
  EXPECT_TRUE(plc.block().has(job::kValid));
  const Plc::Block second = plc.trigger(6);
  EXPECT_EQ(second[Field::kScanNumber], 2);
  EXPECT_TRUE(second.has(job::kScanRepeated));
}

TEST_F(Served, ResultOutlivesTheClientThatAsked) {
  RunningDaemon daemon({"--config", dry_run()});
  {
    Plc plc(daemon.port());
    ASSERT_TRUE(plc.waits_until_ready());
    EXPECT_TRUE(plc.write({9}));
  }  // gone in mid-search
  Plc plc(daemon.port());
  EXPECT_TRUE(comes_true([&] { return plc.block()[Field::kDoneNumber] == 9; }));
  EXPECT_TRUE(plc.block().has(job::kValid));
}

TEST_F(Served, NumberOfTheSessionBeforeIsRefusedAfterARestart) {
  std::uint16_t session = 0;
  {
    RunningDaemon daemon({"--config", dry_run()});
    Plc plc(daemon.port());
    ASSERT_TRUE(plc.waits_until_ready());
    session = static_cast<std::uint16_t>(plc.block()[Field::kSessionId]);
    EXPECT_EQ(plc.trigger(3, session)[Field::kDoneNumber], 3);
    EXPECT_TRUE(plc.write({4, session, 1, 1}));  // killed in mid-search
    EXPECT_EQ(daemon.stop(SIGKILL), -1);
  }
  RunningDaemon daemon({"--config", dry_run()});
  Plc plc(daemon.port());
  ASSERT_TRUE(plc.waits_until_ready());
  const auto fresh = static_cast<std::uint16_t>(plc.block()[Field::kSessionId]);
  if (fresh == session) GTEST_SKIP() << "one in 65535: the sessions are alike";
  const Plc::Block block = plc.trigger(4, session);
  EXPECT_EQ(block[Field::kRefusedNumber], 4);
  EXPECT_EQ(block[Field::kRefusedStatus], static_cast<int>(Refusal::kStaleSession));
  EXPECT_EQ(block[Field::kDoneNumber], 0);
  EXPECT_EQ(plc.trigger(5, fresh)[Field::kDoneNumber], 5);
}

TEST_F(Served, SecondPlcMayReadAndNotWrite) {
  RunningDaemon daemon({"--config", dry_run()});
  Plc first(daemon.port());
  Plc second(daemon.port(), "127.0.0.2");
  ASSERT_TRUE(first.waits_until_ready());
  EXPECT_EQ(first.trigger(1)[Field::kDoneNumber], 1);
  EXPECT_EQ(second.ask({6, 0, 0, 0, 2}), (Bytes{0x86, 6}));
  EXPECT_EQ(second.block()[Field::kOwnerAddress], 0x7f000001);
  EXPECT_EQ(second.block()[Field::kDoneNumber], 1);
}

TEST_F(Served, SimulatedScanIsNoPoseUnlessAllowed) {
  RunningDaemon daemon({"--config", write_config("replay = \"" + kScan + "\"")});
  Plc plc(daemon.port());
  ASSERT_TRUE(plc.waits_until_ready());
  const Plc::Block block = plc.trigger(1);
  EXPECT_EQ(block[Field::kStatus], static_cast<int>(Answer::kSimulated));
  EXPECT_FALSE(block.has(job::kValid));
  EXPECT_EQ(block[Field::kPositionX], INT32_MIN);
}

TEST_F(Served, FolderIsReplayedByNameAndABrokenFileIsNoScan) {
  const port::TemporaryFolder scans;
  std::filesystem::copy(kScan, scans.path("a.pcd"));
  scans.write("b.pcd", "# .PCD v0.7 - and then nothing");
  std::filesystem::copy(kTeach, scans.path("c.pcd"));
  RunningDaemon daemon({"--config", dry_run(), "--scan", scans.path()});
  Plc plc(daemon.port());
  ASSERT_TRUE(plc.waits_until_ready());
  const auto first = plc.trigger(1);
  const auto broken = plc.trigger(2);
  const auto third = plc.trigger(3);
  const auto again = plc.trigger(4);
  expect_pose(first, located(folder_.path("f.toml"), kScan)->matches[0].face_T_object, {});
  EXPECT_EQ(broken[Field::kStatus], static_cast<int>(Answer::kNoScan));
  EXPECT_FALSE(broken.has(job::kValid));
  expect_pose(third, located(folder_.path("f.toml"), kTeach)->matches[0].face_T_object, {});
  EXPECT_FALSE(third.has(job::kScanRepeated));
  EXPECT_EQ(again[Field::kPositionX], first[Field::kPositionX]);
  daemon.stop(SIGTERM);
  EXPECT_NE(daemon.log().find("command 2: "), std::string::npos) << daemon.log();
}

TEST_F(Served, FileThatChangesIsReadAnew) {
  const port::TemporaryFolder scans;
  std::filesystem::copy(kScan, scans.path("s.pcd"));
  RunningDaemon daemon({"--config", dry_run(), "--scan", scans.path("s.pcd")});
  Plc plc(daemon.port());
  ASSERT_TRUE(plc.waits_until_ready());
  const auto first = plc.trigger(1);
  std::filesystem::copy(kTeach, scans.path("next.pcd"));
  std::filesystem::rename(scans.path("next.pcd"), scans.path("s.pcd"));
  const auto second = plc.trigger(2);
  EXPECT_NE(second[Field::kPositionX], first[Field::kPositionX]);
  expect_pose(second, located(folder_.path("f.toml"), kTeach)->matches[0].face_T_object, {});
}

TEST_F(Served, CancelEndsASearchAtOnce) {
  RunningDaemon daemon({"--config", dry_run()});
  Plc plc(daemon.port());
  ASSERT_TRUE(plc.waits_until_ready());
  EXPECT_TRUE(plc.write({1}));
  const Plc::Block block = plc.trigger(2, 0, static_cast<std::uint16_t>(job::Command::kCancel));
  EXPECT_EQ(block[Field::kDoneNumber], 2);
  EXPECT_FALSE(block.has(job::kValid));
  // And the next one has its own answer.
  EXPECT_TRUE(plc.trigger(3).has(job::kValid));
}

TEST_F(Served, AnswerThatIsLateEndsTheSearchAndTheNextIsSound) {
  RunningDaemon daemon({"--config", dry_run("answer_by_ms = 1\ndeadline_ms = 1",
                                            "[[job]]\nnumber = 2\nparts = [\"pad\"]\n")});
  Plc plc(daemon.port());
  ASSERT_TRUE(plc.waits_until_ready());
  for (std::uint16_t number = 1; number < 9; number = static_cast<std::uint16_t>(number + 2)) {
    const Plc::Block late = plc.trigger(number);
    EXPECT_EQ(late[Field::kStatus], static_cast<int>(Answer::kAnswerLate));
    EXPECT_FALSE(late.has(job::kValid));
    const Plc::Block sound = plc.trigger(static_cast<std::uint16_t>(number + 1), 0, 1, 2);
    EXPECT_EQ(sound[Field::kStatus], 0);
    EXPECT_TRUE(sound.has(job::kValid));
  }
}

// From another address: every function with every length, then bytes that are no frames at all.
void be_hostile(int port) {
  std::mt19937 random(3);
  for (int round = 0; round < 300; ++round) {
    const Plc bad(port, "127.0.0.3");
    Bytes stream;
    for (int i = 0; i < 4; ++i) {
      Bytes pdu{static_cast<std::uint8_t>(random())};
      const std::size_t more = random() % 260;
      for (std::size_t k = 0; k < more; ++k) pdu.push_back(static_cast<std::uint8_t>(random()));
      const Bytes frame = Plc::frame(static_cast<std::uint16_t>(i), pdu);
      stream.insert(stream.end(), frame.begin(), frame.end());
    }
    if (round % 3 == 0) stream[random() % stream.size()] ^= 0x55;
    if (round % 2 == 0) stream.resize(random() % stream.size() + 1);
    bad.send_some(stream);
  }
}

TEST_F(Served, EveryNumberIsAnsweredAmongHostileClients) {
  RunningDaemon daemon({"--config", dry_run()});
  Plc plc(daemon.port());
  ASSERT_TRUE(plc.waits_until_ready());
  std::atomic<bool> is_over{false};
  std::jthread hostile([&] {
    while (!is_over.load()) be_hostile(daemon.port());
  });
  for (std::uint16_t number = 1; number <= 12; ++number) {
    const Plc::Block block = plc.trigger(number);
    EXPECT_EQ(block[Field::kDoneNumber], number);
    EXPECT_EQ(block[Field::kScanNumber], number);  // each once
    EXPECT_TRUE(block.has(job::kValid));
  }
  is_over.store(true);
  hostile.join();
  EXPECT_TRUE(plc.trigger(13).has(job::kValid));
  EXPECT_EQ(daemon.stop(SIGTERM), 0) << daemon.log();
}

TEST_F(Served, EveryCommandIsAnswered) {
  RunningDaemon daemon({"--config", dry_run("max_matches = 8")});
  Plc plc(daemon.port());
  ASSERT_TRUE(plc.waits_until_ready());
  const auto status_of = [&](std::uint16_t number, job::Command command) {
    const Plc::Block block = plc.trigger(number, 0, static_cast<std::uint16_t>(command));
    EXPECT_EQ(block[Field::kDoneNumber], number);
    return static_cast<Answer>(block[Field::kStatus]);
  };
  EXPECT_EQ(status_of(1, job::Command::kLocateInLast), Answer::kNoScan);
  EXPECT_EQ(status_of(2, job::Command::kCapture), Answer::kOk);
  EXPECT_EQ(status_of(3, job::Command::kLocateInLast), Answer::kOk);
  EXPECT_EQ(plc.block()[Field::kScanNumber], 1);
  EXPECT_EQ(status_of(4, job::Command::kNext), Answer::kNoMatch);  // there is but one
  EXPECT_EQ(status_of(5, job::Command::kReportPick), Answer::kOk);
  EXPECT_EQ(status_of(6, job::Command::kVerifyAlignment), Answer::kNoAlignment);
  EXPECT_EQ(status_of(7, job::Command::kSaveScan), Answer::kNotSaved);
  EXPECT_EQ(status_of(8, job::Command::kReloadJobs), Answer::kOk);
  EXPECT_EQ(status_of(9, job::Command::kClearError), Answer::kOk);
  EXPECT_FALSE(plc.block().has(job::kError));
}

TEST_F(Served, PoseOutsideTheLimitsIsWithheld) {
  RunningDaemon daemon({"--config", dry_run("limit_x_mm = [500, 600]")});
  Plc plc(daemon.port());
  ASSERT_TRUE(plc.waits_until_ready());
  const Plc::Block block = plc.trigger(1);
  EXPECT_EQ(block[Field::kStatus], static_cast<int>(Answer::kOutsideLimits));
  EXPECT_FALSE(block.has(job::kValid));
  EXPECT_EQ(block[Field::kMatchCount], 0);
}

TEST_F(Served, OnePartAmongSeveralIsNamedByItsPlace) {
  const std::string other = std::string("[[part]]\nname = \"same\"\nfile = \"") + FLATPOSE_EXAMPLE +
                            "/pad.fpt\"\n[[job]]\nnumber = 2\nparts = [\"pad\", \"same\"]\n"
                            "max_matches = 2\n";
  RunningDaemon daemon({"--config", dry_run({}, other)});
  Plc plc(daemon.port());
  ASSERT_TRUE(plc.waits_until_ready());
  const Plc::Block block = plc.trigger(1, 0, 1, 2);
  EXPECT_EQ(block[Field::kResultJob], 2);
  EXPECT_EQ(block[Field::kMatchCount], 2);
  EXPECT_EQ(block[Field::kPart], 1);  // of equals the first
  const Plc::Block refused = plc.trigger(2, 0, 1, 3);
  EXPECT_EQ(refused[Field::kRefusedStatus], static_cast<int>(Refusal::kBadJob));
}

}  // namespace
}  // namespace flatpose::daemon
