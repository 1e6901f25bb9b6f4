// A PLC and the node on a simulated bus that loses, doubles and delays frames and goes off. The PLC
// knows CAN alone: it judges by frames, and the search behind the node says what was asked for.

#include <gtest/gtest.h>

#include <map>
#include <vector>

#include "flatpose/can/station.hpp"
#include "port/sim/can/can_bus.hpp"
#include "tests/fieldbus/can/node.hpp"

namespace flatpose::can {
namespace {

constexpr std::int64_t kStep_us = 500;
constexpr std::int64_t kMs = 1000;

// The search: every order takes a few steps; its pose tells the number.
class World {
 public:
  explicit World(std::uint64_t seed, const sim::CanFaults& faults = {}, bool has_fd = false)
      : bus(seed, faults),
        plc(bus.attach()),
        device(desk.machine),
        station(device, bus.attach()),
        random(seed, 99) {
    const Config config{.fd_frame = has_fd, .carries_fd = has_fd};
    EXPECT_EQ(device.init(config, desk.now_us), Status::kOk);
    bus.set_fd(has_fd);
  }

  void step() {
    desk.now_us += kStep_us;
    if (desk.now_us >= alive_us) {
      alive_us = desk.now_us + 500 * kMs;
      desk.live();
    }
    if (order.kind == job::Order::Kind::kStart && --left == 0) {
      job::ScanResult result = desk.found(1);
      result.matches[0].frame_T_pick.position_mm = {order.number * 0.1, -order.number * 0.01, 7};
      desk.tell(job::SearchEvent::Kind::kFinished, order.ticket, result);
      order = {};
    }
    bus.step(desk.now_us);
    const job::Outputs out = station.serve(desk.now_us);
    EXPECT_GT(station.next_us(), desk.now_us - 1);
    if (out.order.kind == job::Order::Kind::kNone) return;
    order = out.order;
    if (order.kind == job::Order::Kind::kStart) ++executed[order.number];
    left = 1 + random.index(8);
  }

  job::Desk desk;
  sim::CanBus bus;
  Link& plc;
  Device device;
  Station station;
  sim::Random random;
  job::Order order;
  int left = 0;
  std::int64_t alive_us = 0;
  std::map<int, int> executed;
};

// Sends a command again and again until its answer has come whole.
class Plc {
 public:
  explicit Plc(World& world) : world_(world) {}

  struct Answer {
    bool has_come = false;
    bool was_refused = false;
    Report report;
  };

  Answer ask(std::uint16_t number, int patience_steps = 4000) {
    Answer answer;
    for (int i = 0; i < patience_steps && !answer.has_come; ++i) {
      if (i % 20 == 0) {
        send(kNmtId, {1, 0});  // whatever state it fell into
        Bytes bytes{static_cast<std::uint8_t>(number), static_cast<std::uint8_t>(number >> 8)};
        bytes.insert(bytes.end(), {0, 0, 1, 0, 1, 0});
        send(kRpdoBase + kNode, bytes);
      }
      if (i % 8 == 0) send(kSyncId, {});
      world_.step();
      look(number, answer);
    }
    return answer;
  }
  void send(std::uint32_t id, const Bytes& bytes) {
    while (!world_.plc.send(frame_of(id, bytes))) world_.step();
  }
  void set(std::uint16_t index, std::uint8_t subindex, std::uint32_t value, int size) {
    const auto head = static_cast<std::uint8_t>(0x23 | (4 - size) << 2);
    send(kSdoRequestBase + kNode, Node::object(head, index, subindex, value));
    for (int i = 0; i < 10; ++i) world_.step();
  }
  bool looks_at_fd_alone = false;
  int whole_count = 0;

  int emergencies(std::uint16_t code) const {
    const auto found = emergencies_.find(code);
    return found == emergencies_.end() ? 0 : found->second;
  }

