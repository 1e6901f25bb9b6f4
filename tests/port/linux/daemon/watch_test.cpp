// The daemon with a folder that a camera's program writes to.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <spng.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <sstream>

#include "tests/port/linux/daemon/running_daemon.hpp"
#include "tests/port/linux/files/made_files.hpp"
#include "tests/port/linux/files/temporary_folder.hpp"

namespace flatpose::daemon {
namespace {

namespace fs = std::filesystem;
using job::Answer;
using job::Command;
using job::Refusal;
using result_map::Field;

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  return bytes.str();
}

constexpr auto kCapture = static_cast<std::uint16_t>(Command::kCapture);

class Watch : public testing::Test {
 protected:
  /// Job 1 waits for as long as it takes, job 2 for a moment.
  void serve(const std::string& more_of_source = "allow_simulated = true") {
    const std::string config = config_folder_.write(
        "f.toml",
        "[modbus]\nbind = \"127.0.0.1\"\nport = 0\n"
        "[search]\nscan_width_px = 400\nscan_height_px = 333\ncell_count = 600_000\n"
        "[source]\nwatch = \"" +
            folder_.path() + "\"\n" + more_of_source + "\n[[part]]\nname = \"pad\"\nfile = \"" +
            FLATPOSE_EXAMPLE
            "/pad.fpt\"\n"
            "[[job]]\nparts = [\"pad\"]\nanswer_by_ms = 600_000\n"
            "[[job]]\nnumber = 2\nparts = [\"pad\"]\nanswer_by_ms = 400\ndeadline_ms = 400\n");
    daemon_.emplace(std::vector<std::string>{"--config", config});
    plc_ = std::make_unique<Plc>(daemon_->port());
    ASSERT_TRUE(plc_->waits_until_ready());
  }
  [[nodiscard]] bool is_done(std::uint16_t number) const {
    block_ = plc_->block();
    return block_[Field::kDoneNumber] == number;
  }
  [[nodiscard]] std::string new_name() const { return "s" + std::to_string(++names_); }
  /// Triggers, and has the camera's program do its work again and again: what it does before the
  /// daemon looks at the folder for this trigger does not count.
  Plc::Block located(const std::function<void()>& write, std::uint16_t command = 1) {
    EXPECT_TRUE(plc_->write({++number_, 0, command, 1}));
    EXPECT_TRUE(comes_true([&] {
      write();
      for (int i = 0; i < 20 && !is_done(number_); ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
      return is_done(number_);
    }));
    return block_;
  }
  /// Triggers, has it done once after that, and expects that it does not count.
  void expect_none(const std::function<void()>& write) {
    EXPECT_TRUE(plc_->write({++number_, 0, kCapture, 2}));
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    write();
    EXPECT_TRUE(comes_true([&] { return is_done(number_); }));
    EXPECT_EQ(answer(), Answer::kAnswerLate);
    EXPECT_EQ(block_[Field::kScannedNumber], 0);
  }
  [[nodiscard]] Answer answer() const { return static_cast<Answer>(block_[Field::kStatus]); }
  void write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_.path(name), std::ios::binary) << bytes;
  }

  const std::string scan_ = bytes_of(FLATPOSE_EXAMPLE "/scan.pcd");
  port::TemporaryFolder config_folder_;
  port::TemporaryFolder folder_;
  std::optional<RunningDaemon> daemon_;
  std::unique_ptr<Plc> plc_;
  mutable Plc::Block block_;
  mutable int names_ = 0;
  std::uint16_t number_ = 0;
};

