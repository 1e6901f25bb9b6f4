// The node on a link: what came is taken at the time at which it came, however late it is read.

#include "flatpose/can/station.hpp"

#include <gtest/gtest.h>

#include <deque>
#include <vector>

#include "tests/fieldbus/can/node.hpp"

namespace flatpose::can {
namespace {

constexpr std::int64_t kMs = 1000;

class Wire final : public Link {
 public:
  Received receive() noexcept override {
    if (inbox.empty()) return flood;
    const Received first = inbox.front();
    inbox.pop_front();
    return first;
  }
  bool send(const Frame& frame) noexcept override {
    if (has_room) sent.push_back(frame);
    return has_room;
  }
  void put(const Frame& frame, std::int64_t at_us) {
    inbox.push_back({Received::Kind::kFrame, frame, {}, at_us});
  }

  std::deque<Received> inbox;
  Received flood;  ///< What comes when all else was read.
  std::vector<Frame> sent;
  bool has_room = true;
};

class Stand {
 public:
  explicit Stand(const Config& config = {.heartbeat_ms = 0}) : device(desk.machine) {
    EXPECT_EQ(device.init(config, desk.now_us), Status::kOk);
    desk.live();
    put(kNmtId, {1, kNode});
    serve();
  }
  void put(std::uint32_t id, const Bytes& bytes, std::int64_t later_us = 0) {
    wire.put(frame_of(id, bytes), desk.now_us + later_us);
  }
  void heartbeat(std::int64_t later_us = 0) { put(kHeartbeatBase + kMaster, {5}, later_us); }
  void command(std::uint8_t number, std::int64_t later_us = 0, std::uint8_t job = 7) {
    put(kRpdoBase + kNode, {number, 0, 0, 0, 1, 0, job, 0}, later_us);
  }
  job::Outputs serve() { return station.serve(desk.now_us); }
  job::Outputs serve_after(std::int64_t us) {
    desk.now_us += us;
    return serve();
  }
  bool is_busy() const { return (desk.see(kMaster).bits & job::kBusy) != 0; }
  bool has_lost_master() const { return device.error_register() != 0; }

