// What the daemon leaves on disk, by the program itself.

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "port/linux/daemon/config_map.hpp"
#include "port/linux/tool/tool.hpp"
#include "tests/port/linux/daemon/running_daemon.hpp"
#include "tests/port/linux/files/temporary_folder.hpp"

namespace flatpose::daemon {
namespace {

namespace fs = std::filesystem;
using job::Answer;
using nlohmann::json;
using result_map::Field;

constexpr auto kSave = static_cast<std::uint16_t>(job::Command::kSaveScan);

json read_json(const std::string& path) {
  std::ifstream file(path);
  const json read = json::parse(file, nullptr, false);
  return read.is_object() ? read : json::object();
}

std::size_t count_in(const std::string& text, const std::string& word) {
  std::size_t count = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1))
    ++count;
  return count;
}

struct Records : testing::Test {
  /// Job 1 finds the pad, job 2 finds it where it must not be.
  std::string config(const std::string& records) const {
    return folder.write(
        "f.toml",
        "[modbus]\nbind = \"127.0.0.1\"\nport = 0\n[records]\n" + records +
            "\n[search]\nscan_width_px = 400\nscan_height_px = 333\ncell_count = 600_000\n"
            "[source]\nallow_simulated = true\nreplay = \"" FLATPOSE_EXAMPLE
            "/scan.pcd\"\n[[part]]\nname = \"pad\"\nfile = \"" FLATPOSE_EXAMPLE
            "/pad.fpt\"\n[[job]]\nparts = [\"pad\"]\n"
            "[[job]]\nnumber = 2\nparts = [\"pad\"]\nlimit_x_mm = [500, 600]\n");
  }
  [[nodiscard]] std::string path(const std::string& name) const {
    return folder.path("records/" + name);
  }
  [[nodiscard]] json last() const { return read_json(path("last.json")); }
  /// And then the next one is kept too.
  [[nodiscard]] bool waits_for_record(std::uint16_t number) const {
    return comes_true([&] { return last()["number"] == number; });
  }
  [[nodiscard]] std::vector<std::string> names(const std::string& start,
                                               const std::string& extension) const {
    std::vector<std::string> found;
    for (const auto& entry : fs::directory_iterator(folder.path("records"))) {
      const std::string name = entry.path().filename().string();
      if (name.starts_with(start) && name.ends_with(extension)) found.push_back(name);
    }
    std::sort(found.begin(), found.end());
    return found;
  }
  port::TemporaryFolder folder;
};

TEST_F(Records, AreReadBackByTheToolWithTheSameResult) {
  RunningDaemon daemon({"--config", config("folder = \"records\"")});
  Plc plc(daemon.port());
  ASSERT_TRUE(plc.waits_until_ready());
  const auto block = plc.trigger(21);
  ASSERT_TRUE(waits_for_record(21));
  const json record = last();
  EXPECT_EQ(record["command"], "locate");
  EXPECT_EQ(record["job"], 1);
  EXPECT_EQ(record["scan"]["number"], block[Field::kScanNumber]);
  EXPECT_EQ(record["scan"]["simulated"], true);
  const json& told = record["told"]["matches"][0]["position_mm"];
  EXPECT_EQ(std::floor(told[0].get<double>() / 0.001 + 0.5), block[Field::kPositionX]);
  const json& times = record["times_us"];
  EXPECT_LE(times["accepted"], times["acquired"]);
  EXPECT_LE(times["acquired"], times["begun"]);
  EXPECT_LE(times["begun"], times["ended"]);
  EXPECT_LE(times["ended"], times["said"]);
  EXPECT_LE(times["said"], times["copied"]);
  EXPECT_LE(times["ended"], times["posted"]);

  std::ostringstream out;
  std::ostringstream err;
  const std::string scan = path(record["scan"]["file"]);
  const std::vector<std::string> args{"locate", FLATPOSE_EXAMPLE "/pad.fpt", scan, "--json"};
  ASSERT_EQ(tool::run_tool(args, out, err, read_served_map), 0) << err.str();
  const json located = json::parse(out.str());
  EXPECT_EQ(record["digest"], located["digest"]);
  for (const char* const key : {"status", "frame", "up", "part", "matches"})
    EXPECT_EQ(record[key], located[key]) << key;
  for (const auto& [key, value] : located.items()) EXPECT_TRUE(record.contains(key)) << key;
  EXPECT_TRUE(comes_true([&] { return fs::exists(path("last.png")); }));
  std::ifstream png(path("last.png"), std::ios::binary);
  char head[4] = "";
  png.read(head, 4);
  EXPECT_EQ(std::string(head + 1, 3), "PNG");
}