TEST_F(Watch, GivesThePoseThatAReplayOfTheSameScanGives) {
  serve();
  EXPECT_FALSE(plc_->block().has(job::kSimulated));  // nothing has said so yet
  const Plc::Block block = located([&] { write(new_name() + ".pcd", scan_); });
  EXPECT_TRUE(block.has(job::kValid));
  EXPECT_TRUE(block.has(job::kSimulated));
  EXPECT_FALSE(block.has(job::kScanRepeated));
  EXPECT_TRUE(located([&] { write(new_name() + ".pcd", scan_); }).has(job::kScanRepeated));
  EXPECT_EQ(folder_.file_count(), static_cast<std::size_t>(names_));  // nothing was removed
  RunningDaemon replay(
      {"--config", config_folder_.path("f.toml"), "--scan", FLATPOSE_EXAMPLE "/scan.pcd"});
  Plc plc(replay.port());
  ASSERT_TRUE(plc.waits_until_ready());
  const Plc::Block replayed = plc.trigger(1);
  for (const Field field :
       {Field::kPositionX, Field::kPositionY, Field::kPositionZ, Field::kRotation1, Field::kScore})
    EXPECT_EQ(block[field], replayed[field]);
}

TEST_F(Watch, ScanThatDoesNotSayItIsSimulatedMakesAPose) {
  serve("");
  EXPECT_EQ(located([&] { write(new_name() + ".pcd", scan_); })[Field::kStatus],
            static_cast<int>(Answer::kSimulated));
  std::string taken = scan_;
  taken.erase(taken.find("# flatpose: simulated\n"), std::string("# flatpose: simulated\n").size());
  const Plc::Block block = located([&] { write(new_name() + ".pcd", taken); });
  EXPECT_TRUE(block.has(job::kValid));
  EXPECT_FALSE(block.has(job::kSimulated));
  EXPECT_TRUE(block.has(job::kScanRepeated));  // the points are the same
}

TEST_F(Watch, OnlyAFileBegunAfterAcceptanceCounts) {
  write("there.pcd", scan_);
  serve();
  write("before.pcd", scan_);
  expect_none([] {});
  std::ofstream slow(folder_.path("slow.pcd"), std::ios::binary);
  slow << scan_.substr(0, scan_.size() / 2) << std::flush;
  expect_none([&] {
    slow << scan_.substr(scan_.size() / 2);
    slow.close();
  });
  expect_none([&] { write("there.pcd", scan_); });  // written over in place
  write("waits.part", scan_);
  expect_none([&] { fs::rename(folder_.path("waits.part"), folder_.path("waits.pcd")); });
  // Finished elsewhere long before the trigger, and moved in late.
  const port::TemporaryFolder elsewhere;
  (void)elsewhere.write("late.pcd", scan_);
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  expect_none([&] { fs::rename(elsewhere.path("late.pcd"), folder_.path("late.pcd")); });
  EXPECT_TRUE(located([&] { write(new_name() + ".pcd", scan_); }).has(job::kValid));
  daemon_->stop(SIGTERM);
  for (const char* const line :
       {"command 2: slow.pcd was finished in time, but began before the command",
        "command 3: there.pcd was finished", "command 4: waits.pcd was finished",
        "command 5: late.pcd was moved in after the command, but is older"})
    EXPECT_NE(daemon_->log().find(line), std::string::npos) << daemon_->log();
}

TEST_F(Watch, UnfinishedAndHiddenFilesAreNone) {
  serve();
  std::optional<std::ofstream> open;
  expect_none([&] {
    open.emplace(folder_.path("open.pcd"), std::ios::binary);
    *open << scan_ << std::flush;
    write(".hidden.pcd", scan_);
    write("a.pcd.tmp", scan_);
    write("a.part", scan_);
    write("note.txt", "not a scan");
    fs::create_directory(folder_.path("folder.pcd"));
  });
  open.reset();
}

TEST_F(Watch, FileRenamedInTheFolderOrMovedIntoItCounts) {
  serve();
  const port::TemporaryFolder elsewhere;
  EXPECT_TRUE(located([&] {
                const std::string name = new_name();
                write(name + ".tmp", scan_);
                fs::rename(folder_.path(name + ".tmp"), folder_.path(name + ".pcd"));
              }).has(job::kValid));
  EXPECT_TRUE(located([&] {
                const std::string name = new_name() + ".pcd";
                (void)elsewhere.write(name, scan_);
                fs::rename(elsewhere.path(name), folder_.path(name));
              }).has(job::kValid));
}