 private:
  void look(std::uint16_t number, Answer& answer) {
    for (;;) {
      const Link::Received got = world_.plc.receive();
      if (got.kind == Link::Received::Kind::kNothing) break;
      if (got.kind != Link::Received::Kind::kFrame) continue;
      if (got.frame.id == kEmergencyBase + kNode) ++emergencies_[number_at(got.frame.data, 0, 2)];
      for (int i = 0; i < kTpdoCount; ++i) {
        if (got.frame.id == tpdo_id(i, kNode)) frames_[i] = got.frame;
      }
      if (got.frame.is_fd) {
        judge_whole(number, got.frame, answer);
      } else if (!looks_at_fd_alone) {
        judge(number, answer);
      }
    }
  }
  void judge_whole(std::uint16_t number, const Frame& whole, Answer& answer) {
    ++whole_count;
    if (number_at(whole.data, 4, 2) == number && whole.data[3] != 0)
      answer.has_come = answer.was_refused = true;
    if (!looks_at_fd_alone || number_at(whole.data, 6, 2) != number) return;
    answer.has_come = true;
    answer.report[ReportField::kStatus] = static_cast<std::int8_t>(whole.data[1]);
    const auto raw = [&whole](std::size_t at) {
      return static_cast<std::int32_t>(number_at(whole.data, at, 4));
    };
    answer.report[ReportField::kPositionX] = raw(8);
    answer.report[ReportField::kPositionY] = raw(12);
    answer.report[ReportField::kPositionZ] = raw(16);
  }
  void judge(std::uint16_t number, Answer& answer) {
    const auto& status = frames_[0].data;
    if (frames_[0].size != 8) return;
    if (number_at(status, 4, 2) == number && status[3] != 0) {
      answer.has_come = answer.was_refused = true;
      return;
    }
    if (number_at(status, 6, 2) != number) return;
    if ((status[2] & job::kValid) != 0) {
      for (int i = 1; i < kTpdoCount; ++i) {
        if (frames_[i].size != 8 || frames_[i].data[0] != status[0]) return;
      }
    }
    answer.has_come = true;
    answer.report[ReportField::kStatus] = static_cast<std::int8_t>(status[1]);
    answer.report[ReportField::kPositionX] = int24(1, 1);
    answer.report[ReportField::kPositionY] = int24(1, 4);
    answer.report[ReportField::kPositionZ] = int24(2, 1);
  }
  [[nodiscard]] std::int32_t int24(int tpdo, std::size_t at) const {
    const std::uint32_t raw = number_at(frames_[tpdo].data, at, 3);
    return static_cast<std::int32_t>(raw << 8) >> 8;
  }

