// The node as its master sees it: states, commands, results, heartbeats, faults.

#include <gtest/gtest.h>

#include "tests/fieldbus/can/node.hpp"

namespace flatpose::can {
namespace {

using Field = ReportField;
constexpr std::int64_t kMs = 1000;

TEST(CanBoot, SaysSoFirstAndIsPreOperational) {
  Node node;
  ASSERT_EQ(node.sent.size(), 1U);
  EXPECT_EQ(node.sent[0], frame_of(0x70a, {0}));
  EXPECT_EQ(node.device.state(), NetworkState::kPreOperational);
}

TEST(CanBoot, RefusesNodesThatThereAreNot) {
  job::Desk desk;
  Device device(desk.machine);
  for (const int node : {0, 128, 200, 255}) {
    const auto id = static_cast<std::uint8_t>(node);
    EXPECT_EQ(device.init({.node = id}, 0), Status::kInvalidArgument) << node;
    EXPECT_EQ(device.init({.master = id}, 0), Status::kInvalidArgument) << node;
  }
  EXPECT_EQ(device.init({.node = 5, .master = 5}, 0), Status::kInvalidArgument);
  for (int node = 1; node <= 126; ++node)
    EXPECT_EQ(device.init({.node = static_cast<std::uint8_t>(node)}, 0), Status::kOk);
}

TEST(CanHeartbeat, ComesEveryPeriodWithTheState) {
  Node node({.heartbeat_ms = 100});
  const auto beat = [&node] {
    const auto frames = node.pass(100 * kMs);
    return frames.size() == 1 && frames[0].id == 0x70a ? frames[0].data[0] : -1;
  };
  EXPECT_TRUE(node.pass(99 * kMs).empty());
  EXPECT_EQ(node.pass(1 * kMs).size(), 1U);
  EXPECT_EQ(beat(), 127);
  node.network(NetworkCommand::kStop);
  EXPECT_EQ(beat(), 4);
  node.network(NetworkCommand::kStart);
  EXPECT_EQ(beat(), 5);
  EXPECT_EQ(node.write(0x1017, 0, 0, 2), Abort::kNone);
  EXPECT_TRUE(node.pass(10'000 * kMs).empty());
}

TEST(CanHeartbeat, LeavesOutWhatCouldNotBeSent) {
  Node node({.heartbeat_ms = 100});
  EXPECT_EQ(node.pass(1050 * kMs).size(), 1U);
  EXPECT_GT(node.device.next_us(), node.desk.now_us);
}

TEST(CanTrigger, RunsOnceAndTellsStateAndPoseWithOneSequence) {
  Node node;
  node.desk.live();
  node.start();
  node.rpdo(7);
  EXPECT_EQ(node.desk.order.kind, job::Order::Kind::kStart);
  EXPECT_EQ(node.desk.order.number, 7);
  const std::uint32_t ticket = node.desk.order.ticket;
  EXPECT_EQ(node.told(Field::kJudgedNumber), 7);
  EXPECT_EQ(node.told(Field::kDoneNumber), 0);
  EXPECT_TRUE(node.told(Field::kBits) & job::kBusy);
  node.rpdo(7);
  node.pass(10 * kMs);
  node.rpdo(7);
  EXPECT_EQ(node.desk.order.ticket, ticket);

  node.desk.finish(node.desk.found());
  node.pass(10 * kMs);
  EXPECT_EQ(node.told(Field::kDoneNumber), 7);
  EXPECT_EQ(node.told(Field::kStatus), 0);
  EXPECT_TRUE(node.told(Field::kBits) & job::kValid);
  EXPECT_TRUE(node.sequences_agree());
  EXPECT_EQ(node.told(Field::kPositionX), 10'000);
  EXPECT_EQ(node.told(Field::kPositionY), 2'000);
  EXPECT_EQ(node.told(Field::kPositionZ), 3'000);
  EXPECT_EQ(node.told(Field::kScore), 180);
  EXPECT_EQ(node.told(Field::kPart), 0);
  EXPECT_EQ(node.told(Field::kTool), 0);
}

TEST(CanTrigger, TakesThePoseOfTheNumberBeforeBack) {
  Node node;
  node.desk.live();
  node.start();
  node.rpdo(1);
  node.desk.finish(node.desk.found());
  node.pass(10 * kMs);
  const std::int32_t sequence = node.told(Field::kSequence);
  node.rpdo(2);
  node.pass(10 * kMs);
  EXPECT_NE(node.told(Field::kSequence), sequence);
  EXPECT_TRUE(node.sequences_agree());
  EXPECT_EQ(node.told(Field::kPositionX), kNoneInt24);
  EXPECT_EQ(node.told(Field::kRotation3), kNoneInt24);
  EXPECT_FALSE(node.told(Field::kBits) & job::kValid);
}

// What docs/can.md works the bus's load out from.
TEST(CanTrigger, CostsFourFramesAtAcceptanceAndFourAtTheResult) {
  Node node({.heartbeat_ms = 0});
  node.desk.live();
  node.start();
  for (std::uint16_t number = 1; number < 20; ++number) {
    std::size_t accepted = node.rpdo(number).size();
    for (int i = 0; i < 10; ++i) accepted += node.pass(kMs).size();
    node.desk.finish(node.desk.found());
    std::size_t told = 0;
    for (int i = 0; i < 10; ++i) told += node.pass(kMs).size();
    EXPECT_EQ(accepted, number == 1 ? 1U : 4U) << number;
    EXPECT_EQ(told, 4U);
  }
}

TEST(CanTrigger, OfAnAnswerWithoutPoseTellsTheStatusAlone) {
  Node node;
  node.desk.live();
  node.start();
  node.rpdo(1);
  node.pass(10 * kMs);
  const std::int32_t sequence = node.told(Field::kSequence);
  node.sent.clear();
  job::ScanResult nothing = node.desk.found(0);
  nothing.answer = job::Answer::kNoMatch;
  node.desk.finish(nothing);
  node.pass(10 * kMs);
  EXPECT_EQ(node.told(Field::kStatus), -1);
  EXPECT_EQ(node.tpdo(1).size, 0);
  EXPECT_NE(node.told(Field::kSequence), sequence);
}

TEST(CanTrigger, IsRefusedWithItsReasonAndConsumed) {
  Node node;  // no search lives
  node.start();
  node.rpdo(3);
  EXPECT_EQ(node.told(Field::kJudgedNumber), 3);
  EXPECT_EQ(node.told(Field::kRefusedStatus), static_cast<int>(job::Refusal::kNotReady));
  node.desk.live();
  node.rpdo(3);
  EXPECT_EQ(node.desk.order.kind, job::Order::Kind::kNone);
  node.pass(2 * kMs);
  node.rpdo(4, 1, 1, 99);
  node.pass(2 * kMs);
  EXPECT_EQ(node.told(Field::kRefusedStatus), static_cast<int>(job::Refusal::kStaleSession));
  node.rpdo(5, 1, 55);
  node.pass(2 * kMs);
  EXPECT_EQ(node.told(Field::kRefusedStatus), static_cast<int>(job::Refusal::kBadJob));
  node.rpdo(6, 77);
  node.pass(2 * kMs);
  EXPECT_EQ(node.told(Field::kRefusedStatus), static_cast<int>(job::Refusal::kBadCommand));
  node.rpdo(7, 1, 1, 321);
  node.pass(2 * kMs);
  EXPECT_EQ(node.told(Field::kRefusedStatus), 0);
  EXPECT_EQ(node.desk.order.number, 7);
}

// The last number alone is remembered: docs/can.md tells masters to count upwards.
TEST(CanTrigger, ByANumberBeforeTheLastIsANewOne) {
  Node node;
  node.desk.live();
  node.start();
  std::uint32_t ticket = 0;
  for (const int n : {1, 2, 1}) {
    const auto number = static_cast<std::uint16_t>(n);
    node.rpdo(number);
    EXPECT_EQ(node.desk.order.number, number);
    EXPECT_NE(node.desk.order.ticket, ticket);
    ticket = node.desk.order.ticket;
    node.desk.finish(node.desk.found());
    node.pass(10 * kMs);
    node.rpdo(number);
    EXPECT_EQ(node.desk.order.ticket, ticket);
  }
}

TEST(CanTrigger, RefusedTakesTheLastPoseAway) {
  Node node;
  node.desk.live();
  node.start();
  node.rpdo(1);
  node.desk.finish(node.desk.found());
  node.pass(10 * kMs);
  EXPECT_NE(node.told(Field::kPositionX), kNoneInt24);
  node.rpdo(2, 1, 55);
  node.pass(10 * kMs);
  EXPECT_EQ(node.told(Field::kRefusedStatus), static_cast<int>(job::Refusal::kBadJob));
  EXPECT_EQ(node.told(Field::kDoneNumber), 0);
  EXPECT_EQ(node.told(Field::kPositionX), kNoneInt24);
  EXPECT_TRUE(node.sequences_agree());
}

TEST(CanTrigger, OfAPickReportBearsNumberAndOutcome) {
  Node node;
  node.desk.live();
  node.start();
  node.rpdo(9, 9, 1234, 0, 3);
  EXPECT_EQ(node.desk.order.command, job::Command::kReportPick);
  EXPECT_EQ(node.desk.order.pick_number, 1234);
  EXPECT_EQ(node.desk.order.pick_outcome, 3);
}

TEST(CanTrigger, WaitsForSyncWhenSetSo) {
  Node node;
  node.desk.live();
  EXPECT_EQ(node.write(0x1400, 2, 1, 1), Abort::kNone);
  node.start();
  node.rpdo(7);
  node.rpdo(8);
  EXPECT_EQ(node.desk.order.kind, job::Order::Kind::kNone);
  node.take(kSyncId, {});
  EXPECT_EQ(node.desk.order.number, 8);
}

TEST(CanOwnership, AHostWithTheLeaseIsNotOvertaken) {
  Node node;
  node.desk.live();
  node.start();
  EXPECT_EQ(node.desk.write(1), job::Verdict::kGranted);
  node.rpdo(5);
  EXPECT_EQ(node.told(Field::kRefusedStatus), static_cast<int>(job::Refusal::kNotOwner));
  EXPECT_EQ(node.write(0x2000, 4, 1, 2), Abort::kLocalControl);
  EXPECT_EQ(node.write_all(0x2004, 0, Bytes(14)), Abort::kLocalControl);
  node.desk.finish(node.desk.found());
  node.pass(10 * kMs);
  EXPECT_EQ(node.told(Field::kDoneNumber), 0) << "another's result";
  EXPECT_EQ(node.told(Field::kPositionX), kNoneInt24);
  EXPECT_FALSE(node.told(Field::kBits) & (job::kValid | job::kDone | job::kAck));
  EXPECT_EQ(node.read(0x2010, 2), 1U) << "all may be read";

  node.desk.pass(6 * job::kSecond_us);  // the lease is out
  node.desk.live();
  node.desk.order = {};
  node.rpdo(5);  // sent again and again by its master: a refused number never runs later
  EXPECT_EQ(node.desk.order.kind, job::Order::Kind::kNone);
  node.rpdo(6);
  EXPECT_EQ(node.desk.order.number, 6);
  EXPECT_EQ(node.desk.write(2), job::Verdict::kNotOwner);
}

TEST(CanOwnership, LastsAsLongAsTheMasterIsHeard) {
  Node node;
  node.desk.live();
  node.start();
  node.rpdo(1, 1, 7);  // job 7 gives itself nine seconds
  for (int i = 0; i < 8; ++i) {
    node.pass(1000 * kMs);
    i % 3 == 0 ? node.heartbeat() : i % 3 == 1 ? node.rpdo(1) : node.rpdo(0);
    EXPECT_TRUE(node.told(Field::kBits) & job::kBusy) << i;
  }
  node.pass(4900 * kMs);
  EXPECT_EQ(node.desk.see(kMaster).answer, job::Answer::kAnswerLate);
}

TEST(CanOwnership, EndsInSilenceAndCancels) {
  Node node;
  node.desk.live();
  node.start();
  node.rpdo(1, 1, 7);
  node.pass(5'000 * kMs);
  EXPECT_EQ(node.told(Field::kStatus), static_cast<int>(job::Answer::kCancelled));
  EXPECT_EQ(node.told(Field::kDoneNumber), 1);
  EXPECT_EQ(node.desk.order.kind, job::Order::Kind::kStop);
}

TEST(CanMasterHeartbeat, ItsLossCancelsAtOnceAndIsAnEmergency) {
  Node node;
  node.desk.live();
  EXPECT_EQ(node.write(0x1016, 1, kMaster << 16 | 250, 4), Abort::kNone);
  node.start();
  node.pass(1000 * kMs);
  EXPECT_EQ(node.device.error_register(), 0) << "watching begins with the first";
  node.heartbeat();
  node.rpdo(1, 1, 7);
  node.pass(200 * kMs);
  node.heartbeat();
  node.pass(249 * kMs);
  EXPECT_TRUE(node.desk.has(job::kBusy));
  EXPECT_LE(node.device.next_us(), node.desk.now_us + kMs);
  node.pass(kMs);
  EXPECT_EQ(node.desk.order.kind, job::Order::Kind::kStop);
  EXPECT_GT(node.device.next_us(), node.desk.now_us) << "a loss is told once";
  EXPECT_EQ(node.desk.see(kMaster).answer, job::Answer::kCancelled);
  EXPECT_EQ(node.device.state(), NetworkState::kPreOperational);
  EXPECT_EQ(node.last_emergency(), 0x8130);
  EXPECT_EQ(node.device.error_register(), 0x11);
  EXPECT_EQ(node.read(0x1003, 0), 1U);
  EXPECT_EQ(node.read(0x1003, 1), 0x8130U);
  node.heartbeat();
  EXPECT_EQ(node.last_emergency(), 0);
  EXPECT_EQ(node.device.error_register(), 0);
}

TEST(CanMasterHeartbeat, ItsLossLeavesAHostsCommandAlone) {
  Node node({.master_silence_ms = 100});
  node.desk.live();
  node.heartbeat();
  EXPECT_EQ(node.desk.write(1), job::Verdict::kGranted);
  node.pass(200 * kMs);
  EXPECT_TRUE(node.desk.has(job::kBusy));
  EXPECT_EQ(node.device.error_register(), 0x11);
}

TEST(CanMasterHeartbeat, ABootUpIsNoSignOfLife) {
  Node node({.master_silence_ms = 100});
  node.heartbeat();
  node.pass(60 * kMs);
  node.heartbeat(kMaster, 0);
  node.pass(60 * kMs);
  EXPECT_EQ(node.device.error_register(), 0x11);
}

TEST(CanReset, OfTheNodeCancelsWhatTheMasterAskedForAndForgetsSettings) {
  for (const NetworkCommand reset :
       {NetworkCommand::kResetNode, NetworkCommand::kResetCommunication}) {
    Node node({.heartbeat_ms = 700});
    node.desk.live();
    EXPECT_EQ(node.write(0x1017, 0, 50, 2), Abort::kNone);
    node.start();
    node.rpdo(1, 1, 7);
    const auto frames = node.network(reset, 0);
    ASSERT_GE(frames.size(), 1U);
    EXPECT_EQ(frames[0], frame_of(0x70a, {0}));
    EXPECT_EQ(node.device.state(), NetworkState::kPreOperational);
    EXPECT_EQ(node.read(0x1017, 0), 700U);
    EXPECT_EQ(node.desk.has(job::kBusy), reset == NetworkCommand::kResetCommunication);
    node.start();
    node.rpdo(1, 1, 7);  // the PLC's outputs as they were: not again
    EXPECT_EQ(node.desk.see(kMaster).last_number, 1);
  }
}

TEST(CanReset, KeepsSessionAndLastNumber) {
  for (const NetworkCommand reset :
       {NetworkCommand::kResetNode, NetworkCommand::kResetCommunication}) {
    Node node;
    node.desk.live();
    node.start();
    node.rpdo(1, 1, 7);
    const std::uint32_t ticket = node.desk.order.ticket;
    node.network(reset);
    EXPECT_EQ(node.read(0x2010, 10), 1U);
    EXPECT_EQ(node.read(0x2010, 11), 321U);
    node.start();
    if (reset == NetworkCommand::kResetNode) {
      EXPECT_EQ(node.told(Field::kStatus), static_cast<int>(job::Answer::kCancelled));
      EXPECT_EQ(node.told(Field::kDoneNumber), 1);
      continue;
    }
    EXPECT_EQ(node.desk.order.ticket, ticket);
    node.desk.finish(node.desk.found(1, job::FrameName::kRobot));
    node.pass(10 * kMs);
    EXPECT_EQ(node.told(Field::kDoneNumber), 1);
  }
}

TEST(CanNetwork, StoppedInMidCommandTellsTheResultAtTheNextStart) {
  for (const NetworkCommand command : {NetworkCommand::kStop, NetworkCommand::kEnterPreOperational,
                                       NetworkCommand::kResetCommunication}) {
    Node node;
    node.desk.live();
    node.start();
    node.rpdo(1);
    node.network(command);
    node.sent.clear();
    node.desk.finish(node.desk.found());
    node.pass(10 * kMs);
    EXPECT_EQ(node.tpdo(0).size, 0);
    node.start();
    EXPECT_EQ(node.told(Field::kDoneNumber), 1);
    EXPECT_TRUE(node.told(Field::kBits) & job::kValid);
    EXPECT_TRUE(node.sequences_agree());
  }
}

TEST(CanEmergency, TellsAFaultWithStatusAndNumberAndItsEnd) {
  Node node;
  node.desk.live();
  node.start();
  node.rpdo(258);
  job::ScanResult dark;
  dark.answer = job::Answer::kNoScan;
  node.desk.finish(dark);
  node.pass(10 * kMs);
  EXPECT_EQ(node.last(0x8a), frame_of(0x8a, {0x05, 0xff, 0x81, 2, 1, 0xfb, 0, 0}));
  EXPECT_EQ(node.read(0x1001, 0), 0x81U);
  EXPECT_EQ(node.read(0x1003, 1), 0x0102ff05U);
  node.rpdo(259, 6);
  node.pass(10 * kMs);
  EXPECT_EQ(node.last_emergency(), 0);
  EXPECT_EQ(node.read(0x1001, 0), 0U);
  EXPECT_EQ(node.read(0x1003, 0), 1U);
  EXPECT_EQ(node.write(0x1003, 0, 1, 1), Abort::kValue);
  EXPECT_EQ(node.write(0x1003, 0, 0, 1), Abort::kNone);
  EXPECT_EQ(node.read(0x1003, 0), 0U);
}

TEST(CanEmergency, OfAShortCommandThatIsNotTaken) {
  Node node;
  node.desk.live();
  node.start();
  for (std::size_t size = 0; size < 8; ++size) {
    node.take(kRpdoBase + kNode, Bytes(size, 1));
    EXPECT_EQ(node.last_emergency(), 0x8210);
    EXPECT_EQ(node.desk.order.kind, job::Order::Kind::kNone);
  }
  EXPECT_EQ(node.read(0x1003, 0), 1U) << "one that lasts";
  node.rpdo(0);
  EXPECT_EQ(node.last_emergency(), 0);
}

TEST(CanBusState, OffMakesPreOperationalAndIsToldAfterwards) {
  Node node;
  node.start();
  BusEvent event{.state = BusState::kOff};
  node.process({.bus = &event});
  EXPECT_EQ(node.device.state(), NetworkState::kPreOperational);
  EXPECT_NE(node.last_emergency(), 0x8140);
  event.state = BusState::kActive;
  const auto frames = node.process({.bus = &event});
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(number_at(frames[0].data, 0, 2), 0x8140U);
  EXPECT_EQ(number_at(frames[1].data, 0, 2), 0U);
  event = {.state = BusState::kErrorPassive, .has_lost_frames = true};
  node.process({.bus = &event});
  EXPECT_EQ(node.last_emergency(), 0x8120);
  EXPECT_EQ(node.device.error_register(), 0x11);
  event = {};
  node.process({.bus = &event});
  EXPECT_EQ(node.device.error_register(), 0);
}

TEST(CanHeartbeat, OfItsOwnNumberIsAnothersAndIsToldOnceUntilAReset) {
  Node node;
  Frame remote = frame_of(kHeartbeatBase + kNode, {});
  remote.is_remote = true;
  Frame extended = frame_of(kHeartbeatBase + kNode, {5});
  extended.is_extended = true;
  Frame fd = frame_of(kHeartbeatBase + kNode, {5});
  fd.is_fd = true;
  for (const Frame& frame : {remote, extended, fd}) node.take(frame);
  node.heartbeat(kNode - 1);
  EXPECT_FALSE(node.device.has_twin());
  for (const NetworkState state : {NetworkState::kPreOperational, NetworkState::kOperational})
    node.heartbeat(kNode, static_cast<std::uint8_t>(state));
  EXPECT_TRUE(node.device.has_twin());
  EXPECT_EQ(node.last_emergency(), 0x8150);
  EXPECT_EQ(node.device.error_register(), 0x11);
  EXPECT_EQ(node.read(0x1003, 0), 1U) << "once";
  node.network(NetworkCommand::kResetNode);
  EXPECT_EQ(node.device.error_register(), 0);
  EXPECT_TRUE(node.device.has_twin());
  node.heartbeat(kNode);
  EXPECT_EQ(node.read(0x1003, 0), 1U) << "still there";
}

TEST(CanTpdo, KeepsItsInhibitTimeAndThenTellsTheNewest) {
  Node node;
  node.desk.live();
  EXPECT_EQ(node.write(0x1800, 3, 500, 2), Abort::kDeviceState) << "not while it is valid";
  EXPECT_EQ(node.write(0x1800, 1, 0xc000018a, 4), Abort::kNone);
  EXPECT_EQ(node.write(0x1800, 3, 500, 2), Abort::kNone);
  EXPECT_EQ(node.write(0x1800, 1, 0x4000018a, 4), Abort::kNone);
  node.start();
  node.pass(50 * kMs);
  node.rpdo(1, 6);  // clear_error: done at once
  EXPECT_EQ(node.told(Field::kDoneNumber), 1);
  EXPECT_EQ(node.rpdo(2, 6).size(), 0U);
  EXPECT_EQ(node.rpdo(3, 6).size(), 0U);
  EXPECT_EQ(node.device.next_us(), node.desk.now_us + 50 * kMs);
  EXPECT_EQ(node.pass(49 * kMs).size(), 0U);
  EXPECT_EQ(node.pass(1 * kMs).size(), 1U);
  EXPECT_EQ(node.told(Field::kDoneNumber), 3);
}

TEST(CanTpdo, ComesAgainByItsEventTimer) {
  Node node({.heartbeat_ms = 0});
  EXPECT_EQ(node.write(0x1802, 5, 300, 2), Abort::kNone);
  node.start();
  int count = 0;
  for (int i = 0; i < 100; ++i) count += static_cast<int>(node.pass(30 * kMs).size());
  EXPECT_EQ(count, 10);
}

TEST(CanTpdo, FollowsSyncAsItsTypeSays) {
  Node node({.heartbeat_ms = 0});
  node.desk.live();
  const std::uint8_t types[] = {0, 1, 3, 240};
  for (int i = 0; i < kTpdoCount; ++i)
    EXPECT_EQ(node.write(static_cast<std::uint16_t>(0x1800 + i), 2, types[i], 1), Abort::kNone);
  node.start();
  node.sent.clear();
  int counts[kTpdoCount] = {};
  for (int i = 0; i < 240; ++i) {
    if (i == 100) node.rpdo(1, 6);
    node.pass(kMs);
    for (const Frame& frame : node.take(kSyncId, {})) ++counts[(frame.id - 0x180) / 0x100];
  }
  EXPECT_EQ(counts[0], 2) << "at start and after the event";
  EXPECT_EQ(counts[1], 240);
  EXPECT_EQ(counts[2], 80);
  EXPECT_EQ(counts[3], 1);
  EXPECT_EQ(node.write(0x1800, 2, 241, 1), Abort::kValue);
  EXPECT_EQ(node.write(0x1800, 2, 253, 1), Abort::kValue);
}

TEST(CanTpdo, IsSilentWhenNotValidAndOutsideOfOperational) {
  Node node({.heartbeat_ms = 0});
  node.desk.live();
  EXPECT_TRUE(node.sent.back().id == 0x70a);
  EXPECT_EQ(node.write(0x1801, 1, 0xc000028a, 4), Abort::kNone);
  const auto frames = node.network(NetworkCommand::kStart);
  EXPECT_EQ(frames.size(), 3U);
  EXPECT_EQ(node.tpdo(1).size, 0);
  node.network(NetworkCommand::kEnterPreOperational);
  EXPECT_EQ(node.desk.write(1), job::Verdict::kGranted);
  EXPECT_TRUE(node.pass(100 * kMs).empty());
}

TEST(CanNetwork, ServesInEachStateWhatItAllows) {
  for (const NetworkCommand state :
       {NetworkCommand::kEnterPreOperational, NetworkCommand::kStart, NetworkCommand::kStop}) {
    Node node;
    node.desk.live();
    node.network(state, 0);
    const bool is_operational = state == NetworkCommand::kStart;
    EXPECT_EQ(node.sdo(Node::object(0x40, 0x1000, 0)).empty(), state == NetworkCommand::kStop);
    node.rpdo(1);
    EXPECT_EQ(node.desk.order.number, is_operational ? 1 : 0);
    node.pass(10 * kMs);
    EXPECT_EQ(node.tpdo(0).size, is_operational ? 8 : 0);
  }
}

TEST(CanNetwork, CommandsForOthersAreNotOurs) {
  Node node;
  node.network(NetworkCommand::kStart, 11);
  node.take(kNmtId, {1});
  node.take(kNmtId, {1, kNode, 0});
  node.take(kNmtId, {7, kNode});
  Frame remote = frame_of(kNmtId, {1, kNode});
  remote.is_remote = true;
  node.take(remote);
  Frame extended = frame_of(kNmtId, {1, kNode});
  extended.is_extended = true;
  node.take(extended);
  EXPECT_EQ(node.device.state(), NetworkState::kPreOperational);
}

}  // namespace
}  // namespace flatpose::can
