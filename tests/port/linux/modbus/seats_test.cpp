#include "port/linux/modbus/seats.hpp"

#include <gtest/gtest.h>

#include <array>

namespace flatpose::port {
namespace {

constexpr job::Address kOwner = 0x7f000001;
constexpr job::Address kOther = 0x7f000002;
constexpr std::int64_t kNow_us = 100'000'000;
constexpr std::int64_t kLong_us = kNow_us - kIdle_us;

using Seats = std::array<Seat, 4>;

/// All taken and busy a moment ago.
Seats busy() {
  Seats seats{};
  for (Seat& seat : seats) seat = {true, true, kOther, kNow_us - 1};
  return seats;
}

TEST(Seats, FreeOneIsTakenFirst) {
  Seats seats = busy();
  seats[0].heard_us = 0;
  seats[1].has_sent_a_frame = false;
  seats[2].is_taken = false;
  EXPECT_EQ(seat_for_newcomer(seats, kOwner, kNow_us), 2);
}

TEST(Seats, WhoNeverSentAFrameGoesBeforeTheIdle) {
  Seats seats = busy();
  seats[0].heard_us = 0;
  seats[1].has_sent_a_frame = seats[3].has_sent_a_frame = false;
  seats[3].heard_us = kNow_us - 2;  // the longer there
  EXPECT_EQ(seat_for_newcomer(seats, kOwner, kNow_us), 3);
}

TEST(Seats, OldestIdleGoesThen) {
  Seats seats = busy();
  seats[1].heard_us = kLong_us;
  seats[2].heard_us = kLong_us - 1;
  EXPECT_EQ(seat_for_newcomer(seats, kOwner, kNow_us), 2);
}

TEST(Seats, OwnerIsNeverTheIdleOne) {
  Seats seats = busy();
  seats[1] = {true, true, kOwner, 0};
  seats[2].heard_us = kLong_us;
  EXPECT_EQ(seat_for_newcomer(seats, kOwner, kNow_us), 2);
  seats[2].heard_us = kNow_us;
  EXPECT_EQ(seat_for_newcomer(seats, kOwner, kNow_us), -1);
  EXPECT_EQ(seat_for_newcomer(seats, job::kNobody, kNow_us), 1);
}

TEST(Seats, OwnerThatClosesNoneLosesItsOlderConnections) {
  Seats seats = busy();
  for (std::size_t i = 0; i < seats.size(); ++i)
    seats[i] = {true, true, kOwner, static_cast<std::int64_t>(i)};
  EXPECT_EQ(seat_for_newcomer(seats, kOwner, kNow_us), 0);
}

TEST(Seats, NewcomerIsRefusedWhenAllAreBusy) {
  EXPECT_EQ(seat_for_newcomer(busy(), kOwner, kNow_us), -1);
}

}  // namespace
}  // namespace flatpose::port
