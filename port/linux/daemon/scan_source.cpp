#include "port/linux/daemon/scan_source.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>

#include "port/linux/files/input_error.hpp"

namespace flatpose::daemon {
namespace {

/// A file that changes as often as this while it is being taken is taken as it is.
constexpr int kRereadsMax = 3;

port::ReadLimits read_limits(const SearchConfig& search) {
  return {static_cast<std::int64_t>(search.limits.scan_width_px) * search.limits.scan_height_px,
          search.max_scan_bytes};
}

void wake_up(int event) noexcept {
  const std::uint64_t once = 1;
  (void)!::write(event, &once, sizeof once);
}

}  // namespace

FileState FileState::of(const std::string& path) noexcept {
  struct stat found {};
  if (::stat(path.c_str(), &found) != 0) return {};
  return {found.st_dev, found.st_ino, found.st_size, found.st_mtim};
}

bool FileState::operator==(const FileState& other) const noexcept {
  return device == other.device && inode == other.inode && bytes == other.bytes &&
         changed.tv_sec == other.changed.tv_sec && changed.tv_nsec == other.changed.tv_nsec;
}

ScanSource::ScanSource(const Config& config, const Buffers& buffers, Doorbell& taker, int wake)
    : config_(config.source),
      limits_(read_limits(config.search)),
      sides_(config.search.limits),
      replay_(config.source.replay),
      buffers_(buffers),
      taker_(taker),
      wake_(wake) {}

ScanSource::~ScanSource() {
  is_over_.store(true);
  bell_.ring();
  if (thread_.joinable()) thread_.join();
}

void ScanSource::start() {
  thread_ = std::thread([this] { work(); });
}

// --- the loader's side

void ScanSource::work() noexcept {
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

void ScanSource::say_alive() noexcept {
  try {
    if (!replay_.has_any()) return;
  } catch (...) {
    return;
  }
  job::SearchEvent event;
  event.kind = job::SearchEvent::Kind::kSourceAlive;
  event.result.is_simulated = true;
  if (events_.put(event)) wake_up(wake_);
}

void ScanSource::load(int index) noexcept {
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

void ScanSource::read_into(int index) {
  Slot& slot = slots_[index];
  slot.scan.path = replay_.next();
  if (slot.scan.path.empty())
    throw port::InputError(config_.replay, "there is no scan", "put one there, or name another");
  slot.state = FileState::of(slot.scan.path);
  const port::Scan scan = port::read_scan(slot.scan.path, limits_, config_.up);
  if (scan.width_px > sides_.scan_width_px || scan.height_px > sides_.scan_height_px)
    throw port::InputError(slot.scan.path,
                           std::to_string(scan.width_px) + " x " + std::to_string(scan.height_px) +
                               " pixels are more than [search] has memory for",
                           "raise scan_width_px and scan_height_px");
  const std::span<float> buffer = buffers_[index];
  std::copy(scan.xyz_mm.begin(), scan.xyz_mm.end(), buffer.begin());
  slot.value_count = scan.xyz_mm.size();
  slot.scan.view = scan.view();
  slot.scan.view.x_mm = buffer.data();
  slot.scan.view.y_mm = buffer.data() + 1;
  slot.scan.view.z_mm = buffer.data() + 2;
  slot.scan.up = scan.up;
  // The other buffer holds the one before: nobody but this thread writes to it.
  const std::size_t other = static_cast<std::size_t>(1 - index);
  slot.scan.is_repeated =
      slots_[other].value_count == slot.value_count &&
      std::memcmp(buffers_[other].data(), buffer.data(), slot.value_count * sizeof(float)) == 0;
}

// --- the taker's side

int ScanSource::next_loaded() const noexcept {
  int found = -1;
  for (int i = 0; i < kScanBufferCount; ++i) {
    if (i == held_ || !slots_[i].is_loaded.load(std::memory_order_acquire)) continue;
    if (found < 0 || slots_[i].turn < slots_[found].turn) found = i;
  }
  return found;
}

bool ScanSource::is_stale(const Slot& slot) const noexcept {
  return !(FileState::of(slot.scan.path) == slot.state);
}

const HeldScan* ScanSource::take(std::int64_t now_us) noexcept {
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
  return &slot.scan;
}

void ScanSource::waited(std::int64_t time_us) noexcept {
  constexpr std::int64_t kMost = std::numeric_limits<std::uint32_t>::max() - 1;
  if (held_ >= 0)
    slots_[held_].scan.sensor_us =
        static_cast<std::uint32_t>(std::clamp<std::int64_t>(time_us, 0, kMost));
}

const HeldScan* ScanSource::last() const noexcept {
  if (held_ < 0 || !slots_[held_].scan.failure.empty()) return nullptr;
  return &slots_[held_].scan;
}

}  // namespace flatpose::daemon