TEST_F(Watch, BrokenFileIsNoScanAndTheNextIsSound) {
  serve();
  const std::string half = scan_.substr(0, scan_.size() / 2);
  EXPECT_EQ(located([&] { write(new_name() + ".pcd", half); })[Field::kStatus],
            static_cast<int>(Answer::kNoScan));
  EXPECT_TRUE(plc_->block().has(job::kReady));
  EXPECT_TRUE(located([&] { write(new_name() + ".pcd", scan_); }).has(job::kValid));
  daemon_->stop(SIGTERM);
  EXPECT_NE(daemon_->log().find("command 1: " + folder_.path("s")), std::string::npos)
      << daemon_->log();
}

TEST_F(Watch, DepthImageCountsWhenItsCameraIsThereToo) {
  const std::string camera = R"({"fx": 500, "fy": 500, "cx": 4, "cy": 4, "depth_scale": 0.1})";
  const std::string image = port::depth_png_of(8, 8, std::vector<std::uint16_t>(64, 9000));
  serve();
  expect_none([&] { write("lone.png", image); });
  expect_none([&] { write("lone2.json", camera); });
  expect_none([&] {  // its camera is still being written
    const int open = ::open(folder_.path("half.json").c_str(), O_WRONLY | O_CREAT, 0600);
    write("half.png", image);
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    close(open);
  });
  const auto status = [&](const std::function<void()>& write_pair) {
    return located(write_pair, kCapture)[Field::kStatus];
  };
  EXPECT_EQ(status([&] {
              const std::string name = new_name();
              write(name + ".png", image);
              write(name + ".json", camera);
            }),
            0);
  EXPECT_EQ(status([&] {
              const std::string name = new_name();
              write(name + ".json", camera);
              write(name + ".png", image);
            }),
            0);
  EXPECT_EQ(status([&] { write(new_name() + ".json", "{}"); }), static_cast<int>(Answer::kNoScan));
  EXPECT_EQ(status([&] { write(new_name() + ".json", std::string(port::kSickJson)); }), 0);
}

TEST_F(Watch, FolderThatGoesEndsTheCommandAndReadyUntilItComesBack) {
  serve();
  EXPECT_TRUE(plc_->write({++number_}));
  // The daemon may not yet have begun to watch for this trigger: then it is refused the folder.
  fs::remove_all(folder_.path());
  EXPECT_TRUE(comes_true([&] { return is_done(number_); }));
  EXPECT_EQ(answer(), Answer::kNoScan);
  EXPECT_FALSE(block_.has(job::kReady));
  EXPECT_EQ(plc_->trigger(++number_)[Field::kRefusedStatus], static_cast<int>(Refusal::kNotReady));
  fs::create_directory(folder_.path());
  ASSERT_TRUE(plc_->waits_until_ready());
  EXPECT_TRUE(located([&] { write(new_name() + ".pcd", scan_); }).has(job::kValid));
}

TEST_F(Watch, WaitsAtTheStartForAFolderThatIsNotThere) {
  fs::remove_all(folder_.path());
  const std::string config =
      config_folder_.write("f.toml",
                           "[modbus]\nbind = \"127.0.0.1\"\nport = 0\n[search]\nscan_width_px = 9\n"
                           "scan_height_px = 9\ncell_count = 10_000\n[source]\nwatch = \"" +
                               folder_.path() + "\"\n");
  RunningDaemon daemon({"--config", config});
  Plc plc(daemon.port());
  EXPECT_EQ(plc.trigger(1, 0, kCapture)[Field::kRefusedNumber], 1);
  EXPECT_FALSE(plc.block().has(job::kReady));
  fs::create_directory(folder_.path());
  EXPECT_TRUE(plc.waits_until_ready());
}

}  // namespace
}  // namespace flatpose::daemon