TEST_F(Records, KeepTheLastAndTheFailedAcrossRestarts) {
  const std::string file = config("folder = \"records\"\npicture = false\nlast = 2\nfailed = 3");
  std::uint16_t number = 0;
  for (int start = 0; start < 2; ++start) {
    RunningDaemon daemon({"--config", file});
    Plc plc(daemon.port());
    ASSERT_TRUE(plc.waits_until_ready());
    for (const int job : {2, 2, 2, 2, 1, 1, 1}) {
      plc.trigger(++number, 0, 1, static_cast<std::uint16_t>(job));
      ASSERT_TRUE(waits_for_record(number));
    }
    EXPECT_EQ(plc.block()[Field::kBootCount], start + 1);
    EXPECT_EQ(daemon.stop(SIGTERM), 0) << daemon.log();
  }
  const auto found = names("record-", "-found-ok.json");
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].substr(0, 17), "record-0000000013");
  EXPECT_EQ(found[1].substr(0, 17), "record-0000000014");
  const auto failed = names("record-", "-failed-outside_limits.pcd");
  ASSERT_EQ(failed.size(), 3U);
  EXPECT_EQ(failed[0].substr(0, 17), "record-0000000009");
  EXPECT_EQ(failed[2].substr(0, 17), "record-0000000011");
  EXPECT_EQ(names("record-", "").size(), 10U);
}