  job::Desk desk;
  Device device;
  Wire wire;
  Station station{device, wire};
};

TEST(CanArrival, AHeartbeatThatCameInTimeIsInTimeHoweverLateItIsRead) {
  Stand stand({.heartbeat_ms = 0, .master_silence_ms = 250});
  stand.heartbeat();
  stand.command(1);
  stand.serve();
  ASSERT_TRUE(stand.is_busy());
  for (int i = 1; i <= 10; ++i) stand.heartbeat(i * 200 * kMs);
  stand.serve_after(2'200 * kMs);
  EXPECT_TRUE(stand.is_busy());
  EXPECT_FALSE(stand.has_lost_master());
  EXPECT_EQ(stand.station.next_us(), stand.desk.now_us + 50 * kMs) << "counted from the last";
  stand.serve_after(50 * kMs);
  EXPECT_FALSE(stand.is_busy());
  EXPECT_TRUE(stand.has_lost_master());
}

TEST(CanArrival, AHeartbeatThatCameTooLateIsLostThenAndThere) {
  Stand stand({.heartbeat_ms = 0, .master_silence_ms = 250});
  stand.heartbeat();
  stand.command(1);
  stand.serve();
  stand.heartbeat(251 * kMs);  // the one after comes in time, and the fault is over by now
  stand.heartbeat(400 * kMs);
  stand.serve_after(450 * kMs);
  EXPECT_FALSE(stand.is_busy());
  EXPECT_EQ(stand.device.state(), NetworkState::kPreOperational);
  EXPECT_EQ(stand.desk.see(kMaster).answer, job::Answer::kCancelled);
}

TEST(CanArrival, TheLeaseLastsFromTheArrivalOfWhatWasHeard) {
  Stand stand;
  stand.command(1);
  stand.serve();
  stand.heartbeat(3'000 * kMs);
  stand.serve_after(5'500 * kMs);
  EXPECT_TRUE(stand.is_busy()) << "heard before the lease was out";
  stand.serve_after(2'499 * kMs);
  EXPECT_TRUE(stand.is_busy());
  stand.serve_after(1 * kMs);
  EXPECT_EQ(stand.desk.see(kMaster).answer, job::Answer::kCancelled) << "3 s + 5 s";
}

TEST(CanArrival, AnAnswerIsDueFromTheCommandsArrivalAndNoScanCountsFromBeforeItWasRead) {
  Stand stand;
  stand.command(1, 10 * kMs, 1);
  const std::int64_t arrived_us = stand.desk.now_us + 10 * kMs;
  const job::Order order = stand.serve_after(300 * kMs).order;
  ASSERT_EQ(order.kind, job::Order::Kind::kStart);
  EXPECT_EQ(order.answer_by_us, arrived_us + 2'000 * kMs);
  EXPECT_EQ(order.accepted_us, stand.desk.now_us);
}

TEST(CanArrival, ACommandWhoseTimeWasOutWhenItWasReadIsAnsweredAndNotLeftRunning) {
  Stand stand;
  stand.command(1, 0, 1);
  const job::Outputs out = stand.serve_after(2'100 * kMs);
  EXPECT_EQ(out.order.kind, job::Order::Kind::kStop);
  EXPECT_EQ(stand.desk.see(kMaster).answer, job::Answer::kAnswerLate);
}

// The station may stand still in mid-call: then what it reads came after the call's own time.
TEST(CanArrival, OfAFrameThatComesWhileOthersAreServedIsItsOwn) {
  Stand stand({.heartbeat_ms = 0, .master_silence_ms = 250});
  stand.heartbeat();
  stand.command(1);
  for (int i = 1; i < 10; ++i) stand.heartbeat(i * 100 * kMs);
  const job::Order order = stand.serve().order;
  EXPECT_EQ(order.accepted_us, stand.desk.now_us);
  EXPECT_EQ(stand.station.next_us(), stand.desk.now_us + 1'150 * kMs);
  stand.serve_after(1'000 * kMs);
  EXPECT_TRUE(stand.is_busy());
}

TEST(CanArrival, IsNeverBeforeTheLastAndNowWhenNobodyKnows) {
  Stand stand({.heartbeat_ms = 0, .master_silence_ms = 250});
  stand.heartbeat();
  stand.serve();
  EXPECT_EQ(stand.station.next_us(), stand.desk.now_us + 250 * kMs);
  stand.serve_after(100 * kMs);
  stand.heartbeat(-1'000'000 * kMs);
  stand.serve();
  EXPECT_EQ(stand.station.next_us(), stand.desk.now_us + 250 * kMs);
  stand.desk.now_us += 100 * kMs;
  stand.wire.inbox.push_back(
      {Link::Received::Kind::kFrame, frame_of(kHeartbeatBase + kMaster, {5}), {}});
  stand.serve();
  EXPECT_EQ(stand.station.next_us(), stand.desk.now_us + 250 * kMs) << "a time that nobody knows";
}

TEST(CanArrival, WhileThereIsMoreToReadNoTimePassesBeyondIt) {
  Stand stand({.heartbeat_ms = 0, .master_silence_ms = 250});
  stand.heartbeat();
  stand.command(1);
  stand.serve();
  for (int i = 1; i <= 3 * kFramesPerTurn; ++i)
    stand.heartbeat(i *
                    kMs);  // the master beats each millisecond, and the bus's thread stood still
  stand.desk.now_us += 3 * kFramesPerTurn * kMs + 100 * kMs;
  for (int turn = 0; turn < 3; ++turn) {
    stand.serve();
    EXPECT_EQ(stand.station.next_us(), stand.desk.now_us) << "at once";
    stand.station.tell(stand.desk.now_us);
    EXPECT_TRUE(stand.is_busy()) << turn;
  }
  stand.serve();
  EXPECT_TRUE(stand.is_busy());
  EXPECT_FALSE(stand.has_lost_master());
  EXPECT_EQ(stand.station.next_us(), stand.desk.now_us + 150 * kMs);
}

TEST(CanArrival, AFloodThatNeverEndsHoldsNoTimeBackAndNoneOfOthers) {
  Stand stand({.heartbeat_ms = 100, .master_silence_ms = 250});
  stand.heartbeat();
  stand.command(1);
  stand.serve();
  stand.wire.sent.clear();
  for (int i = 1; i <= 6; ++i) {
    ASSERT_EQ(stand.has_lost_master(), i == 6) << i;
    stand.desk.now_us += 50 * kMs;
    stand.wire.flood = {
        Link::Received::Kind::kFrame, frame_of(kHeartbeatBase + 3, {5}), {}, stand.desk.now_us};
    stand.serve();
    EXPECT_EQ(stand.station.next_us(), stand.desk.now_us) << "there is more, and others come first";
  }
  EXPECT_FALSE(stand.is_busy());
  int beats = 0;
  for (const Frame& frame : stand.wire.sent) beats += frame.id == 0x70a ? 1 : 0;
  EXPECT_EQ(beats, 3);
}

TEST(CanArrival, WhatIsSentHasTheTimeOfSending) {
  Stand stand({.heartbeat_ms = 1000});
  stand.wire.sent.clear();
  stand.put(kSdoRequestBase + kNode, Node::object(0x40, 0x1000, 0), 5 * kMs);
  stand.put(kSdoRequestBase + kNode, Node::object(0x40, 0x1001, 0), 6 * kMs);
  stand.serve_after(1'500 * kMs);
  int beats = 0, answers = 0;
  for (const Frame& frame : stand.wire.sent) {
    beats += frame.id == 0x70a ? 1 : 0;
    answers += frame.id == 0x58a ? 1 : 0;
  }
  EXPECT_EQ(beats, 1);
  EXPECT_EQ(answers, 2) << "each request has its answer";
}

TEST(CanArrival, TellingPassesNoTimeForWhatMayWaitUnread) {
  Stand stand({.heartbeat_ms = 0, .master_silence_ms = 250});
  stand.heartbeat();
  stand.command(1);
  stand.serve();
  stand.heartbeat(200 * kMs);
  stand.desk.now_us += 400 * kMs;
  stand.station.tell(stand.desk.now_us);
  EXPECT_FALSE(stand.has_lost_master());
  stand.serve();
  EXPECT_TRUE(stand.is_busy());
  EXPECT_FALSE(stand.has_lost_master());
}

TEST(CanStation, TellsWhatOthersChangedAndReadsNothing) {
  Stand stand;
  stand.command(1);
  stand.serve();
  stand.desk.pass(10 * kMs);
  stand.heartbeat();
  stand.desk.tell(job::SearchEvent::Kind::kFinished, 1, stand.desk.found(1));
  stand.wire.sent.clear();
  stand.station.tell(stand.desk.now_us);
  EXPECT_FALSE(stand.wire.sent.empty());
  EXPECT_EQ(stand.wire.inbox.size(), 1U);
}

TEST(CanStation, AnFdFrameWithoutRoomIsMadeAnewWithItsAgeOfThen) {
  Stand stand({.heartbeat_ms = 0, .fd_frame = true, .carries_fd = true});
  stand.command(1, 0, 1);
  stand.serve();
  stand.desk.pass(10 * kMs);
  stand.wire.has_room = false;
  stand.desk.tell(job::SearchEvent::Kind::kFinished, 1, stand.desk.found(1));
  stand.station.tell(stand.desk.now_us);
  std::int64_t wait_us = 0;
  for (int i = 0; i < 12; ++i) {
    wait_us = stand.station.next_us() - stand.desk.now_us;
    EXPECT_EQ(wait_us, std::min<std::int64_t>(kRetryMost_us, kRetry_us << i));
    stand.serve_after(wait_us);
  }
  EXPECT_EQ(stand.station.blocked_count(), 1U);
  stand.wire.has_room = true;
  stand.wire.sent.clear();
  stand.serve_after(500 * kMs);
  ASSERT_EQ(stand.wire.sent.size(), 5U);
  EXPECT_TRUE(stand.wire.sent[0].is_fd);
  const std::uint32_t age_ms = number_at(stand.wire.sent[0].data, 52, 4);
  EXPECT_EQ(age_ms, (63 + 6 * 64) + 500U);
  EXPECT_GT(stand.station.next_us(), stand.desk.now_us + kRetryMost_us);
}

TEST(CanStation, WhatHasNoRoomWaitsNoLongerForBeingTriedInBetween) {
  for (const bool has_fd : {false, true}) {
    Stand stand({.heartbeat_ms = 0, .fd_frame = has_fd, .carries_fd = has_fd});
    stand.desk.pass(10 * kMs);
    stand.wire.has_room = false;
    stand.command(1);
    stand.serve();
    std::int64_t retry_us = stand.desk.now_us + kRetry_us;
    for (int i = 1; i < 10; ++i) {
      for (int k = 0; k < 5; ++k) {
        stand.heartbeat();
        stand.serve();
        stand.station.tell(stand.desk.now_us);
      }
      EXPECT_EQ(stand.station.next_us(), retry_us) << i;
      stand.serve_after(retry_us - 1 - stand.desk.now_us);
      EXPECT_EQ(stand.station.next_us(), retry_us) << i;
      stand.serve_after(1);
      retry_us += std::min<std::int64_t>(kRetryMost_us, kRetry_us << i);
    }
    EXPECT_EQ(stand.station.blocked_count(), 1U);
    stand.wire.has_room = true;
    stand.serve();
    EXPECT_GT(stand.station.next_us(), stand.desk.now_us + kRetryMost_us);
  }
}

TEST(CanStation, AnFdFrameThatIsTurnedOffWhileItHasNoRoomIsTriedNoMore) {
  Stand stand({.heartbeat_ms = 0, .fd_frame = true, .carries_fd = true});
  stand.wire.has_room = false;
  stand.command(1, 0, 6);
  stand.serve_after(10 * kMs);
  stand.put(kNmtId, {128, kNode});
  stand.serve_after(10 * kMs);
  EXPECT_GT(stand.station.next_us(), stand.desk.now_us + kRetryMost_us);
}

}  // namespace
}  // namespace flatpose::can
