// Jobs read again while the daemon runs: all of them, or the old ones stay.

#include <gtest/gtest.h>

#include "port/linux/daemon/section.hpp"
#include "port/linux/files/atomic_file.hpp"
#include "tests/port/linux/daemon/served.hpp"

namespace flatpose::daemon {
namespace {

using job::Answer;
using job::Refusal;

constexpr auto kReload = static_cast<std::uint16_t>(job::Command::kReloadJobs);

class Reload : public Served {
 protected:
  static std::string job(int number, const std::string& more = {}) {
    return "[[job]]\nnumber = " + std::to_string(number) + "\nparts = [\"pad\"]\n" + more;
  }
  static Answer status(const Plc::Block& block) {
    return static_cast<Answer>(block[Field::kStatus]);
  }
};

TEST_F(Reload, NewJobsAreThereWhenTheAnswerIs) {
  RunningDaemon daemon({"--config", dry_run({}, job(2))});
  Plc plc(daemon.port());
  ASSERT_TRUE(plc.waits_until_ready());
  EXPECT_EQ(plc.trigger(1, 0, 1, 3)[Field::kRefusedStatus], static_cast<int>(Refusal::kBadJob));
  (void)dry_run("convention = \"abb_quaternion\"", job(3, "limit_x_mm = [500, 600]\n"));
  EXPECT_EQ(plc.trigger(2, 0, 1, 1)[Field::kConvention], 0);  // not before it is asked for
  EXPECT_EQ(status(plc.trigger(3, 0, kReload)), Answer::kOk);
  const Plc::Block changed = plc.trigger(4, 0, 1, 1);
  EXPECT_EQ(changed[Field::kConvention], static_cast<int>(Convention::kAbbQuaternion));
  EXPECT_TRUE(changed.has(job::kValid));
  EXPECT_EQ(status(plc.trigger(5, 0, 1, 3)), Answer::kOutsideLimits);
  EXPECT_EQ(plc.trigger(6, 0, 1, 2)[Field::kRefusedStatus], static_cast<int>(Refusal::kBadJob));
  EXPECT_EQ(plc.block()[Field::kSessionId], changed[Field::kSessionId]);  // no restart
  // And again, and again.
  for (std::uint16_t number = 7; number < 13; number = static_cast<std::uint16_t>(number + 2)) {
    (void)dry_run({}, job(number));
    EXPECT_EQ(status(plc.trigger(number, 0, kReload)), Answer::kOk);
    EXPECT_EQ(status(plc.trigger(static_cast<std::uint16_t>(number + 1), 0, 1, number)),
              Answer::kOk);
  }
  EXPECT_EQ(daemon.stop(SIGTERM), 0) << daemon.log();
}

TEST_F(Reload, OfAConfigWithAnErrorChangesNothing) {
  RunningDaemon daemon({"--config", dry_run()});
  Plc plc(daemon.port());
  ASSERT_TRUE(plc.waits_until_ready());
  std::uint16_t number = 0;
  for (const std::string& more : {job(2) + "colour = 1\n", job(2) + job(2),
                                  "[[part]]\nname = \"x\"\nfile = \"none.fpt\"\n" + job(2),
                                  job(2) + "[serach]\n", job(2) + "[[job"}) {
    (void)dry_run({}, more);
    EXPECT_EQ(status(plc.trigger(++number, 0, kReload)), Answer::kJobsRefused) << more;
    EXPECT_TRUE(plc.block().has(job::kError));
    EXPECT_EQ(plc.trigger(++number, 0, 1, 2)[Field::kRefusedStatus],
              static_cast<int>(Refusal::kBadJob));
    EXPECT_EQ(status(plc.trigger(++number, 0, 1, 1)), Answer::kOk);
  }
  daemon.stop(SIGTERM);
  for (const char* part : {"jobs not reloaded, the old ones are in force: ", "unknown key 'colour'",
                           "two jobs", "none.fpt", "serach"})
    EXPECT_NE(daemon.log().find(part), std::string::npos) << part << ":\n" << daemon.log();
}

TEST_F(Reload, BySighupDoesTheSameAndNamesWhatWaitsForAStart) {
  RunningDaemon daemon({"--config", dry_run()});
  Plc plc(daemon.port());
  ASSERT_TRUE(plc.waits_until_ready());
  EXPECT_EQ(status(plc.trigger(1)), Answer::kOk);
  const std::string text = dry_run({}, job(2));
  (void)folder_.write("f.toml", "[realtime]\ntimer_slack_ns = 1000\n" +
                                    std::string(port::as_text(port::read_file(text, 1 << 20))));
  daemon.signal(SIGHUP);
  std::uint16_t number = 1;
  EXPECT_TRUE(
      comes_true([&] { return plc.trigger(++number, 0, 1, 2)[Field::kRefusedStatus] == 0; }));
  EXPECT_TRUE(plc.block().has(job::kValid));
  daemon.stop(SIGTERM);
  EXPECT_NE(daemon.log().find("[realtime] has changed"), std::string::npos) << daemon.log();
  EXPECT_NE(daemon.log().find("jobs reloaded"), std::string::npos) << daemon.log();
  EXPECT_EQ(daemon.log().find("[modbus] has changed"), std::string::npos) << daemon.log();
}

// Whoever asks, while searches run: every number has one answer, of the jobs it was accepted under.
TEST_F(Reload, InMidSearchCostsNoAnswer) {
  RunningDaemon daemon({"--config", dry_run()});
  Plc plc(daemon.port());
  ASSERT_TRUE(plc.waits_until_ready());
  bool is_quaternion = false;
  const Pose own = located(folder_.path("f.toml"), kScan)->matches[0].face_T_object;
  for (std::uint16_t number = 1; number <= 8; ++number) {
    is_quaternion = !is_quaternion;
    (void)dry_run(is_quaternion ? "convention = \"abb_quaternion\"" : "");
    EXPECT_TRUE(plc.write({number, 0, 1, 1}));
    daemon.signal(SIGHUP);
    EXPECT_TRUE(comes_true([&] { return plc.block()[Field::kDoneNumber] == number; }));
    const Plc::Block block = plc.block();
    EXPECT_TRUE(block.has(job::kValid));
    const auto told = static_cast<Convention>(block[Field::kConvention]);
    expect_pose(block, own, told);
  }
  EXPECT_EQ(daemon.stop(SIGTERM), 0) << daemon.log();
}

TEST(ChangedTables, AreNamedButForThoseThatMayChange) {
  using Names = std::vector<std::string>;
  const std::string before = "a = 1\n[b]\nx = [1, 2]\n[[job]]\nn = 1\n";
  EXPECT_EQ(changed_tables(before, before, {}), Names{});
  EXPECT_EQ(changed_tables(before, "# as it was\na=1\n[b]\nx=[1,2]\n[[job]]\nn=1\n", {}), Names{});
  EXPECT_EQ(changed_tables(before, "a = 1\n[b]\nx = [1, 3]\n[[job]]\nn = 2\n", {"job"}),
            Names{"b"});
  EXPECT_EQ(changed_tables(before, "[b]\nx = [1, 2]\n[c]\n", {"job"}), (Names{"a", "c"}));
}

}  // namespace
}  // namespace flatpose::daemon
