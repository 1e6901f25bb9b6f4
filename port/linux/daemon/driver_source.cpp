#include "port/linux/daemon/driver_source.hpp"

#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include "port/linux/daemon/driver_scan.hpp"

namespace flatpose::daemon {
namespace {

constexpr std::int64_t kUsPerMs = 1000;
constexpr std::int64_t kAliveLimit_us = FLATPOSE_CAMERA_ALIVE_LIMIT_MS * kUsPerMs;
constexpr std::int64_t kHelloLimit_us = FLATPOSE_CAMERA_HELLO_LIMIT_MS * kUsPerMs;
/// What is turned away more often than this is not written down.
constexpr std::int64_t kTurnedAwayEvery_us = 1'000'000;
constexpr std::int64_t kSameAgainEvery_us = 60'000'000;
constexpr std::int64_t kDeaf_us = 1'000'000;
constexpr int kMessagesPerTurn = 16;
constexpr std::int64_t kNever = INT64_MAX;

}  // namespace

DriverSource::DriverSource(const Config& config, const ScanBuffers& buffers, Doorbell& taker,
                           int wake, Log& log)
    : ScanSource(wake),
      limits_(config.search.limits),
      up_(config.source.up),
      log_(log),
      listener_(config.source.place, config.source.driver),
      handover_(buffers, taker) {}

DriverSource::~DriverSource() {
  is_over_.store(true);
  event_.ring();
  if (thread_.joinable()) thread_.join();
}

void DriverSource::start() {
  thread_ = std::thread([this] { work(); });
}

void DriverSource::ask() noexcept {
  is_asked_.store(true);
  event_.ring();
}

// --- the taker's side

void DriverSource::request(const ScanOrder& order) noexcept {
  wanted_ticket_ = order.ticket;
  requests_.put(order);
  event_.ring();
}

const HeldScan* DriverSource::take(std::int64_t) noexcept { return handover_.take(wanted_ticket_); }

void DriverSource::abandon() noexcept { request({}); }

// --- the source's thread

void DriverSource::work() noexcept {
  while (!is_over_.load()) {
    try {
      turn();
    } catch (...) {  // no memory, for a text or for a driver: it may connect again
      driver_ = {};
      waiting_ = {};
      if (!std::exchange(is_capturing_, false)) continue;
      handover_.blank().scan.failure = "out of memory";
      handover_.publish(order_.ticket);
    }
  }
}

void DriverSource::turn() {
  wait_for_something();
  now_us_ = clock_.now_us();
  hear_driver();  // before newcomers: whether it lives decides about them
  take_request();
  hear_newcomers();
  accept_newcomer();
  tell_life();
}

std::int64_t DriverSource::next_us() const noexcept {
  std::int64_t next = was_fresh_ && !is_capturing_ ? driver_.heard_us() + kAliveLimit_us : kNever;
  if (is_capturing_) next = order_.answer_by_us;
  if (deaf_until_us_ > now_us_) next = std::min(next, deaf_until_us_);
  for (const DriverLine& line : waiting_)
    if (line.is_open()) next = std::min(next, line.since_us() + kHelloLimit_us);
  return next;
}

void DriverSource::wait_for_something() noexcept {
  std::array<pollfd, 3 + kWaitingMax> waited{};
  waited[0] = {event_.get(), POLLIN, 0};
  // Those below 0 are passed over.
  waited[1] = {deaf_until_us_ > now_us_ ? -1 : listener_.socket(), POLLIN, 0};
  waited[2] = {driver_.socket(), POLLIN, 0};
  for (int i = 0; i < kWaitingMax; ++i) waited[3 + i] = {waiting_[i].socket(), POLLIN, 0};
  const std::int64_t next = next_us();
  constexpr std::int64_t kMost_ms = 60'000;
  int timeout_ms = -1;
  if (next != kNever)
    timeout_ms = static_cast<int>(
        std::clamp<std::int64_t>((next - clock_.now_us()) / kUsPerMs + 1, 0, kMost_ms));
  (void)::poll(waited.data(), waited.size(), timeout_ms);
  event_.clear();
}

// A driver that captures may be deaf for as long as it may take.
bool DriverSource::driver_is_fresh() const noexcept {
  if (!driver_.is_open()) return false;
  return now_us_ - driver_.heard_us() < kAliveLimit_us ||
         (is_capturing_ && now_us_ < order_.answer_by_us);
}

void DriverSource::tell_life() noexcept {
  const bool is_fresh = driver_is_fresh();
  const bool is_asked = is_asked_.exchange(false);
  if (is_fresh && (is_asked || !was_fresh_)) tell({true, driver_.is_simulated});
  if (!is_fresh && was_fresh_) tell({false, driver_.is_simulated});
  was_fresh_ = is_fresh;
}

void DriverSource::take_request() {
  ScanOrder order;
  if (requests_.take(order)) begin(order);
}

void DriverSource::begin(const ScanOrder& order) {
  stop_capture();
  order_ = order;
  if (order.ticket == 0) return;
  is_capturing_ = true;
  if (!driver_.is_open()) return fail("no camera driver is connected; start it, or see its log");
  flatpose_camera_capture_message capture{};
  capture.head = camera_head(FLATPOSE_CAMERA_KIND_CAPTURE, sizeof capture, order.ticket);
  capture.number = order.number;
  capture.job = order.job;
  capture.accepted_us = order.accepted_us;
  capture.answer_by_us = order.answer_by_us;
  driver_.expect_answer();
  if (!driver_.say(&capture, sizeof capture)) lose_driver("it does not read");
}

// Whoever still takes that picture may stop.
void DriverSource::stop_capture() noexcept {
  if (!std::exchange(is_capturing_, false) || !driver_.is_open()) return;
  const flatpose_camera_head stop =
      camera_head(FLATPOSE_CAMERA_KIND_STOP, sizeof stop, order_.ticket);
  driver_.say(&stop, sizeof stop);
}

// --- the driver

void DriverSource::hear_driver() {
  for (int i = 0; i < kMessagesPerTurn && driver_.is_open(); ++i) {
    switch (driver_.hear(message_, now_us_)) {
      case Heard::kMessage: take_message(message_); break;
      case Heard::kNothing: return;
      case Heard::kClosed: return lose_driver("it is gone");
      case Heard::kGarbage: return lose_driver("it says what camera_protocol.h does not know");
      case Heard::kFlood: return lose_driver("it says more than is of use");
    }
  }
}

void DriverSource::take_message(const DriverMessage& message) {
  const bool is_of_this = is_capturing_ && message.head.ticket == order_.ticket;
  switch (message.head.kind) {
    case FLATPOSE_CAMERA_KIND_HELLO: return lose_driver("it says hello twice");
    case FLATPOSE_CAMERA_KIND_DONE:
      if (is_of_this) take_scan(message.done);
      return;
    case FLATPOSE_CAMERA_KIND_FAILED:
      if (is_of_this)
        fail("camera driver " + driver_.name + ": " +
             camera_text(message.reason.reason, sizeof message.reason.reason));
      return;
    default: return;  // alive: that it was heard is all
  }
}

void DriverSource::take_scan(const flatpose_camera_done_message& done) {
  const std::span<const std::byte> memory = driver_.memory.bytes();
  std::string fault = fault_of(done, memory.size(), limits_, order_, clock_.now_us());
  const ScanHandover::Blank blank = handover_.blank();
  if (fault.empty()) fault = copy_points(done, memory, blank);
  if (!fault.empty()) return fail("the scan of camera driver " + driver_.name + ": " + fault);
  const bool is_plus = done.up == FLATPOSE_CAMERA_UP_PLUS_Z;
  HeldScan& scan = blank.scan;
  scan.up = up_.value_or(is_plus ? port::Up::kPlusZ : port::Up::kMinusZ);
  scan.name = driver_.name;
  scan.is_simulated = driver_.is_simulated || (done.flags & FLATPOSE_CAMERA_IS_SIMULATED) != 0;
  scan.acquired_us = done.end_us;
  scan.sensor_us = job::held_time(done.end_us - done.start_us);
  is_capturing_ = false;
  handover_.publish(order_.ticket);
}

void DriverSource::fail(const std::string& why) {
  is_capturing_ = false;
  handover_.blank().scan.failure = why;
  handover_.publish(order_.ticket);
}

void DriverSource::lose_driver(const std::string& why) {
  const std::string name = driver_.name;
  driver_ = {};
  log_.line("camera driver " + name + ": " + why + "; closed");
  tell_life();  // first: who reads that the command is over reads that there is no driver
  if (is_capturing_) fail("camera driver " + name + " was lost before its scan was there");
}

// --- who would be the driver

void DriverSource::accept_newcomer() {
  port::FileDescriptor socket = listener_.accept();
  if (!socket.is_open()) {
    // No descriptor left, say: whoever waits to be let in would keep this thread going round.
    if (errno != EAGAIN) deaf_until_us_ = now_us_ + kDeaf_us;
    return;
  }
  DriverLine* free = nullptr;
  for (DriverLine& line : waiting_)
    if (!line.is_open()) free = &line;
  DriverLine line(std::move(socket), now_us_);
  if (free == nullptr) return turn_away(line, "too many connect at once");
  *free = std::move(line);
}

void DriverSource::hear_newcomers() {
  for (DriverLine& line : waiting_) {
    if (!line.is_open()) continue;
    const Heard heard = line.hear(message_, now_us_);
    if (heard == Heard::kMessage && message_.head.kind == FLATPOSE_CAMERA_KIND_HELLO) {
      greet(line, message_.hello);
    } else if (heard != Heard::kNothing) {
      turn_away(line, "it does not say hello as version " +
                          std::to_string(FLATPOSE_CAMERA_VERSION) + " of the protocol does");
    } else if (now_us_ - line.since_us() >= kHelloLimit_us) {
      turn_away(line, "it says nothing");
    }
  }
}

void DriverSource::greet(DriverLine& line, const flatpose_camera_hello_message& hello) {
  if (driver_is_fresh()) return turn_away(line, driver_.name + " is the driver already");
  if (driver_.is_open()) lose_driver("it hangs, and another has come");
  line.name = "'" + camera_text(hello.name, sizeof hello.name) + "'";
  line.is_simulated = (hello.flags & FLATPOSE_CAMERA_IS_SIMULATED) != 0;
  try {
    line.memory = SealedMemory(driver_memory_bytes(limits_));
  } catch (const std::system_error& error) {
    return turn_away(line, std::string("no memory to hand over: ") + error.what());
  }
  flatpose_camera_welcome_message welcome{};
  welcome.head = camera_head(FLATPOSE_CAMERA_KIND_WELCOME, sizeof welcome, 0);
  welcome.memory_bytes = line.memory.bytes().size();
  welcome.width_px_max = limits_.scan_width_px;
  welcome.height_px_max = limits_.scan_height_px;
  if (!line.say(&welcome, sizeof welcome, line.memory.file()))
    return turn_away(line, "it does not read");
  driver_ = std::exchange(line, {});
  log_.line("camera driver " + driver_.name + " is connected" +
            (driver_.is_simulated ? "; its scans are simulated" : ""));
}

void DriverSource::turn_away(DriverLine& line, const std::string& why) {
  line.say_refused(why);
  line = {};
  const bool is_known = why == turned_away_;
  if (now_us_ - turned_away_us_ < (is_known ? kSameAgainEvery_us : kTurnedAwayEvery_us)) return;
  turned_away_us_ = now_us_;
  turned_away_ = why;
  log_.line("a camera driver was turned away: " + why);
}

}  // namespace flatpose::daemon
