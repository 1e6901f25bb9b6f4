#include "bench/soak/plc.hpp"

#include <chrono>
#include <memory>
#include <optional>
#include <stdexcept>
#include <thread>

#include "flatpose/job/command.hpp"
#include "flatpose/job/status.hpp"

namespace flatpose::soak {
namespace {

using result_map::Field;

constexpr std::int64_t kPatience_us = 60'000'000;
constexpr std::int64_t kUs_ns = 1000;

void sleep_us(std::int64_t us) {
  if (us > 0) std::this_thread::sleep_for(std::chrono::microseconds(us));
}

struct Block {
  std::array<std::uint8_t, kBlockBytes> bytes{};

  [[nodiscard]] std::uint32_t operator[](Field field) const {
    const result_map::Entry& entry = *result_map::find(field);
    const auto at = 9 + 2 * static_cast<std::size_t>(entry.address - result_map::kResultAddress);
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 2 * static_cast<std::size_t>(entry.words()); ++i)
      value = value << 8 | bytes[at + i];
    return value;
  }
  [[nodiscard]] bool is_torn() const {
    return bytes[kBlockBytes - 2] * 256U + bytes[kBlockBytes - 1] != (*this)[Field::kDoneNumber];
  }
};

class Plc {
 public:
  explicit Plc(const Plan& plan)
      : plan_(plan), line_(std::make_unique<Line>(plan.port)), echo_(plan.echo_port) {}

  Tally run() {
    wait_until_ready();
    const std::int64_t start_us = now_ns() / kUs_ns;
    std::uint16_t number = plan_.first_number;
    for (std::int64_t i = 0; i < plan_.trigger_count; ++i) {
      if (plan_.time_max_us > 0 && now_ns() / kUs_ns - start_us > plan_.time_max_us) break;
      trigger(number);
      if (++number == 0) number = 1;
      sleep_us(plan_.pause_us);
    }
    return std::move(tally_);
  }

 private:
  void wait_until_ready() {
    const std::int64_t end_us = now_ns() / kUs_ns + kPatience_us;
    while ((read()[Field::kBits] & job::kReady) == 0) {
      if (now_ns() / kUs_ns > end_us) throw std::runtime_error("it never was ready");
      sleep_us(1000);
    }
    scans_before_ = 0;
  }

  /// The block, timed, and an echo of the same size beside it.
  Block read() {
    constexpr std::array<std::uint8_t, kReadBytes> request{
        0, 1, 0, 0, 0, 6, 1, 4, 0, result_map::kResultAddress, 0, result_map::kResultWords};
    Block block;
    tally_.read_ns.push_back(line_->exchange_ns(request, block.bytes));
    Block unused;
    tally_.echo_ns.push_back(echo_.exchange_ns(request, unused.bytes));
    if (block.is_torn()) ++tally_.torn_count;
    return block;
  }

  void write(std::uint16_t number) {
    const std::array<std::uint8_t, 15> request{0,
                                               2,
                                               0,
                                               0,
                                               0,
                                               9,
                                               1,
                                               16,
                                               0,
                                               0,
                                               0,
                                               1,
                                               2,
                                               static_cast<std::uint8_t>(number >> 8),
                                               static_cast<std::uint8_t>(number)};
    std::array<std::uint8_t, 12> response{};
    tally_.write_ns.push_back(line_->exchange_ns(request, response));
    if (response[7] != 16) throw std::runtime_error("a write was refused by an exception");
  }

  void trigger(std::uint16_t number) {
    Trip trip{number, now_ns() / kUs_ns, 0, 0};
    write(number);
    const std::int64_t end_us = trip.written_us + kPatience_us;
    while (true) {
      sleep_us(plan_.poll_us);
      const Block block = read();
      trip.read_us = now_ns() / kUs_ns;
      if (block[Field::kRefusedNumber] == number) {
        ++tally_.refused_count;
        return;
      }
      if (block[Field::kDoneNumber] == number) return take(block, trip);
      if (trip.read_us > end_us) {
        ++tally_.lost_count;
        return;
      }
    }
  }

  void take(const Block& block, Trip& trip) {
    trip.status = static_cast<std::int16_t>(block[Field::kStatus]);
    ++tally_.done_count;
    ++tally_.statuses[trip.status];
    tally_.trips.push_back(trip);
    const std::uint32_t scans = block[Field::kScanNumber];
    if (scans == 0) {  // the answer is of no scan
      ++answers_since_scan_;
      return;
    }
    // A scan that could not be read was taken too: only one that no number asked for is too many.
    const std::uint32_t asked = answers_since_scan_ + 1;
    if (scans_before_ != 0 && scans - scans_before_ > asked) ++tally_.doubled_count;
    scans_before_ = scans;
    answers_since_scan_ = 0;
  }

  const Plan plan_;
  std::unique_ptr<Line> line_;
  Line echo_;
  Tally tally_;
  std::uint32_t scans_before_ = 0;
  std::uint32_t answers_since_scan_ = 0;
};

}  // namespace

Tally run_plc(const Plan& plan) { return Plc(plan).run(); }

}  // namespace flatpose::soak
