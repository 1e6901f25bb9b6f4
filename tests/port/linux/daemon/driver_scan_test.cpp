#include "port/linux/daemon/driver_scan.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <thread>

#include "port/linux/daemon/sealed_memory.hpp"

namespace flatpose::daemon {
namespace {

constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();

/// Memory, and the answer that speaks of it.
struct Made {
  std::vector<float> memory;
  flatpose_camera_done_message done{};

  [[nodiscard]] float at(std::uint64_t offset_bytes, int column, int row) const {
    return memory.at((offset_bytes + static_cast<std::uint64_t>(row) * done.row_stride_bytes +
                      static_cast<std::uint64_t>(column) * done.pixel_stride_bytes) /
                     sizeof(float));
  }
};

Made made(std::mt19937& random) {
  Made made;
  made.memory.resize(600);
  for (float& value : made.memory) value = static_cast<float>(random() % 1000);
  for (int i = 0; i < 50; ++i) made.memory[random() % 600] = kMissing;
  const auto floats = [&](unsigned most) {
    return 4 * static_cast<std::uint64_t>(random() % most);
  };
  made.done.width_px = static_cast<int>(2 + random() % 5);
  made.done.height_px = static_cast<int>(2 + random() % 5);
  made.done.x_offset_bytes = floats(40);
  made.done.y_offset_bytes = random() % 2 ? made.done.x_offset_bytes + 4 : floats(40);
  made.done.z_offset_bytes = random() % 2 ? made.done.y_offset_bytes + 4 : floats(40);
  made.done.pixel_stride_bytes = random() % 2 ? 12 : 4 + floats(6);
  made.done.row_stride_bytes = 4 + floats(60);
  return made;
}

class Buffers {
 public:
  Buffers() : handover({one_, two_}, bell_) {}
  std::array<float, 300> one_{};
  std::array<float, 300> two_{};
  Doorbell bell_;
  ScanHandover handover;
};

TEST(DriverScan, IsCopiedFromEveryLayoutAsItStands) {
  std::mt19937 random(7);
  for (int round = 0; round < 2000; ++round) {
    const Made made = daemon::made(random);
    Buffers buffers;
    const ScanHandover::Blank blank = buffers.handover.blank();
    ASSERT_EQ(copy_points(made.done, std::as_bytes(std::span(made.memory)), blank), "");
    const RangeImageView& view = blank.scan.view;
    ASSERT_EQ(view.width_px, made.done.width_px);
    ASSERT_EQ(view.height_px, made.done.height_px);
    for (int row = 0; row < view.height_px; ++row) {
      for (int column = 0; column < view.width_px; ++column) {
        const Vec3 p = view(column, row);
        const double expected[3] = {made.at(made.done.x_offset_bytes, column, row),
                                    made.at(made.done.y_offset_bytes, column, row),
                                    made.at(made.done.z_offset_bytes, column, row)};
        ASSERT_EQ(std::isnan(p.x) ? -1.0 : p.x, std::isnan(expected[0]) ? -1.0 : expected[0]);
        ASSERT_EQ(std::isnan(p.y) ? -1.0 : p.y, std::isnan(expected[1]) ? -1.0 : expected[1]);
        ASSERT_EQ(std::isnan(p.z) ? -1.0 : p.z, std::isnan(expected[2]) ? -1.0 : expected[2]);
      }
    }
  }
}

TEST(DriverScan, NoCoordinateLiesBeyondAKilometre) {
  const float most = 1e6F;
  const float inf = std::numeric_limits<float>::infinity();
  const std::vector<float> sound{0.0F, -0.0F, most, -most, 1e-40F, kMissing, -kMissing};
  const std::vector<float> absurd{std::nextafter(most, inf), -std::nextafter(most, inf), inf, -inf,
                                  std::numeric_limits<float>::max()};
  std::vector<float> memory(12);
  flatpose_camera_done_message done{};
  done.width_px = done.height_px = 2;
  done.y_offset_bytes = 4;
  done.z_offset_bytes = 8;
  done.pixel_stride_bytes = 12;
  done.row_stride_bytes = 24;
  Buffers buffers;
  for (float& place : memory) {
    const auto fault_with = [&](float value) {
      place = value;
      return copy_points(done, std::as_bytes(std::span(memory)), buffers.handover.blank());
    };
    for (const float value : absurd) EXPECT_NE(fault_with(value), "") << value;
    for (const float value : sound) EXPECT_EQ(fault_with(value), "") << value;
  }
}

TEST(DriverScan, IsToldFromTheLastByAnyBit) {
  std::mt19937 random(9);
  for (int round = 0; round < 200; ++round) {
    Made made = daemon::made(random);
    Buffers buffers;
    const auto copied = [&](std::uint32_t ticket) {
      const ScanHandover::Blank blank = buffers.handover.blank();
      EXPECT_EQ(copy_points(made.done, std::as_bytes(std::span(made.memory)), blank), "");
      buffers.handover.publish(ticket);
      return buffers.handover.take(ticket);
    };
    EXPECT_FALSE(copied(1)->is_repeated);
    EXPECT_TRUE(copied(2)->is_repeated);
    const int column = static_cast<int>(random()) & (made.done.width_px - 1) & 1;
    made.memory.at((made.done.z_offset_bytes +
                    static_cast<std::uint64_t>(column) * made.done.pixel_stride_bytes) /
                   4) = -3.0F;
    EXPECT_FALSE(copied(3)->is_repeated);
    EXPECT_TRUE(copied(4)->is_repeated);
  }
}

// Whether an answer lies within the memory, against counting its farthest place in wide numbers.
TEST(DriverScan, LayoutIsTakenExactlyWhenAllOfItLiesWithin) {
  locate::Limits limits;
  limits.scan_width_px = 8;
  limits.scan_height_px = 8;
  const ScanOrder order{1, 1, 1, 10, 100};
  std::mt19937_64 random(11);
  int taken_count = 0;
  for (int round = 0; round < 5000; ++round) {
    std::mt19937 small(static_cast<unsigned>(random()));
    flatpose_camera_done_message done = made(small).done;
    done.up = FLATPOSE_CAMERA_UP_MINUS_Z;
    done.start_us = 10;
    done.end_us = 20;
    if (random() % 8 == 0) done.row_stride_bytes = random() & ~std::uint64_t{3};
    if (random() % 8 == 0) done.z_offset_bytes = random() & ~std::uint64_t{3};
    if (random() % 8 == 0) done.pixel_stride_bytes = random() & ~std::uint64_t{3};
    const std::size_t memory_bytes = 4 * (random() % 600);
    bool is_within = done.pixel_stride_bytes > 0 && done.row_stride_bytes > 0;
    for (const std::uint64_t offset :
         {done.x_offset_bytes, done.y_offset_bytes, done.z_offset_bytes}) {
      const long double last =
          static_cast<long double>(offset) +
          static_cast<long double>(done.row_stride_bytes) * (done.height_px - 1) +
          static_cast<long double>(done.pixel_stride_bytes) * (done.width_px - 1) + 4;
      is_within = is_within && last <= static_cast<long double>(memory_bytes);
    }
    const std::string fault = fault_of(done, memory_bytes, limits, order, 30);
    ASSERT_EQ(fault.empty(), is_within) << fault;
    taken_count += is_within ? 1 : 0;
  }
  EXPECT_GT(taken_count, 200);
}

TEST(SealedMemory, CannotBeCutShortAndIsSeenWhenWritten) {
  const SealedMemory memory(8192);
  EXPECT_NE(ftruncate(memory.file(), 0), 0);
  EXPECT_NE(ftruncate(memory.file(), 9000), 0);
  EXPECT_NE(fcntl(memory.file(), F_ADD_SEALS, F_SEAL_WRITE), 0);
  void* const at = mmap(nullptr, 8192, PROT_READ | PROT_WRITE, MAP_SHARED, memory.file(), 0);
  ASSERT_NE(at, MAP_FAILED);
  static_cast<char*>(at)[8191] = 'x';
  EXPECT_EQ(memory.bytes()[8191], std::byte{'x'});
  munmap(at, 8192);
}

TEST(ScanHandover, GivesAScanToItsTicketAlone) {
  Buffers buffers;
  ScanHandover& handover = buffers.handover;
  EXPECT_EQ(handover.take(1), nullptr);
  EXPECT_EQ(handover.last(), nullptr);
  (void)handover.blank();
  handover.publish(1);
  EXPECT_EQ(handover.take(2), nullptr);
  const HeldScan* const first = handover.take(1);
  ASSERT_NE(first, nullptr);
  EXPECT_EQ(handover.last(), first);
  EXPECT_EQ(handover.take(1), nullptr);  // once
  EXPECT_NE(&handover.blank().scan, first);
  handover.publish(2);
  EXPECT_NE(handover.take(2), first);
}

TEST(ScanHandover, LastIsNoneAfterAFailure) {
  Buffers buffers;
  ScanHandover& handover = buffers.handover;
  (void)handover.blank();
  handover.publish(1);
  const HeldScan* const sound = handover.take(1);
  handover.blank().scan.failure = "dark";
  handover.publish(2);
  EXPECT_EQ(handover.take(2)->failure, "dark");
  EXPECT_EQ(handover.last(), nullptr);
  (void)handover.blank();
  handover.publish(3);
  EXPECT_NE(handover.take(3), sound);  // held all the time, to be compared with
  EXPECT_NE(handover.last(), nullptr);
}

TEST(ScanHandover, BetweenThreadsNeverGivesAnotherTicketsPoints) {
  Buffers buffers;
  ScanHandover& handover = buffers.handover;
  Latest<ScanOrder> requests;
  std::atomic<bool> is_over{false};
  std::jthread source([&] {
    ScanOrder order;
    while (!is_over.load()) {
      if (!requests.take(order)) continue;
      const ScanHandover::Blank blank = handover.blank();
      std::fill(blank.xyz_mm.begin(), blank.xyz_mm.end(), static_cast<float>(order.ticket));
      blank.scan.view.x_mm = blank.xyz_mm.data();
      handover.publish(order.ticket);
    }
  });
  std::mt19937 random(13);
  int taken_count = 0;
  for (std::uint32_t ticket = 1; ticket <= 2'000; ++ticket) {
    requests.put({ticket, 0, 0, 0, 0});
    const HeldScan* scan = nullptr;
    const bool is_patient = ticket % 4 == 0;
    for (unsigned i = 0; (is_patient || i < random() % 200) && scan == nullptr; ++i)
      scan = handover.take(ticket);
    if (scan == nullptr) continue;
    ++taken_count;
    for (int i = 0; i < 300; ++i) ASSERT_EQ(scan->view.x_mm[i], static_cast<float>(ticket));
  }
  is_over.store(true);
  EXPECT_GE(taken_count, 500);
}

}  // namespace
}  // namespace flatpose::daemon
