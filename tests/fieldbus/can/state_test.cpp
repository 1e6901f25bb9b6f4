// Every state with every frame. What a frame does is said by one small table, and all that is not
// in it does nothing.

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tests/fieldbus/can/node.hpp"

namespace flatpose::can {
namespace {

struct State {
  std::string name;
  NetworkState network = NetworkState::kPreOperational;
  bool another_owns = false;
  std::function<void(Node&)> prepare;
};

void ask(Node& node, std::uint16_t number) {
  node.desk.write(node.desk.image(number, job::Command::kLocate, kMaster), kMaster, 0);
  node.process({});
}

// Three states of the network, six of the machine, three of the SDO server: those that there are.
std::vector<State> states() {
  const std::vector<std::pair<std::string, std::function<void(Node&)>>> machines{
      {"idle", [](Node&) {}},
      {"busy", [](Node& node) { ask(node, 40); }},
      {"done",
       [](Node& node) {
         ask(node, 40);
         node.desk.finish(node.desk.found(3));
       }},
      {"failed",
       [](Node& node) {
         ask(node, 40);
         node.desk.finish({});
       }},
      {"refused",
       [](Node& node) {
         job::CommandImage image = node.desk.image(40, job::Command::kLocate, kMaster);
         image.job = 99;
         node.desk.write(image, kMaster, 0);
       }},
      {"another's", [](Node& node) { node.desk.write(3); }}};
  const std::vector<std::pair<std::string, Bytes>> transfers{
      {"", {}},
      {" in an upload", Node::object(0x40, 0x2011, 0)},
      {" in a download", Node::object(0x21, 0x2004, 0, 14)}};
  std::vector<State> all;
  for (const auto& [network, command] :
       {std::pair{NetworkState::kPreOperational, NetworkCommand::kEnterPreOperational},
        std::pair{NetworkState::kOperational, NetworkCommand::kStart},
        std::pair{NetworkState::kStopped, NetworkCommand::kStop}}) {
    for (const auto& machine : machines) {
      for (const auto& transfer : transfers) {
        State state;
        state.name =
            machine.first + transfer.first + " in " + std::to_string(static_cast<int>(network));
        state.network = network;
        state.another_owns = machine.first == "another's";
        state.prepare = [machine, transfer, command = command](Node& node) {
          node.desk.live();
          machine.second(node);
          node.network(command);
          node.pass(20'000);
          if (!transfer.second.empty()) node.sdo(transfer.second);
          node.drain();
        };
        all.push_back(state);
      }
    }
  }
  return all;
}

void expect_untouched(Node& node, const State& state, const job::Snapshot& before,
                      std::uint8_t errors) {
  EXPECT_EQ(node.device.state(), state.network) << state.name;
  EXPECT_EQ(node.device.error_register(), errors);
  const job::Snapshot after = node.desk.see(kMaster);
  EXPECT_EQ(after.done_number, before.done_number);
  EXPECT_EQ(after.bits, before.bits);
  EXPECT_EQ(after.image, before.image);
}

bool is_ours(std::uint32_t id) {
  return id == kNmtId || id == kSyncId || id == kRpdoBase + kNode ||
         id == kSdoRequestBase + kNode || (id > kHeartbeatBase && id <= kHeartbeatBase + kNodeMax);
}

TEST(CanStates, FramesOfEveryIdAndLengthThatAreNotOursDoNothing) {
  for (const State& state : states()) {
    Node node;
    state.prepare(node);
    const job::Snapshot before = node.desk.see(kMaster);
    const std::uint8_t errors = node.device.error_register();
    for (std::uint32_t id = 0; id < 0x800; ++id) {
      if (is_ours(id)) continue;
      const bool is_near = id < 0x10 || id % 0x80 == kNode || id % 0x80 == 0;
      for (std::size_t size = is_near ? 0 : id % 9; size <= (is_near ? 8 : id % 9); ++size) {
        EXPECT_TRUE(node.take(id, Bytes(size, static_cast<std::uint8_t>(id + size))).empty())
            << state.name << ", " << id;
      }
    }
    for (std::uint32_t id = 0; id < 0x800; id += is_ours(id + 1) && id < 0x700 ? 1 : 5) {
      Frame remote = frame_of(id, Bytes(id % 9, 1));
      remote.is_remote = true;
      Frame extended = remote;
      extended.is_remote = false;
      extended.is_extended = true;
      EXPECT_TRUE(node.take(remote).empty()) << state.name << ", " << id;
      EXPECT_TRUE(node.take(extended).empty()) << state.name << ", " << id;
    }
    expect_untouched(node, state, before, errors);
  }
}

// Also those that would be ours: a command, a request, a reset.
TEST(CanStates, FdFramesOfEveryIdAndLengthDoNothing) {
  constexpr std::size_t kSizes[] = {0, 1, 2, 7, 8, 12, 16, 20, 24, 32, 48, 64};
  for (const bool has_fd : {false, true}) {
    for (const State& state : states()) {
      Node node({.fd_frame = has_fd, .carries_fd = has_fd});
      state.prepare(node);
      const job::Snapshot before = node.desk.see(kMaster);
      const std::uint8_t errors = node.device.error_register();
      for (std::uint32_t id = 0; id < 0x800; ++id) {
        if (!is_ours(id) && id % 7 != 0) continue;
        for (const std::size_t size : kSizes) {
          if (!is_ours(id) && size != kSizes[id % std::size(kSizes)]) continue;
          Bytes bytes(size, 1);
          if (size == 2) bytes[0] = 129;
          if (id == kSdoRequestBase + kNode && size > 0) bytes[0] = 0x40;
          Frame frame = frame_of(id, bytes);
          frame.is_fd = true;
          frame.has_bit_rate_switch = size % 3 == 0;
          EXPECT_TRUE(node.take(frame).empty()) << state.name << ", " << id << ", " << size;
        }
      }
      expect_untouched(node, state, before, errors);
    }
  }
}

TEST(CanStates, AClassicFrameLongerThanThereAreDoesNothing) {
  Node node;
  for (const std::uint32_t id : {kRpdoBase + kNode, kSdoRequestBase + kNode, kNmtId})
    EXPECT_TRUE(node.take(id, Bytes(9, 1)).empty());
  EXPECT_EQ(node.device.error_register(), 0);
}

// Whatever the state, the whole result begins as TPDO1 and has a pose where that has one.
TEST(CanStates, TheFdFrameIsOfOperationalAloneAndSaysWhatTheTpdosSay) {
  for (const State& state : states()) {
    Node node({.fd_frame = true, .carries_fd = true});
    state.prepare(node);
    node.pass(20'000);
    const Frame whole = node.whole();
    if (state.network != NetworkState::kOperational) {
      EXPECT_EQ(whole.size, 0) << state.name;
      continue;
    }
    ASSERT_EQ(whole.size, 64) << state.name;
    const Frame status = node.tpdo(0);
    EXPECT_TRUE(std::equal(status.data.begin(), status.data.begin() + 8, whole.data.begin()))
        << state.name;
    const bool has_pose = number_at(whole.data, 8, 4) != 0x80000000;
    EXPECT_EQ(has_pose, state.name.rfind("done", 0) == 0) << state.name;
    EXPECT_EQ(has_pose, (whole.data[2] & job::kValid) != 0);
    if (has_pose) {
      EXPECT_EQ(number_at(whole.data, 8, 4), 10'000U);
    }
  }
}

TEST(CanStates, NetworkCommandsOfEveryKindAndLength) {
  for (const State& state : states()) {
    for (int command = 0; command < 256; ++command) {
      const bool is_known = command == 1 || command == 2 || (command >= 128 && command <= 130);
      if (!is_known && command % 16 != 3) continue;
      for (const int target : {0, 9, 10, 11, 128, 255}) {
        for (std::size_t size = 0; size <= 8; ++size) {
          if (size != 2 && target != 0) continue;
          Node node;
          state.prepare(node);
          const bool was_busy = node.desk.has(job::kBusy);
          Bytes bytes{static_cast<std::uint8_t>(command), static_cast<std::uint8_t>(target)};
          bytes.resize(size);
          const auto frames = node.take(kNmtId, bytes);
          const bool is_ours = is_known && size == 2 && (target == 0 || target == kNode);
          NetworkState wanted = state.network;
          if (is_ours) {
            wanted = command == 1   ? NetworkState::kOperational
                     : command == 2 ? NetworkState::kStopped
                                    : NetworkState::kPreOperational;
          }
          EXPECT_EQ(node.device.state(), wanted) << state.name << ", " << command;
          const bool boots = is_ours && command >= 129;
          EXPECT_EQ(!frames.empty() && frames[0] == frame_of(0x70a, {0}), boots);
          const bool cancels = is_ours && command == 129 && was_busy && !state.another_owns;
          EXPECT_EQ(node.desk.has(job::kBusy), was_busy && !cancels) << state.name << command;
        }
      }
    }
  }
}

TEST(CanStates, CommandsAreTakenWhereTheyMayBe) {
  for (const State& state : states()) {
    for (std::size_t size = 0; size <= 8; ++size) {
      Node node;
      state.prepare(node);
      const bool was_busy = node.desk.has(job::kBusy);
      node.desk.order = {};
      Bytes bytes{41, 0, 0, 0, 1, 0, 1, 0};
      bytes.resize(size);
      node.take(kRpdoBase + kNode, bytes);
      node.pass(5'000);
      const bool is_operational = state.network == NetworkState::kOperational;
      const bool is_judged = is_operational && size == 8;
      const bool runs = is_judged && !was_busy && !state.another_owns;
      EXPECT_EQ(node.desk.order.kind == job::Order::Kind::kStart, runs) << state.name << size;
      EXPECT_EQ((node.device.error_register() & 0x10) != 0, is_operational && size < 8);
      if (!is_operational) continue;
      EXPECT_EQ(node.told(ReportField::kJudgedNumber) == 41, is_judged) << state.name;
      if (!is_judged || runs) continue;
      const job::Refusal why = state.another_owns ? job::Refusal::kNotOwner : job::Refusal::kBusy;
      EXPECT_EQ(node.told(ReportField::kRefusedStatus), static_cast<int>(why)) << state.name;
    }
  }
}

TEST(CanStates, SdoRequestsOfEveryCommandGetAtMostOneAnswer) {
  for (const State& state : states()) {
    for (int head = 0; head < 256; ++head) {
      Node node;
      state.prepare(node);
      Bytes request = Node::object(static_cast<std::uint8_t>(head), 0x1017, 0, 0x1234);
      for (std::size_t size : {8, 7, 0}) {
        request.resize(size);
        const auto frames = node.take(kSdoRequestBase + kNode, request);
        const bool is_answered =
            size == 8 && state.network != NetworkState::kStopped && head >> 5 != 4;
        ASSERT_EQ(frames.size(), is_answered ? 1U : 0U) << state.name << ", " << head;
        if (is_answered) {
          EXPECT_EQ(frames[0].id, 0x58aU);
          EXPECT_EQ(frames[0].size, 8);
        }
      }
      EXPECT_EQ(node.device.state(), state.network);
    }
  }
}

TEST(CanStates, SyncSendsNothingThatIsByEventAndNothingOutsideOfOperational) {
  for (const State& state : states()) {
    for (std::size_t size = 0; size <= 8; ++size) {
      Node node;
      EXPECT_EQ(node.write(0x1800, 2, 1, 1), Abort::kNone);
      state.prepare(node);
      const auto frames = node.take(kSyncId, Bytes(size));
      const bool is_operational = state.network == NetworkState::kOperational;
      ASSERT_EQ(frames.size(), is_operational ? 1U : 0U) << state.name;
      if (is_operational) {
        EXPECT_EQ(frames[0].id, 0x18aU);
      }
    }
  }
}

TEST(CanStates, HeartbeatsOfEveryNodeAndLengthKeepTheMastersLeaseAlone) {
  for (const State& state : states()) {
    Node node;
    state.prepare(node);
    const bool is_held = node.desk.see(kMaster).owner_address == kMaster;
    node.pass(3'000'000);
    for (int id = 1; id < kMaster; ++id) node.heartbeat(static_cast<std::uint8_t>(id));
    for (std::size_t size = 0; size <= 8; ++size) {
      if (size != 1) node.take(kHeartbeatBase + kMaster, Bytes(size, 5));
    }
    node.pass(1'990'000);
    const bool is_held_still = node.desk.see(kMaster).owner_address == kMaster;
    EXPECT_FALSE(is_held_still && !is_held);
    node.heartbeat();
    node.pass(3'000'000);
    EXPECT_EQ(node.desk.see(kMaster).owner_address == kMaster, is_held_still) << state.name;
    EXPECT_EQ(node.device.state(), state.network);
  }
}

}  // namespace
}  // namespace flatpose::can
