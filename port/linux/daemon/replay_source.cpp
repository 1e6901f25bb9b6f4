#include "port/linux/daemon/replay_source.hpp"

#include <utility>

#include "port/linux/files/input_error.hpp"

namespace flatpose::daemon {
namespace {

/// A file that changes as often as this while it is being taken is taken as it is.
constexpr int kRereadsMax = 3;

}  // namespace

ReplaySource::ReplaySource(const Config& config, const ScanBuffers& buffers, Doorbell& taker,
                           int wake)
    : ScanSource(wake),
      path_(config.source.replay),
      reader_(config),
      replay_(config.source.replay),
      buffers_(buffers),
      taker_(taker) {}

ReplaySource::~ReplaySource() {
  is_over_.store(true);
  bell_.ring();
  if (thread_.joinable()) thread_.join();
}

void ReplaySource::start() {
  thread_ = std::thread([this] { work(); });
}

void ReplaySource::ask() noexcept {
  is_asked_.store(true);
  bell_.ring();
}

// --- the loader's side

void ReplaySource::work() noexcept {
  while (!is_over_.load()) {
    const std::uint32_t seen = bell_.seen();
    if (is_asked_.exchange(false)) say_alive();
    bool has_loaded = false;
    for (int i = 0; i < kScanBufferCount && !has_loaded; ++i) {
      if (slots_[i].is_loaded.load(std::memory_order_acquire)) continue;
      load(i);
      has_loaded = true;
    }
    if (!has_loaded) bell_.wait(seen);
  }
}

void ReplaySource::say_alive() noexcept {
  try {
    if (replay_.has_any()) tell({.is_alive = true, .is_simulated = true});
  } catch (...) {  // its silence tells
  }
}

void ReplaySource::load(int index) noexcept {
  Slot& slot = slots_[index];
  slot.scan = {};
  slot.value_count = 0;
  slot.turn = ++turn_;
  try {
    read_into(index);
  } catch (const std::exception& error) {
    slot.scan.failure = error.what();
  }
  slot.is_loaded.store(true, std::memory_order_release);
  taker_.ring();
}

void ReplaySource::read_into(int index) {
  Slot& slot = slots_[index];
  slot.scan.name = replay_.next();
  if (slot.scan.name.empty())
    throw port::InputError(path_, "there is no scan", "put one there, or name another");
  slot.state = FileState::of(slot.scan.name);
  const std::span<float> buffer = buffers_[index];
  slot.value_count = reader_.read(slot.scan.name, buffer, slot.scan);
  slot.scan.is_simulated = true;
  // The other buffer holds the one before: nobody but this thread writes to it.
  const int other = 1 - index;
  slot.scan.is_repeated = are_same_bits(buffers_[other].first(slots_[other].value_count),
                                        buffer.first(slot.value_count));
}

// --- the taker's side

int ReplaySource::next_loaded() const noexcept {
  int found = -1;
  for (int i = 0; i < kScanBufferCount; ++i) {
    if (i == held_ || !slots_[i].is_loaded.load(std::memory_order_acquire)) continue;
    if (found < 0 || slots_[i].turn < slots_[found].turn) found = i;
  }
  return found;
}

bool ReplaySource::is_stale(const Slot& slot) const noexcept {
  return !(FileState::of(slot.scan.name) == slot.state);
}

void ReplaySource::request(const ScanOrder& order) noexcept { accepted_us_ = order.accepted_us; }

const HeldScan* ReplaySource::take(std::int64_t now_us) noexcept {
  const int next = next_loaded();
  if (next < 0) return nullptr;
  Slot& slot = slots_[next];
  if (rereads_ < kRereadsMax && is_stale(slot)) {
    ++rereads_;
    slot.is_loaded.store(false, std::memory_order_release);
    bell_.ring();
    return nullptr;
  }
  rereads_ = 0;
  const int before = std::exchange(held_, next);
  if (before >= 0) slots_[before].is_loaded.store(false, std::memory_order_release);
  bell_.ring();
  slot.scan.number = ++taken_count_;
  slot.scan.acquired_us = now_us;
  slot.scan.sensor_us = job::held_time(now_us - accepted_us_);
  return &slot.scan;
}

const HeldScan* ReplaySource::last() const noexcept {
  if (held_ < 0 || !slots_[held_].scan.failure.empty()) return nullptr;
  return &slots_[held_].scan;
}

}  // namespace flatpose::daemon