  World& world_;
  Frame frames_[kTpdoCount];
  std::map<std::uint32_t, int> emergencies_;
};

void expect_pose_of(int number, const Plc::Answer& answer) {
  ASSERT_TRUE(answer.has_come) << number;
  ASSERT_FALSE(answer.was_refused) << number;
  if (answer.report[ReportField::kStatus] == static_cast<int>(job::Answer::kCancelled)) return;
  EXPECT_EQ(answer.report[ReportField::kStatus], 0) << number;
  EXPECT_EQ(answer.report[ReportField::kPositionX], number * 100);
  EXPECT_EQ(answer.report[ReportField::kPositionY], -number * 10);
  EXPECT_EQ(answer.report[ReportField::kPositionZ], 7000);
}

TEST(CanLink, AThousandTriggersOnAGoodBusAreAnsweredOnce) {
  World world(1);
  Plc plc(world);
  for (int number = 1; number <= 1000; ++number)
    expect_pose_of(number, plc.ask(static_cast<std::uint16_t>(number)));
  for (int number = 1; number <= 1000; ++number) EXPECT_EQ(world.executed[number], 1) << number;
}

TEST(CanLink, LossDoublingAndDelayLoseNoCommandAndRunNoneTwice) {
  const sim::CanFaults kinds[] = {{.lost = 0.2},
                                  {.doubled = 0.5},
                                  {.late = 0.5},
                                  {.lost = 0.1, .doubled = 0.2, .late = 0.3},
                                  {.lost = 0.1, .late = 0.2, .room = 1}};
  std::uint64_t seed = 10;
  for (const sim::CanFaults& faults : kinds) {
    World world(++seed);
    Plc plc(world);
    for (int i = 0; i < kTpdoCount; ++i)  // told again every 20 ms, for what was lost
      plc.set(static_cast<std::uint16_t>(0x1800 + i), 5, 20, 2);
    world.bus.set_faults(faults);
    for (int number = 1; number <= 300; ++number)
      expect_pose_of(number, plc.ask(static_cast<std::uint16_t>(number)));
    for (int number = 1; number <= 300; ++number) EXPECT_EQ(world.executed[number], 1) << number;
  }
}

TEST(CanLink, TheWholeResultAloneIsEnoughOnABusThatLosesDoublesAndDelays) {
  const sim::CanFaults kinds[] = {
      {}, {.lost = 0.2}, {.doubled = 0.5}, {.lost = 0.1, .doubled = 0.2, .late = 0.3, .room = 1}};
  std::uint64_t seed = 20;
  for (const sim::CanFaults& faults : kinds) {
    World world(++seed, {}, true);
    Plc plc(world);
    plc.looks_at_fd_alone = true;
    plc.set(kFdReportIndex, 5, 20, 2);
    world.bus.set_faults(faults);
    for (int number = 1; number <= 200; ++number)
      expect_pose_of(number, plc.ask(static_cast<std::uint16_t>(number)));
    for (int number = 1; number <= 200; ++number) EXPECT_EQ(world.executed[number], 1) << number;
  }
}

TEST(CanLink, WithoutFdThereIsNoFdFrameEver) {
  World world(5);
  Plc plc(world);
  for (int number = 1; number <= 50; ++number)
    expect_pose_of(number, plc.ask(static_cast<std::uint16_t>(number)));
  EXPECT_EQ(plc.whole_count, 0);
}

TEST(CanLink, BusOffAndAClassicInterfaceAfterwardsLeaveTheWholeResultOutAndAllElseGoesOn) {
  World world(6, {}, true);
  Plc plc(world);
  expect_pose_of(1, plc.ask(1));
  EXPECT_GT(plc.whole_count, 0);
  for (const bool has_fd : {false, true, false, true}) {
    world.bus.set_state(1, BusState::kOff);
    for (int i = 0; i < 20; ++i) world.step();
    world.bus.set_state(1, BusState::kActive);
    world.bus.set_fd(has_fd);
    for (int i = 0; i < 20; ++i) world.step();
    plc.whole_count = 0;
    const auto number = static_cast<std::uint16_t>(world.executed.size() + 1);
    expect_pose_of(number, plc.ask(number));
    EXPECT_EQ(plc.whole_count > 0, has_fd);
  }
}

TEST(CanLink, BusOffAtAnyMomentEndsInAnAnswerAfterwards) {
  World world(3);
  Plc plc(world);
  for (int number = 1; number <= 60; ++number) {
    for (int i = 0; i < number % 12; ++i) world.step();
    if (number % 2 == 0) {
      plc.send(kRpdoBase + kNode, {static_cast<std::uint8_t>(number), 0, 0, 0, 1, 0, 1, 0});
      for (int i = 0; i < number % 7; ++i) world.step();
    }
    world.bus.set_state(1, BusState::kOff);
    for (int i = 0; i < 20; ++i) world.step();
    EXPECT_EQ(world.device.state(), NetworkState::kPreOperational);
    EXPECT_GT(world.station.next_us(), world.desk.now_us) << "no turning in circles";
    world.bus.set_state(1, BusState::kActive);
    const Plc::Answer answer = plc.ask(static_cast<std::uint16_t>(number));
    expect_pose_of(number, answer);
    EXPECT_LE(world.executed[number], 1);
  }
  EXPECT_GT(plc.emergencies(0x8140), 50);
}

TEST(CanLink, TwoNodesOfOneNumberHearOfEachOtherAndEachSaysSoOnce) {
  World world(7);
  Plc plc(world);
  expect_pose_of(1, plc.ask(1));
  for (int i = 0; i < 5000; ++i) world.step();
  EXPECT_FALSE(world.device.has_twin()) << "what it says itself is not another's";
  job::Desk other_desk;
  Device twin(other_desk.machine);
  Station other(twin, world.bus.attach());
  EXPECT_EQ(twin.init({}, world.desk.now_us), Status::kOk);
  for (int i = 0; i < 5000; ++i) {
    world.step();
    (void)other.serve(world.desk.now_us);
  }
  EXPECT_TRUE(world.device.has_twin());
  EXPECT_TRUE(twin.has_twin());
  (void)plc.ask(2, 1);
  EXPECT_EQ(plc.emergencies(0x8150), 2);
}

TEST(CanLink, ABusWithoutRoomIsTriedLessAndLessOftenAndThenGetsTheNewest) {
  World world(4);
  Plc plc(world);
  expect_pose_of(1, plc.ask(1));
  world.bus.set_faults({.room = 0});
  for (int i = 0; i < 3000; ++i) {
    world.step();
    EXPECT_GT(world.station.next_us(), world.desk.now_us);
  }
  EXPECT_LE(world.station.next_us(), world.desk.now_us + kRetryMost_us);
  EXPECT_EQ(world.station.blocked_count(), 1U);
  world.bus.set_faults({});
  expect_pose_of(2, plc.ask(2));
}

}  // namespace
}  // namespace flatpose::can
