// The whole result's frame as the node sends it: when, before what, and when not.

#include <gtest/gtest.h>

#include <set>

#include "tests/fieldbus/can/node.hpp"

namespace flatpose::can {
namespace {

using Field = ReportField;
constexpr std::int64_t kMs = 1000;
constexpr std::uint16_t kIndex = 0x2006;
constexpr std::uint32_t kOn = 0x4000050a;
constexpr std::uint32_t kOff = 0xc000050a;
constexpr Config kWithFd{.heartbeat_ms = 0, .fd_frame = true, .carries_fd = true};

std::uint32_t number(const Frame& frame, std::size_t at, std::size_t bytes) {
  return number_at(frame.data, at, bytes);
}

int fd_count(const std::vector<Frame>& frames) {
  int count = 0;
  for (const Frame& frame : frames) count += frame.is_fd ? 1 : 0;
  return count;
}

TEST(CanFd, IsOffUnlessItIsAskedFor) {
  for (const bool carries_fd : {false, true}) {
    Node node({.carries_fd = carries_fd});
    node.desk.live();
    node.start();
    for (std::uint16_t i = 1; i < 5; ++i) {
      node.rpdo(i);
      node.desk.finish(node.desk.found());
      node.pass(10 * kMs);
      node.take(kSyncId, {});
    }
    EXPECT_EQ(fd_count(node.sent), 0);
    EXPECT_EQ(node.read(kIndex, 1), kOff);
  }
}

TEST(CanFd, ComesBeforeTheTpdosWithTheirSequenceAtEveryChange) {
  Node node(kWithFd);
  node.desk.live();
  node.start();
  const auto expect_first = [](const std::vector<Frame>& frames, std::size_t count) {
    ASSERT_EQ(frames.size(), count);
    EXPECT_TRUE(frames[0].is_fd && frames[0].has_bit_rate_switch);
    EXPECT_EQ(frames[0].id, 0x50aU);
    EXPECT_EQ(frames[0].size, 64);
    for (std::size_t i = 1; i < count; ++i) {
      EXPECT_FALSE(frames[i].is_fd);
      EXPECT_EQ(frames[i].data[0], frames[0].data[0]);
    }
    EXPECT_TRUE(
        std::equal(frames[1].data.begin(), frames[1].data.begin() + 8, frames[0].data.begin()));
  };
  expect_first(node.rpdo(7), 2);
  EXPECT_TRUE(node.whole().data[2] & job::kBusy);
  node.desk.finish(node.desk.found());
  expect_first(node.pass(10 * kMs), 5);
  EXPECT_EQ(number(node.whole(), 6, 2), 7U);
  EXPECT_EQ(number(node.whole(), 8, 4), 10'000U);
  EXPECT_EQ(number(node.whole(), 48, 2), 9000U);
  EXPECT_EQ(number(node.whole(), 60, 2), 321U);
  node.pass(10 * kMs);
  expect_first(node.rpdo(8), 5);
  EXPECT_EQ(number(node.whole(), 8, 4), 0x80000000U) << "the pose before is taken back";
  EXPECT_TRUE(node.rpdo(8).empty());
}

TEST(CanFd, HasAnIdentifierOfItsOwnForEveryNode) {
  std::set<std::uint32_t> ids;
  for (int i = 1; i <= kNodeMax; ++i) {
    const auto node = static_cast<std::uint8_t>(i);
    ids.insert({kEmergencyBase + node, kRpdoBase + node, kSdoAnswerBase + node,
                kSdoRequestBase + node, kHeartbeatBase + node});
    for (int k = 0; k < kTpdoCount; ++k) ids.insert(tpdo_id(k, node));
  }
  const std::size_t others = ids.size();
  for (int i = 1; i <= kNodeMax; ++i) {
    const auto node = static_cast<std::uint8_t>(i);
    const Config config{.node = node,
                        .master = static_cast<std::uint8_t>(i == 1 ? 2 : 1),
                        .fd_frame = true,
                        .carries_fd = true};
    EXPECT_EQ(validate(config), Status::kOk) << i;
    ids.insert(fd_report_id(config));
  }
  EXPECT_EQ(ids.size(), others + kNodeMax);
}

TEST(CanFd, ConfigsThatCannotBeAreRefused) {
  EXPECT_EQ(validate({.fd_frame = true}), Status::kInvalidArgument) << "a classic link";
  for (std::uint32_t id = 1; id < 0x1000; ++id) {
    const bool is_pdo = id > 0x180 && id < 0x580;
    const bool is_free = id >= 0x680 && id <= 0x6df;
    const bool is_ours = id == 0x18a || id == 0x20a || id == 0x28a || id == 0x38a || id == 0x48a;
    const Config config{.fd_frame_id = static_cast<std::uint16_t>(id)};
    EXPECT_EQ(validate(config) == Status::kOk, (is_pdo || is_free) && !is_ours) << id;
  }
}

TEST(CanFd, HasTheIdentifierAndRateOfItsConfig) {
  Node node({.heartbeat_ms = 0,
             .fd_frame = true,
             .fd_bit_rate_switch = false,
             .fd_frame_id = 0x6a1,
             .carries_fd = true});
  EXPECT_EQ(node.read(kIndex, 1), 0x400006a1U);
  const auto frames = node.network(NetworkCommand::kStart);
  ASSERT_EQ(fd_count(frames), 1);
  EXPECT_EQ(frames[0].id, 0x6a1U);
  EXPECT_FALSE(frames[0].has_bit_rate_switch);
}

TEST(CanFd, IsTurnedOnAndOffBySdo) {
  Node node({.heartbeat_ms = 0, .carries_fd = true});
  node.start();
  EXPECT_EQ(node.write(kIndex, 1, kOn, 4), Abort::kNone);
  EXPECT_EQ(node.read(kIndex, 1), kOn);
  EXPECT_EQ(fd_count(node.sent), 1) << "told at once";
  EXPECT_EQ(node.sent.back().id, 0x58aU);
  EXPECT_EQ(node.whole().data[0], node.tpdo(0).data[0]);
  EXPECT_EQ(node.write(kIndex, 1, kOff, 4), Abort::kNone);
  node.desk.live();
  node.rpdo(1);
  EXPECT_EQ(fd_count(node.sent), 1);
  node.pass(10 * kMs);
  EXPECT_EQ(node.write(kIndex, 1, 0x400006b0, 4), Abort::kNone);
  EXPECT_EQ(node.last(0x6b0).size, 64);
  EXPECT_EQ(number(node.last(0x6b0), 4, 2), 1U) << "of this moment";
  EXPECT_EQ(node.write(kIndex, 1, kOn, 4), Abort::kDeviceState) << "not while it is valid";
  EXPECT_EQ(node.read(kIndex, 1), 0x400006b0U);
  node.network(NetworkCommand::kResetCommunication);
  EXPECT_EQ(node.read(kIndex, 1), kOff);
}

TEST(CanFd, ThatIsTurnedOnTellsWhatThereIsAndMakesNoOtherResultOfIt) {
  Node node({.heartbeat_ms = 0, .carries_fd = true});
  node.desk.live();
  node.start();
  node.rpdo(1);
  node.desk.finish(node.desk.found());
  node.pass(10 * kMs);
  const int sequence = node.told(Field::kSequence);
  node.sent.clear();
  EXPECT_EQ(node.write(kIndex, 1, kOn, 4), Abort::kNone);
  node.pass(10 * kMs);
  ASSERT_EQ(node.sent.size(), 2U) << "the frame and the answer";
  EXPECT_EQ(node.whole().data[0], sequence);
  EXPECT_EQ(number(node.whole(), 8, 4), 10'000U);
}

TEST(CanFd, TellsThatAPoseHasExpired) {
  Node node(kWithFd);
  node.desk.live();
  node.start();
  node.rpdo(1);  // job 1's are fresh for three seconds
  job::ScanResult far = node.desk.found();
  far.matches[0].frame_T_pick.position_mm.x = 9000;
  node.desk.finish(far);
  node.pass(10 * kMs);
  ASSERT_TRUE(node.whole().data[2] & job::kValid);
  node.pass(2'900 * kMs);
  node.desk.live();
  node.pass(10 * kMs);
  const auto frames = node.pass(200 * kMs);
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_TRUE(frames[0].is_fd);
  EXPECT_FALSE(frames[0].data[2] & job::kValid);
  EXPECT_EQ(static_cast<std::int8_t>(frames[0].data[1]), static_cast<int>(job::Answer::kExpired));
  EXPECT_EQ(number(frames[0], 8, 4), 0x80000000U);
}

TEST(CanFd, RefusesIdentifiersThatHaveAnotherUse) {
  Node node({.carries_fd = true});
  for (const std::uint32_t id :
       {0x0U,   0x1U,   0x7fU,  0x80U,  0x8aU,  0x100U, 0x101U, 0x180U,      0x18aU,     0x20aU,
        0x28aU, 0x38aU, 0x48aU, 0x580U, 0x58aU, 0x5ffU, 0x600U, 0x60aU,      0x67fU,     0x6e0U,
        0x6ffU, 0x700U, 0x70aU, 0x77fU, 0x780U, 0x7ffU, 0x800U, 0x2000050aU, 0x1fffffffU}) {
    EXPECT_EQ(node.write(kIndex, 1, id | kNoRemote, 4), Abort::kValue) << id;
    EXPECT_EQ(node.write(kIndex, 1, id | kNoRemote | kNotValid, 4), Abort::kValue) << id;
  }
  EXPECT_EQ(node.read(kIndex, 1), kOff);
  EXPECT_EQ(node.write(kIndex, 1, 0x8000050a, 4), Abort::kNone);
  EXPECT_EQ(node.read(kIndex, 1), kOff) << "remote requests are never answered";
  for (const std::uint32_t id : {0x181U, 0x50aU, 0x57fU, 0x680U, 0x6dfU})
    EXPECT_EQ(node.write(kIndex, 1, id | kNoRemote | kNotValid, 4), Abort::kNone) << id;
}

TEST(CanFd, IsRefusedWhereTheInterfaceIsClassic) {
  Node node({.heartbeat_ms = 0});
  node.start();
  EXPECT_EQ(node.write(kIndex, 1, kOn, 4), Abort::kDeviceState);
  EXPECT_EQ(node.read(kIndex, 1), kOff);
  EXPECT_EQ(fd_count(node.pass(100 * kMs)), 0);
  const BusEvent event{.carries_fd = true};
  node.process({.bus = &event});
  EXPECT_EQ(node.write(kIndex, 1, kOn, 4), Abort::kNone);
}

TEST(CanFd, IsSilentWhileTheInterfaceIsClassicAndBackWithIt) {
  Node node(kWithFd);
  node.desk.live();
  node.start();
  BusEvent event{.state = BusState::kOff, .carries_fd = true};
  node.process({.bus = &event});
  event = {.state = BusState::kActive, .carries_fd = false};
  node.process({.bus = &event});
  node.sent.clear();
  node.start();
  node.rpdo(1);
  EXPECT_EQ(fd_count(node.sent), 0);
  EXPECT_EQ(node.tpdo(0).size, 8) << "all else goes on";
  EXPECT_GT(node.device.next_us(), node.desk.now_us) << "no turning in circles";
  EXPECT_EQ(node.read(kIndex, 1), kOff) << "it is not sent";
  EXPECT_EQ(node.write(kIndex, 1, kOn, 4), Abort::kDeviceState);
  EXPECT_EQ(node.write(kIndex, 5, 0, 2), Abort::kNone) << "all else may be set";
  event.carries_fd = true;
  EXPECT_EQ(fd_count(node.process({.bus = &event})), 1);
  EXPECT_EQ(number(node.whole(), 4, 2), 1U);
  EXPECT_EQ(node.read(kIndex, 1), kOn);
}

TEST(CanFd, FollowsTimesAndSyncAsTpdosDo) {
  for (const int type : {0, 1, 3, 240}) {
    Node node({.heartbeat_ms = 0, .carries_fd = true});
    node.desk.live();
    EXPECT_EQ(node.write(kIndex, 2, static_cast<std::uint32_t>(type), 1), Abort::kNone);
    EXPECT_EQ(node.write(kIndex, 1, kOn, 4), Abort::kNone);
    node.start();
    EXPECT_EQ(fd_count(node.sent), 0);
    int count = 0;
    for (int i = 0; i < 240; ++i) {
      if (i == 100) count += fd_count(node.rpdo(1, 6));
      node.pass(kMs);
      count += fd_count(node.take(kSyncId, {}));
    }
    EXPECT_EQ(count, type == 0 ? 2 : 240 / type);
    EXPECT_EQ(node.write(kIndex, 2, 241, 1), Abort::kValue);
  }
  Node node({.heartbeat_ms = 0, .carries_fd = true});
  node.desk.live();
  EXPECT_EQ(node.write(kIndex, 3, 500, 2), Abort::kNone);
  EXPECT_EQ(node.write(kIndex, 5, 300, 2), Abort::kNone);
  EXPECT_EQ(node.write(kIndex, 1, kOn, 4), Abort::kNone);
  EXPECT_EQ(node.write(kIndex, 3, 10, 2), Abort::kDeviceState);
  EXPECT_EQ(node.read(kIndex, 3), 500U);
  EXPECT_EQ(node.read(kIndex, 5), 300U);
  node.start();
  node.pass(50 * kMs);
  EXPECT_EQ(fd_count(node.rpdo(1, 6)), 1);
  EXPECT_EQ(fd_count(node.rpdo(2, 6)), 0);
  EXPECT_EQ(fd_count(node.pass(49 * kMs)), 0);
  EXPECT_EQ(fd_count(node.pass(kMs)), 1);
  EXPECT_EQ(number(node.whole(), 6, 2), 2U);
  int count = 0;
  for (int i = 0; i < 100; ++i) count += fd_count(node.pass(30 * kMs));
  EXPECT_EQ(count, 10);
}

TEST(CanFd, TellsTheAgeAtTheMomentOfSending) {
  Node node(kWithFd);
  node.desk.live();
  node.start();
  node.rpdo(1);
  node.pass(20 * kMs);
  const job::ScanResult result = node.desk.found();
  node.desk.pass(40 * kMs);
  node.desk.finish(result);
  node.desk.process({});
  (void)node.device.process(node.desk.now_us, {});
  Frame frame;
  ASSERT_TRUE(node.device.next_frame(node.desk.now_us, frame));
  EXPECT_EQ(number(frame, 52, 4), 40U);
  node.device.take_back_fd();
  ASSERT_TRUE(node.device.next_frame(node.desk.now_us + 700 * kMs, frame));
  EXPECT_TRUE(frame.is_fd);
  EXPECT_EQ(number(frame, 52, 4), 740U);
}

TEST(CanFd, HoldsWhatTheTpdosCallOutOfRange) {
  Node node(kWithFd);
  node.desk.live();
  node.start();
  node.rpdo(1);
  job::ScanResult far = node.desk.found();
  far.matches[0].frame_T_pick.position_mm = {9000, 0, -20'000};
  node.desk.finish(far);
  node.pass(10 * kMs);
  EXPECT_EQ(node.told(Field::kStatus), static_cast<int>(job::Answer::kOutOfRange));
  EXPECT_EQ(node.whole().data[1], 0);
  EXPECT_TRUE(node.whole().data[2] & job::kValid);
  EXPECT_EQ(number(node.whole(), 8, 4), 9'000'000U);
  EXPECT_EQ(static_cast<std::int32_t>(number(node.whole(), 16, 4)), -20'000'000);

  node.rpdo(2, 1, 7);  // job 7's is a quaternion
  node.desk.finish(node.desk.found(1, job::FrameName::kRobot));
  node.pass(10 * kMs);
  EXPECT_EQ(node.told(Field::kStatus), static_cast<int>(job::Answer::kOutOfRange));
  EXPECT_EQ(node.whole().data[1], 0);
  EXPECT_EQ(number(node.whole(), 20, 4), 1'000'000U);
  EXPECT_EQ(node.whole().data[62], static_cast<int>(Convention::kAbbQuaternion));
  EXPECT_EQ(node.whole().data[63], static_cast<int>(job::FrameName::kRobot));
}

// The machine was asked by others meanwhile, so that the node sees two results of one number, which
// look the same in 24 bits.
TEST(CanFd, AResultThatDiffersThereAloneHasAnotherSequence) {
  Node node(kWithFd);
  node.desk.live();
  node.start();
  const auto far_away = [&node](std::uint16_t number, double x_mm) {
    node.desk.write(node.desk.image(number, job::Command::kLocate, kMaster), kMaster, 0);
    job::ScanResult far = node.desk.found();
    far.matches[0].frame_T_pick.position_mm.x = x_mm;
    node.desk.finish(far);
  };
  far_away(5, 9000);
  node.pass(10 * kMs);
  const int sequence = node.told(Field::kSequence);
  EXPECT_EQ(number(node.whole(), 8, 4), 9'000'000U);
  far_away(6, 9000);
  far_away(5, 9500);
  const auto frames = node.pass(10 * kMs);
  EXPECT_EQ(number(node.whole(), 8, 4), 9'500'000U);
  EXPECT_EQ(node.whole().data[0], (sequence + 1) & 0xff);
  EXPECT_EQ(node.told(Field::kSequence), (sequence + 1) & 0xff);
  EXPECT_EQ(frames.size(), 2U) << "the whole result and TPDO1";
  far_away(6, 9000);
  far_away(5, 9500);
  EXPECT_TRUE(node.pass(10 * kMs).empty()) << "the same again is the same";
}

TEST(CanFd, OfAnotherMastersResultTellsNothing) {
  Node node(kWithFd);
  node.desk.live();
  node.start();
  EXPECT_EQ(node.desk.write(1), job::Verdict::kGranted);
  node.desk.finish(node.desk.found());
  node.pass(10 * kMs);
  EXPECT_EQ(number(node.whole(), 6, 2), 0U);
  EXPECT_EQ(number(node.whole(), 8, 4), 0x80000000U);
  EXPECT_EQ(number(node.whole(), 52, 4), 0xffffffffU);
  EXPECT_FALSE(node.whole().data[2] & (job::kValid | job::kDone | job::kAck));
  EXPECT_EQ(node.whole().data[0], node.tpdo(0).data[0]);
}

}  // namespace
}  // namespace flatpose::can
