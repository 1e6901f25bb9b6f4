#include "port/linux/daemon/watch_source.hpp"

#include <fcntl.h>
#include <linux/magic.h>
#include <poll.h>
#include <sys/stat.h>
#include <sys/vfs.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <utility>

#include "port/linux/clock/real_clock.hpp"
#include "port/linux/files/depth_png.hpp"
#include "port/linux/files/input_error.hpp"

namespace flatpose::daemon {
namespace {

namespace fs = std::filesystem;

/// Files are dated by a clock that lags by a tick or two.
constexpr std::int64_t kDatesLag_us = 20'000;

/// When the file was born, by the clock that files are dated by; none when it is not known.
std::optional<std::int64_t> birth_us(const std::string& path) noexcept {
  struct statx found {};
  if (statx(AT_FDCWD, path.c_str(), 0, STATX_BTIME, &found) != 0) return {};
  if ((found.stx_mask & STATX_BTIME) == 0) return {};
  return port::us_of(found.stx_btime.tv_sec, found.stx_btime.tv_nsec);
}

bool is_scan_name(const std::string& name) {
  const std::string extension = fs::path(name).extension();
  return name[0] != '.' && (extension == ".pcd" || extension == ".png" || extension == ".json");
}

std::string with_extension(const std::string& name, const char* extension) {
  return fs::path(name).replace_extension(extension).string();
}

}  // namespace

bool is_on_network(const std::string& path) noexcept {
  constexpr std::array<std::uint32_t, 7> kKinds{NFS_SUPER_MAGIC, SMB_SUPER_MAGIC, 0xFF534D42,
                                                0xFE534D42,      V9FS_MAGIC,      AFS_SUPER_MAGIC,
                                                CEPH_SUPER_MAGIC};
  struct statfs found {};
  if (statfs(path.c_str(), &found) != 0) return false;
  const auto kind = static_cast<std::uint32_t>(found.f_type);
  return std::find(kKinds.begin(), kKinds.end(), kind) != kKinds.end();
}

WatchSource::WatchSource(const Config& config, const ScanBuffers& buffers, Doorbell& taker,
                         int wake, Log& log)
    : ScanSource(wake),
      path_(config.source.watch),
      reader_(config),
      log_(log),
      watch_(config.source.watch),
      handover_(buffers, taker) {}

WatchSource::~WatchSource() {
  is_over_.store(true);
  event_.ring();
  if (thread_.joinable()) thread_.join();
}

void WatchSource::start() {
  thread_ = std::thread([this] { work(); });
}

void WatchSource::ask() noexcept {
  is_asked_.store(true);
  event_.ring();
}

// --- the taker's side

void WatchSource::request(const ScanOrder& order) noexcept {
  wanted_ticket_ = order.ticket;
  Wanted wanted{order, watch_.mark(), 0};
  wanted.accepted_real_us = port::real_now_us() - (clock_.now_us() - order.accepted_us);
  requests_.put(wanted);
  event_.ring();
}

const HeldScan* WatchSource::take(std::int64_t) noexcept { return handover_.take(wanted_ticket_); }

void WatchSource::abandon() noexcept {
  wanted_ticket_ = 0;
  requests_.put({});
  event_.ring();
}

// --- the source's thread

void WatchSource::work() noexcept {
  while (!is_over_.load()) {
    try {
      turn();
    } catch (...) {  // no memory, for a text or for names
      arrivals_ = {};
      if (!std::exchange(is_wanted_, false)) continue;
      handover_.blank().scan.failure = "out of memory";
      handover_.publish(wanted_.order.ticket);
    }
  }
}

void WatchSource::turn() {
  if (!was_there_ || is_asked_.load()) attach();
  watch_.read(arrivals_, clock_.now_us());
  if (watch_.has_overflown())
    log_.line("[source] watch: more happened in " + path_ +
              " at once than the system keeps; what was being written there does not count");
  if (was_there_ == true && !watch_.is_attached()) attach();
  tell_life();
  take_request();
  search_folder();
  std::array<pollfd, 2> waited{{{event_.get(), POLLIN, 0}, {watch_.file(), POLLIN, 0}}};
  (void)::poll(waited.data(), waited.size(), -1);
  event_.clear();
}

void WatchSource::attach() {
  const bool is_there = watch_.attach();
  if (was_there_ == is_there) return;
  const bool was_lost = was_there_.has_value();
  was_there_ = is_there;
  if (!is_there) log_.line("[source] watch: there is no folder " + path_ + "; waiting for it");
  if (is_there && was_lost) log_.line("[source] watch: the folder " + path_ + " is there");
  if (is_there && is_on_network(path_))
    log_.line("warning: [source] watch: " + path_ +
              " is on a network; what other machines write there is not seen");
  tell({is_there, is_simulated_});
  if (!is_there && is_wanted_) fail("the watched folder " + path_ + " is gone");
}

void WatchSource::tell_life() noexcept {
  if (is_asked_.exchange(false) && watch_.is_attached()) tell({true, is_simulated_});
}

void WatchSource::take_request() {
  Wanted wanted;
  if (!requests_.take(wanted)) return;
  if (is_wanted_ && !arrivals_.stale().empty())
    log_.line("command " + std::to_string(wanted_.order.number) + ": " + arrivals_.stale() +
              " was finished in time, but began before the command, so it does not count");
  wanted_ = wanted;
  is_wanted_ = wanted.order.ticket != 0;
  if (is_wanted_ && !watch_.is_attached()) fail("there is no folder " + path_ + " to watch");
  if (is_wanted_ && wanted.mark == FolderWatch::kNoMark)
    fail("inotify gives no mark; raise fs.inotify.max_user_watches");
}

void WatchSource::search_folder() {
  if (!is_wanted_ || !watch_.has_passed(wanted_.mark)) return;
  const std::vector<std::string> names = arrivals_.fresh();
  for (const std::string& name : names) {
    if (!is_scan_name(name) || !is_complete(name)) continue;
    arrivals_.let_go(name);
    if (is_too_old(name)) {
      log_.line("command " + std::to_string(wanted_.order.number) + ": " + name +
                " was moved in after the command, but is older, so it does not count");
      continue;
    }
    return load(name);
  }
}

bool WatchSource::is_complete(const std::string& name) const {
  std::error_code ignored;
  const auto is_there = [&](const char* extension) {
    return fs::is_regular_file(fs::path(path_) / with_extension(name, extension), ignored);
  };
  const std::string extension = fs::path(name).extension();
  if (extension == ".png") {
    const Arrival* const camera = arrivals_.find(with_extension(name, ".json"));
    return is_there(".json") && (camera == nullptr || camera->is_finished);
  }
  if (extension == ".json")
    return !is_there(".png") && !is_there(".pcd") &&
           !port::is_depth_camera((fs::path(path_) / name).string());
  return true;
}

bool WatchSource::is_too_old(const std::string& name) const {
  const Arrival* const arrival = arrivals_.find(name);
  if (arrival == nullptr) return true;
  if (!arrival->is_from_elsewhere) return false;
  const auto born_us = birth_us((fs::path(path_) / name).string());
  return born_us && *born_us + kDatesLag_us < wanted_.accepted_real_us;
}

void WatchSource::load(const std::string& name) {
  const ScanOrder& order = wanted_.order;
  const Arrival arrival = *arrivals_.find(name);
  const std::int64_t finished_us = clock_.now_us();
  const ScanHandover::Blank blank = handover_.blank();
  HeldScan& scan = blank.scan;
  try {
    scan.name = (fs::path(path_) / name).string();
    blank.value_count = reader_.read(scan.name, blank.xyz_mm, scan);
  } catch (const port::InputError& error) {
    return fail(error.line());
  }
  is_simulated_ = scan.is_simulated;
  scan.is_repeated = are_same_bits(blank.xyz_mm.first(blank.value_count), blank.last_xyz_mm);
  // When it was acquired is not known: no later than it began to be written.
  scan.acquired_us = std::max(arrival.began_us, order.accepted_us);
  scan.sensor_us = job::held_time(finished_us - order.accepted_us);
  is_wanted_ = false;
  handover_.publish(order.ticket);
}

void WatchSource::fail(const std::string& why) {
  if (!std::exchange(is_wanted_, false)) return;
  handover_.blank().scan.failure = why;
  handover_.publish(wanted_.order.ticket);
}

}  // namespace flatpose::daemon
