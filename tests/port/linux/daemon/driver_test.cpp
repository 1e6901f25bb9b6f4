// The daemon with a camera driver: the example, one led by the hand, and such as misbehave.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <cstring>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <random>
#include <sstream>

#include "port/linux/daemon/daemon.hpp"
#include "port/linux/daemon/driver_source.hpp"
#include "tests/port/linux/daemon/test_driver.hpp"
#include "tests/port/linux/files/temporary_folder.hpp"

namespace flatpose::daemon {
namespace {

using job::Answer;
using job::Refusal;
using result_map::Field;

const std::string kScan = FLATPOSE_EXAMPLE "/scan.pcd";
const std::string kTeach = FLATPOSE_EXAMPLE "/teach.pcd";

class Driver : public testing::Test {
 protected:
  std::string write_config(const std::string& more_of_source = "allow_simulated = true",
                           const std::string& more_of_job = "answer_by_ms = 600_000") const {
    return folder_.write(
        "f.toml",
        "[modbus]\nbind = \"127.0.0.1\"\nport = 0\n"
        "[search]\nscan_width_px = 400\nscan_height_px = 333\ncell_count = 600_000\n"
        "[source]\ndriver = \"c.sock\"\n" +
            more_of_source + "\n[[part]]\nname = \"pad\"\nfile = \"" +
            FLATPOSE_EXAMPLE "/pad.fpt\"\n[[job]]\nparts = [\"pad\"]\n" + more_of_job + "\n");
  }
  void serve(const std::string& config) {
    daemon_.emplace(std::vector<std::string>{"--config", config});
    plc_ = std::make_unique<Plc>(daemon_->port());
  }
  [[nodiscard]] std::string socket() const { return folder_.path("c.sock"); }
  /// Tells the daemon to go on and waits for what comes of it.
  Plc::Block done(std::uint16_t number) {
    Plc::Block seen;
    EXPECT_TRUE(comes_true([&] {
      seen = plc_->block();
      return seen[Field::kDoneNumber] == number || seen[Field::kRefusedNumber] == number;
    }));
    return seen;
  }
  bool is_ready(bool wanted = true) {
    return comes_true([&] { return plc_->block().has(job::kReady) == wanted; });
  }
  static Answer answer_of(const Plc::Block& block) {
    return static_cast<Answer>(block[Field::kStatus]);
  }
  static void expect_same_pose(const Plc::Block& one, const Plc::Block& other) {
    EXPECT_TRUE(one.has(job::kValid));
    for (const Field field :
         {Field::kPositionX, Field::kPositionY, Field::kPositionZ, Field::kRotation1,
          Field::kRotation2, Field::kRotation3, Field::kScore})
      EXPECT_EQ(one[field], other[field]);
  }