TEST_F(Records, EveryAnswerIsEitherKeptOrCountedAsDropped) {
  RunningDaemon daemon({"--config", config("folder = \"records\"\npicture = false\nlast = 1000")});
  Plc plc(daemon.port());
  ASSERT_TRUE(plc.waits_until_ready());
  std::uint16_t number = 0;
  while (number < 25) EXPECT_EQ(plc.trigger(++number)[Field::kDoneNumber], number);
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (last()["number"] != number && std::chrono::steady_clock::now() < end) {
    plc.trigger(++number);  // dropped as well, or the last that is kept
    for (int i = 0; i < 40 && last()["number"] != number; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  const auto dropped = last()["dropped"].get<std::size_t>();
  EXPECT_EQ(names("record-", ".json").size() + dropped, number);
  EXPECT_EQ(names("record-", ".pcd").size() + dropped, number);
}

TEST_F(Records, ScanIsSavedWhenTheMasterSaysSoUpToTheirCount) {
  RunningDaemon daemon(
      {"--config", config("folder = \"records\"\npicture = false\nlast = 1\nsaved = 1")});
  Plc plc(daemon.port());
  ASSERT_TRUE(plc.waits_until_ready());
  const auto save = [&](std::uint16_t number) {
    const auto block = plc.trigger(number, 0, kSave);
    EXPECT_EQ(block[Field::kDoneNumber], number);
    return static_cast<Answer>(block[Field::kStatus]);
  };
  EXPECT_EQ(save(1), Answer::kNotSaved);  // there is no scan yet
  plc.trigger(2);
  EXPECT_EQ(save(3), Answer::kOk);
  EXPECT_EQ(names("saved-", "-n00003.pcd").size(), 1U);
  EXPECT_EQ(save(4), Answer::kNotSaved);
  EXPECT_TRUE(plc.block().has(job::kError));
  for (std::uint16_t number = 5; number < 8; ++number) {
    plc.trigger(number);
    ASSERT_TRUE(waits_for_record(number));
  }
  EXPECT_EQ(names("saved-", "").size(), 2U);
  EXPECT_EQ(names("record-", "").size(), 2U);
  daemon.stop(SIGTERM);
  EXPECT_EQ(count_in(daemon.log(), "command 4: "), 1U) << daemon.log();
}

TEST_F(Records, PickIsAddedToItsRecordAndCounted) {
  RunningDaemon daemon({"--config", config("folder = \"records\"\npicture = false")});
  Plc plc(daemon.port());
  ASSERT_TRUE(plc.waits_until_ready());
  const auto report = [&](std::uint16_t number, std::uint16_t of, job::PickOutcome outcome) {
    EXPECT_TRUE(plc.write({number, 0, static_cast<std::uint16_t>(job::Command::kReportPick), 1, of,
                           static_cast<std::uint16_t>(outcome)}));
    EXPECT_TRUE(comes_true([&] { return plc.block()[Field::kDoneNumber] == number; }));
    EXPECT_EQ(plc.block()[Field::kStatus], 0);
  };
  plc.trigger(1);
  ASSERT_TRUE(waits_for_record(1));
  plc.trigger(2);
  report(3, 2, job::PickOutcome::kPicked);
  report(4, 1, job::PickOutcome::kMissed);
  report(5, 999, job::PickOutcome::kMissed);
  EXPECT_TRUE(comes_true([&] { return read_json(path("picks.json"))["missed"] == 2; }));
  EXPECT_EQ(read_json(path("picks.json"))["picked"], 1);
  EXPECT_EQ(last()["number"], 2);
  EXPECT_EQ(last()["picks"][0]["name"], "picked");
  const auto records = names("record-", ".json");
  ASSERT_EQ(records.size(), 2U);
  EXPECT_EQ(read_json(path(records[0]))["picks"][0]["name"], "missed");
  EXPECT_EQ(read_json(path(records[1])), last());
  daemon.stop(SIGTERM);
  EXPECT_EQ(count_in(daemon.log(), "pick of command 999: "), 1U) << daemon.log();
  EXPECT_EQ(count_in(daemon.log(), "pick of command "), 1U) << daemon.log();
}

// A file that may not grow is what an unprivileged process can be given for a full disk.
TEST_F(Records, FullDiskCostsOneLineAndNoAnswer) {
  RunningDaemon daemon({"--config", config("folder = \"records\"\npicture = false")});
  Plc plc(daemon.port());
  ASSERT_TRUE(plc.waits_until_ready());
  plc.trigger(1);
  ASSERT_TRUE(waits_for_record(1));
  const auto allow = [&](rlim_t bytes) {
    const rlimit limit{bytes, RLIM_INFINITY};
    EXPECT_EQ(prlimit(daemon.pid(), RLIMIT_FSIZE, &limit, nullptr), 0);
  };
  allow(1000);
  for (std::uint16_t number = 2; number < 9; ++number) {
    const auto block = plc.trigger(number);
    EXPECT_EQ(block[Field::kDoneNumber], number);
    EXPECT_TRUE(block.has(job::kValid));
  }
  EXPECT_EQ(plc.trigger(9, 0, kSave)[Field::kStatus], static_cast<int>(Answer::kNotSaved));
  EXPECT_EQ(names("record-", "").size(), 2U);
  EXPECT_EQ(names(".", "").size(), 0U);  // nothing half-written
  allow(RLIM_INFINITY);
  plc.trigger(10);
  EXPECT_TRUE(waits_for_record(10));
  EXPECT_EQ(daemon.stop(SIGTERM), 0);
  EXPECT_EQ(count_in(daemon.log(), "no record: "), 1U) << daemon.log();
  EXPECT_EQ(count_in(daemon.log(), "records are written again"), 1U) << daemon.log();
}

TEST_F(Records, FolderThatIsTakenAwayCostsOneLineAndNoAnswer) {
  const port::TemporaryFolder base;
  fs::create_directory(base.path("disk"));
  RunningDaemon daemon({"--config", config("folder = \"" + base.path("disk/records") + "\"")});
  Plc plc(daemon.port());
  ASSERT_TRUE(plc.waits_until_ready());
  plc.trigger(1);
  ASSERT_TRUE(comes_true([&] { return fs::exists(base.path("disk/records/last.png")); }));
  fs::rename(base.path("disk"), base.path("gone"));
  for (std::uint16_t number = 2; number < 9; ++number)
    EXPECT_TRUE(plc.trigger(number).has(job::kValid));
  fs::rename(base.path("gone"), base.path("disk"));
  std::uint16_t number = 9;
  EXPECT_TRUE(comes_true([&] {
    plc.trigger(number++);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    return read_json(base.path("disk/records/last.json"))["number"] >= 9;
  }));
  EXPECT_EQ(daemon.stop(SIGTERM), 0);
  EXPECT_EQ(count_in(daemon.log(), "no record: "), 1U) << daemon.log();
}

TEST_F(Records, CountStartsOnlyWhereThereIsAPlaceForIt) {
  const auto boots_of = [&](const std::string& records) {
    RunningDaemon daemon({"--config", config(records)});
    Plc plc(daemon.port());
    const auto boots = plc.block()[Field::kBootCount];
    EXPECT_EQ(daemon.stop(SIGTERM), 0) << daemon.log();
    return std::pair(boots, daemon.log());
  };
  EXPECT_EQ(boots_of("state = \"s.json\"").first, 1);
  EXPECT_EQ(boots_of("state = \"s.json\"").first, 2);
  folder.write("s.json", "{\"boot_count\": ");
  const auto [boots, log] = boots_of("state = \"s.json\"");
  EXPECT_EQ(boots, 1);
  EXPECT_EQ(count_in(log, "warning: starts are counted anew"), 1U) << log;
  EXPECT_EQ(boots_of("state = \"s.json\"").first, 2);
}

}  // namespace
}  // namespace flatpose::daemon