  port::TemporaryFolder folder_;
  std::optional<RunningDaemon> daemon_;
  std::unique_ptr<Plc> plc_;
};

TEST_F(Driver, GivesThePoseThatAReplayOfTheSameScanGives) {
  const std::string config = write_config();
  Plc::Block replayed;
  {
    RunningDaemon replay({"--config", config, "--scan", kScan});
    Plc plc(replay.port());
    ASSERT_TRUE(plc.waits_until_ready());
    replayed = plc.trigger(1);
  }
  serve(config);
  const RunningDriver driver(socket(), kScan);
  ASSERT_TRUE(is_ready());
  EXPECT_TRUE(plc_->block().has(job::kSimulated));
  const Plc::Block block = plc_->trigger(1);
  expect_same_pose(block, replayed);
  EXPECT_EQ(block[Field::kScannedNumber], 1);
  EXPECT_FALSE(block.has(job::kScanRepeated));
  const Plc::Block again = plc_->trigger(2);
  expect_same_pose(again, replayed);
  EXPECT_TRUE(again.has(job::kScanRepeated));
  EXPECT_EQ(daemon_->stop(SIGTERM), 0) << daemon_->log();
  EXPECT_FALSE(std::filesystem::exists(socket()));
}

TEST_F(Driver, LayoutsAreAllReadAlikeAndTheConfigMaySayWhatIsUp) {
  serve(write_config("allow_simulated = true\nup = \"+z\""));
  TestDriver driver(socket());
  ASSERT_TRUE(is_ready());
  port::Scan scan = port::read_scan(kScan);
  EXPECT_TRUE(plc_->write({1}));
  ASSERT_TRUE(driver.is_asked());
  driver.answer(scan);
  const Plc::Block interleaved = done(1);

  EXPECT_TRUE(plc_->write({2}));
  ASSERT_TRUE(driver.is_asked());
  flatpose_camera_scan planes = driver.put(scan);
  const flatpose_camera_scan as_planes = flatpose_camera_planes(scan.width_px, scan.height_px);
  planes.y_offset_bytes = as_planes.y_offset_bytes;
  planes.z_offset_bytes = as_planes.z_offset_bytes;
  planes.pixel_stride_bytes = as_planes.pixel_stride_bytes;
  planes.row_stride_bytes = as_planes.row_stride_bytes;
  planes.up = FLATPOSE_CAMERA_UP_MINUS_Z;
  const std::size_t count = scan.xyz_mm.size() / 3;
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t axis = 0; axis < 3; ++axis)
      driver.floats()[axis * count + i] = scan.xyz_mm[3 * i + axis];
  driver.answer(planes);
  const Plc::Block from_planes = done(2);
  expect_same_pose(from_planes, interleaved);
  EXPECT_TRUE(from_planes.has(job::kScanRepeated));
}

TEST_F(Driver, ReadyFollowsIt) {
  serve(write_config());
  EXPECT_EQ(plc_->trigger(1)[Field::kRefusedStatus], static_cast<int>(Refusal::kNotReady));
  {
    const RunningDriver driver(socket(), kScan);
    ASSERT_TRUE(is_ready());
    EXPECT_TRUE(plc_->trigger(2).has(job::kValid));
  }
  EXPECT_TRUE(is_ready(false));
  const RunningDriver other(socket(), kScan);
  EXPECT_TRUE(is_ready());
  EXPECT_TRUE(plc_->trigger(3).has(job::kValid));
}

TEST_F(Driver, ThatDiesInMidCaptureEndsTheCommandAndReadyAtOnce) {
  serve(write_config());
  {
    TestDriver driver(socket());
    ASSERT_TRUE(is_ready());
    EXPECT_TRUE(plc_->write({1}));
    ASSERT_TRUE(driver.is_asked());
    EXPECT_EQ(driver.request.number, 1);
    EXPECT_EQ(driver.request.job, 1);
  }
  const Plc::Block block = done(1);  // long before answer_by
  EXPECT_EQ(answer_of(block), Answer::kNoScan);
  EXPECT_FALSE(block.has(job::kValid));
  EXPECT_FALSE(block.has(job::kReady));
  TestDriver next(socket());
  ASSERT_TRUE(is_ready());
  EXPECT_TRUE(plc_->write({2}));
  ASSERT_TRUE(next.is_asked());
  next.answer(port::read_scan(kScan));
  EXPECT_TRUE(done(2).has(job::kValid));
  daemon_->stop(SIGTERM);
  EXPECT_NE(daemon_->log().find("command 1: camera driver 'test' was lost"), std::string::npos)
      << daemon_->log();
}

TEST_F(Driver, SaysWhyThereIsNoScan) {
  serve(write_config());
  TestDriver driver(socket());
  ASSERT_TRUE(is_ready());
  EXPECT_TRUE(plc_->write({1}));
  ASSERT_TRUE(driver.is_asked());
  EXPECT_EQ(flatpose_camera_failed(&driver.camera, &driver.request, "laser\nis off"),
            FLATPOSE_CAMERA_OK);
  EXPECT_EQ(answer_of(done(1)), Answer::kNoScan);
  EXPECT_TRUE(is_ready());
  daemon_->stop(SIGTERM);
  EXPECT_NE(daemon_->log().find("command 1: camera driver 'test': laser\\x0ais off\n"),
            std::string::npos)
      << daemon_->log();
}

TEST_F(Driver, LateAnswerIsNobodys) {
  serve(write_config("allow_simulated = true", "answer_by_ms = 300\ndeadline_ms = 300"));
  TestDriver driver(socket());
  ASSERT_TRUE(is_ready());
  EXPECT_TRUE(plc_->write({1, 0, static_cast<std::uint16_t>(job::Command::kCapture)}));
  ASSERT_TRUE(driver.is_asked());
  const flatpose_camera_request late = driver.request;
  EXPECT_TRUE(flatpose_camera_is_wanted(&driver.camera, &late));
  EXPECT_EQ(answer_of(done(1)), Answer::kAnswerLate);
  EXPECT_FALSE(flatpose_camera_is_wanted(&driver.camera, &late));
  EXPECT_TRUE(plc_->write({2, 0, static_cast<std::uint16_t>(job::Command::kCapture)}));
  ASSERT_TRUE(driver.is_asked());
  const flatpose_camera_scan scan = driver.put(port::read_scan(kScan));
  EXPECT_EQ(flatpose_camera_done(&driver.camera, &late, &scan), FLATPOSE_CAMERA_OK);
  // Were the late one taken for this one's, this would end well.
  EXPECT_EQ(answer_of(done(2)), Answer::kAnswerLate);
  EXPECT_EQ(plc_->block()[Field::kScannedNumber], 0);
}

TEST_F(Driver, IsToldWhenItsScanIsWantedNoMore) {
  serve(write_config());
  TestDriver driver(socket());
  ASSERT_TRUE(is_ready());
  EXPECT_TRUE(plc_->write({1}));
  ASSERT_TRUE(driver.is_asked());
  EXPECT_TRUE(flatpose_camera_is_wanted(&driver.camera, &driver.request));
  EXPECT_TRUE(plc_->write({2, 0, static_cast<std::uint16_t>(job::Command::kCancel)}));
  EXPECT_TRUE(
      comes_true([&] { return flatpose_camera_is_wanted(&driver.camera, &driver.request) == 0; }));
}

TEST_F(Driver, OnlyAScanBegunAfterAcceptanceCounts) {
  serve(write_config());
  TestDriver driver(socket());
  ASSERT_TRUE(is_ready());
  const port::Scan scan = port::read_scan(kScan);
  for (const std::int64_t before_us : {1, 0}) {
    const auto number = static_cast<std::uint16_t>(2 - before_us);
    EXPECT_TRUE(plc_->write({number}));
    ASSERT_TRUE(driver.is_asked());
    flatpose_camera_scan put = driver.put(scan);
    put.start_us = driver.request.accepted_us - before_us;
    driver.answer(put);
    EXPECT_EQ(done(number).has(job::kValid), before_us == 0);
  }
  daemon_->stop(SIGTERM);
  EXPECT_NE(daemon_->log().find("its acquisition began 0.0 ms before the command"),
            std::string::npos)
      << daemon_->log();
}

TEST_F(Driver, SaysWhetherItsScansAreSimulated) {
  serve(write_config(""));  // simulated ones make no pose
  const port::Scan scan = port::read_scan(kScan);
  std::uint16_t number = 0;
  for (const bool of_driver : {false, true}) {
    TestDriver driver(socket(), of_driver ? FLATPOSE_CAMERA_IS_SIMULATED : 0U);
    ASSERT_TRUE(is_ready());
    for (const bool of_scan : {false, true}) {
      EXPECT_TRUE(plc_->write({++number}));
      ASSERT_TRUE(driver.is_asked());
      flatpose_camera_scan put = driver.put(scan);
      put.flags = of_scan ? FLATPOSE_CAMERA_IS_SIMULATED : 0U;
      driver.answer(put);
      const Plc::Block block = done(number);
      const bool is_simulated = of_driver || of_scan;
      EXPECT_EQ(block.has(job::kValid), !is_simulated);
      EXPECT_EQ(block.has(job::kSimulated), is_simulated);
      EXPECT_EQ(answer_of(block), is_simulated ? Answer::kSimulated : Answer::kOk);
    }
    driver.leave();
    ASSERT_TRUE(is_ready(false));
  }
}

TEST_F(Driver, MayWriteOnWithoutChangingTheScanThatIsSearched) {
  serve(write_config());
  TestDriver driver(socket());
  ASSERT_TRUE(is_ready());
  const port::Scan scan = port::read_scan(kScan);
  Plc::Block first;
  for (const bool writes_on : {false, true}) {
    const auto number = static_cast<std::uint16_t>(writes_on ? 2 : 1);
    EXPECT_TRUE(plc_->write({number}));
    ASSERT_TRUE(driver.is_asked());
    driver.answer(scan);
    ASSERT_TRUE(comes_true([&] { return plc_->block()[Field::kScannedNumber] == number; }));
    if (writes_on) std::fill_n(driver.floats(), scan.xyz_mm.size(), 0.0F);
    if (!writes_on) first = done(number);
    expect_same_pose(done(number), first);
  }
  EXPECT_TRUE(plc_->write({3, 0, static_cast<std::uint16_t>(job::Command::kLocateInLast)}));
  expect_same_pose(done(3), first);
}

struct Wrong {
  const char* name;
  void (*change)(flatpose_camera_done_message&);
};

constexpr std::uint64_t kHuge = std::uint64_t{1} << 63;

const std::vector<Wrong> kWrong{
    {"no width", [](auto& done) { done.width_px = 0; }},
    {"one row", [](auto& done) { done.height_px = 1; }},
    {"negative", [](auto& done) { done.width_px = -400; }},
    {"too wide", [](auto& done) { done.width_px = 401; }},
    {"too high", [](auto& done) { done.height_px = std::numeric_limits<std::int32_t>::max(); }},
    {"stride 0", [](auto& done) { done.pixel_stride_bytes = 0; }},
    {"odd stride", [](auto& done) { done.pixel_stride_bytes = 13; }},
    {"long stride", [](auto& done) { done.pixel_stride_bytes = 1 << 20; }},
    {"huge stride", [](auto& done) { done.row_stride_bytes = kHuge; }},
    {"stride that wraps", [](auto& done) { done.row_stride_bytes = ~std::uint64_t{0} - 3; }},
    {"long rows", [](auto& done) { done.row_stride_bytes = 400 * 16 + 32; }},
    {"offset beyond", [](auto& done) { done.z_offset_bytes = 400 * 333 * 16; }},
    {"offset that wraps", [](auto& done) { done.x_offset_bytes = ~std::uint64_t{0} - 3; }},
    {"odd offset", [](auto& done) { done.y_offset_bytes = 5; }},
    {"no side", [](auto& done) { done.up = 0; }},
    {"third side", [](auto& done) { done.up = 3; }},
    {"unknown flag", [](auto& done) { done.flags = 6; }},
    {"ends early", [](auto& done) { done.end_us = done.start_us - 1; }},
    {"ends in the future", [](auto& done) { done.end_us += 3'600'000'000; }},
    {"began before the world", [](auto& done) { done.start_us = INT64_MIN; }},
};

TEST_F(Driver, EveryWrongAnswerIsNoScanAndTheNextIsSound) {
  serve(write_config());
  TestDriver driver(socket());
  ASSERT_TRUE(is_ready());
  const port::Scan scan = port::read_scan(kScan);
  std::uint16_t number = 0;
  for (const Wrong& wrong : kWrong) {
    SCOPED_TRACE(wrong.name);
    EXPECT_TRUE(plc_->write({++number}));
    ASSERT_TRUE(driver.is_asked());
    flatpose_camera_done_message message = driver.message_of(driver.put(scan));
    wrong.change(message);
    EXPECT_TRUE(driver.send(&message, sizeof message));
    EXPECT_EQ(answer_of(done(number)), Answer::kNoScan);
  }
  for (const float value_mm : {std::numeric_limits<float>::infinity(), -1.1e6F}) {
    EXPECT_TRUE(plc_->write({++number}));
    ASSERT_TRUE(driver.is_asked());
    const flatpose_camera_scan put = driver.put(scan);
    driver.floats()[scan.xyz_mm.size() - 1] = value_mm;
    driver.answer(put);
    EXPECT_EQ(answer_of(done(number)), Answer::kNoScan);
  }
  EXPECT_TRUE(plc_->write({++number}));
  ASSERT_TRUE(driver.is_asked());
  driver.answer(scan);
  EXPECT_TRUE(done(number).has(job::kValid));
}

TEST_F(Driver, WhoSpeaksOtherwiseIsClosedAndTheDaemonGoesOn) {
  serve(write_config());
  std::mt19937 random(5);
  const auto garbage = [&](std::size_t size) {
    Bytes bytes(size);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    return bytes;
  };
  for (std::size_t size = 1; size <= 300; ++size) {  // before and after hello
    TestDriver driver(socket());
    ASSERT_EQ(driver.status, FLATPOSE_CAMERA_OK) << size;
    Bytes bytes = garbage(size);
    const flatpose_camera_head alike =
        TestDriver::head(static_cast<std::uint16_t>(size % 10), size, 0);
    if (size >= sizeof alike && size % 2 == 0) std::memcpy(bytes.data(), &alike, sizeof alike);
    const bool is_message = size == sizeof(flatpose_camera_reason_message) ||
                            size == sizeof(flatpose_camera_done_message) || size == sizeof alike;
    driver.send(bytes.data(), bytes.size());
    if (is_message) driver.send(bytes.data(), bytes.size() - 1);
    EXPECT_TRUE(driver.is_closed()) << size;
  }
  for (const int change : {0, 1, 2}) {
    TestDriver driver(socket());
    flatpose_camera_head alive = TestDriver::head(FLATPOSE_CAMERA_KIND_ALIVE, sizeof alive, 0);
    if (change == 0) alive.version = 2;
    if (change == 1) alive.magic ^= 1;
    if (change == 2) alive.size_bytes += 4;
    driver.send(&alive, sizeof alive);
    EXPECT_TRUE(driver.is_closed());
  }
  {
    const TestDriver driver(socket());
    driver.send("", 0);
    EXPECT_TRUE(driver.is_closed());
  }
  {
    const TestDriver flood(socket());
    const flatpose_camera_head alive =
        TestDriver::head(FLATPOSE_CAMERA_KIND_ALIVE, sizeof alive, 0);
    for (int i = 0; i < 100'000 && flood.send(&alive, sizeof alive); ++i) {
    }
    EXPECT_TRUE(flood.is_closed());
  }
  TestDriver driver(socket());
  ASSERT_TRUE(is_ready());
  EXPECT_TRUE(plc_->write({1}));
  ASSERT_TRUE(driver.is_asked());
  driver.answer(port::read_scan(kScan));
  EXPECT_TRUE(done(1).has(job::kValid));
  EXPECT_EQ(daemon_->stop(SIGTERM), 0) << daemon_->log();
}

/// A connection that has said nothing yet.
class Stranger {
 public:
  explicit Stranger(const std::string& path) {
    sockaddr_un name{};
    name.sun_family = AF_UNIX;
    path.copy(name.sun_path, sizeof name.sun_path - 1);
    socket_ = ::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
    EXPECT_EQ(connect(socket_, reinterpret_cast<sockaddr*>(&name), sizeof name), 0);
  }
  ~Stranger() { close(socket_); }
  Stranger(const Stranger&) = delete;
  Stranger& operator=(const Stranger&) = delete;
  void send(const Bytes& bytes) const {
    (void)!::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  }
  /// Why it was turned away; empty: it was not.
  [[nodiscard]] std::string refusal() const {
    flatpose_camera_reason_message message{};
    const ssize_t size = recv(socket_, &message, sizeof message, 0);
    return size == sizeof message ? message.reason : "";
  }

 private:
  int socket_ = -1;
};

TEST_F(Driver, StrangersAreTurnedAwayWithAReason) {
  serve(write_config());
  const Stranger silent(socket());
  const Stranger wordy(socket());
  wordy.send(Bytes(88, 7));
  EXPECT_NE(wordy.refusal().find("does not say hello as version 1"), std::string::npos);
  EXPECT_EQ(silent.refusal(), "it says nothing");
  std::vector<std::unique_ptr<Stranger>> crowd;
  for (int i = 0; i < 100; ++i) crowd.push_back(std::make_unique<Stranger>(socket()));
  for (const auto& one : crowd) EXPECT_NE(one->refusal(), "");
  const RunningDriver driver(socket(), kScan);
  EXPECT_TRUE(is_ready());
  EXPECT_TRUE(plc_->trigger(1).has(job::kValid));
}

TEST_F(Driver, SecondIsRefusedWhileTheFirstLivesAndTakesThePlaceOfOneThatHangs) {
  serve(write_config());
  TestDriver first(socket(), 0, "first");
  ASSERT_TRUE(is_ready());
  TestDriver second(socket(), 0, "second");
  EXPECT_EQ(second.status, FLATPOSE_CAMERA_TURNED_AWAY);
  EXPECT_EQ(std::string(second.camera.reason), "'first' is the driver already");
  // The first says nothing more, and does not leave either.
  EXPECT_TRUE(is_ready(false));
  TestDriver third(socket(), FLATPOSE_CAMERA_IS_SIMULATED, "third");
  EXPECT_EQ(third.status, FLATPOSE_CAMERA_OK);
  EXPECT_TRUE(first.is_closed());
  EXPECT_TRUE(is_ready());
  EXPECT_TRUE(plc_->write({1}));
  ASSERT_TRUE(third.is_asked());
  third.answer(port::read_scan(kScan));
  EXPECT_TRUE(done(1).has(job::kValid));
}

TEST_F(Driver, IsToldOfTheDaemonsEndAndComesBackByItself) {
  const std::string config = write_config();
  serve(config);
  TestDriver held(socket());
  ASSERT_TRUE(is_ready());
  EXPECT_EQ(daemon_->stop(SIGKILL), -1);
  EXPECT_FALSE(held.is_asked());
  EXPECT_EQ(held.status, FLATPOSE_CAMERA_LOST);
  EXPECT_TRUE(std::filesystem::exists(socket()));  // left over, and replaced
  serve(config);
  const RunningDriver driver(socket(), kScan);
  ASSERT_TRUE(is_ready());
  EXPECT_EQ(daemon_->stop(SIGTERM), 0);
  serve(config);
  EXPECT_TRUE(is_ready());
  EXPECT_TRUE(plc_->trigger(1).has(job::kValid));
}

// Without a bus, so that it is faster than one.
TEST_F(Driver, MayAnswerAsOftenAsItIsAsked) {
  const Config config = load_config(write_config());
  std::vector<float> one(3 * 400 * 333);
  std::vector<float> two(3 * 400 * 333);
  Doorbell bell;
  std::ostringstream lines;
  Log log(lines);
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  DriverSource source(config, {std::span(one), std::span(two)}, bell, nowhere, log);
  source.start();
  TestDriver driver(socket());
  port::Scan scan;
  scan.xyz_mm.resize(12);
  scan.width_px = scan.height_px = 2;
  for (std::uint32_t ticket = 1; ticket <= 3 * FLATPOSE_CAMERA_MESSAGES_PER_SECOND_MAX; ++ticket) {
    const std::int64_t now_us = flatpose_camera_now_us();
    source.request({ticket, 1, 1, now_us, now_us + 600'000'000});
    ASSERT_TRUE(driver.is_asked());
    driver.answer(scan);
    const HeldScan* held = nullptr;
    while (held == nullptr) held = source.take(0);
    ASSERT_EQ(held->failure, "") << ticket;
    ASSERT_EQ(held->number, ticket);
  }
  close(nowhere);
}

std::string refusal_of(const std::string& config) {
  std::ostringstream out;
  std::ostringstream err;
  const std::vector<std::string> words{"--config", config};
  EXPECT_EQ(run_daemon(words, out, err), 2) << err.str();
  return err.str();
}

TEST_F(Driver, OfTheExampleInCIsServed) {
  serve(write_config());
  const RunningProgram driver({FLATPOSE_CAMERA_DRIVER, socket()});
  ASSERT_TRUE(is_ready());
  const Plc::Block block = plc_->trigger(1, 0, static_cast<std::uint16_t>(job::Command::kCapture));
  EXPECT_EQ(answer_of(block), Answer::kOk);
  EXPECT_EQ(block[Field::kScannedNumber], 1);
  EXPECT_TRUE(block.has(job::kSimulated));
}

TEST_F(Driver, SocketIsTheDaemonsAlone) {
  const std::string config = write_config();
  serve(config);
  struct stat found {};
  ASSERT_EQ(stat(socket().c_str(), &found), 0);
  EXPECT_TRUE(S_ISSOCK(found.st_mode));
  EXPECT_EQ(found.st_mode & 0777, 0660U);
  const std::string refused = refusal_of(config);
  EXPECT_NE(refused.find("f.toml:9: cannot listen on "), std::string::npos) << refused;
  EXPECT_NE(refused.find("another process listens there"), std::string::npos) << refused;
  const RunningDriver driver(socket(), kScan);
  EXPECT_TRUE(is_ready());  // the first has lost nothing by it
  EXPECT_EQ(daemon_->stop(SIGTERM), 0);

  folder_.write("c.sock", "a file of somebody's");
  EXPECT_NE(refusal_of(config).find("no socket"), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(socket()));
}

TEST_F(Driver, PathThatCannotBeIsRefused) {
  for (const std::string& path : {std::string("no/c.sock"), std::string(200, 'c')}) {
    const std::string config =
        folder_.write("g.toml",
                      "[search]\nscan_width_px = 9\nscan_height_px = 9\ncell_count = 10_000\n"
                      "[source]\ndriver = \"" +
                          path + "\"\n");
    EXPECT_NE(refusal_of(config).find("g.toml:6: cannot listen on "), std::string::npos);
  }
}

}  // namespace
}  // namespace flatpose::daemon
