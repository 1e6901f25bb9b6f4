#include "port/linux/daemon/recorder.hpp"

#include <algorithm>
#include <exception>
#include <filesystem>
#include <span>
#include <utility>

#include "port/linux/daemon/scan_buffer.hpp"
#include "port/linux/files/atomic_file.hpp"
#include "port/linux/realtime/background_thread.hpp"

namespace flatpose::daemon {
namespace {

constexpr std::int64_t kJsonBytesMax = 4 << 20;
constexpr const char* kLastResult = "last.json";
constexpr const char* kLastPicture = "last.png";
constexpr const char* kPicks = "picks.json";

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text));
}

std::string text_of(const std::string& path) {
  const auto bytes = port::read_file(path, kJsonBytesMax);
  return std::string(port::as_text(bytes));
}

bool is_packed(const RangeImageView& view) noexcept {
  constexpr std::ptrdiff_t kPoint_bytes = 3 * sizeof(float);
  return view.y_mm == view.x_mm + 1 && view.z_mm == view.x_mm + 2 &&
         view.pixel_stride_bytes == kPoint_bytes &&
         view.row_stride_bytes == kPoint_bytes * view.width_px;
}

}  // namespace

void copy_scan(const RangeImageView& from, port::Scan& to) {
  to.width_px = from.width_px;
  to.height_px = from.height_px;
  if (is_packed(from)) {
    to.xyz_mm.assign(from.x_mm, from.x_mm + 3 * from.size());
    return;
  }
  to.xyz_mm.resize(3 * from.size());
  float* place = to.xyz_mm.data();
  for (int row = 0; row < from.height_px; ++row) {
    for (int column = 0; column < from.width_px; ++column) {
      const Vec3 p_mm = from(column, row);
      *place++ = static_cast<float>(p_mm.x);
      *place++ = static_cast<float>(p_mm.y);
      *place++ = static_cast<float>(p_mm.z);
    }
  }
}

template <class Write>
bool Recorder::try_to(const Write& write) noexcept {
  try {
    write();
    if (is_failing_) {
      is_failing_ = false;
      note("records are written again; " + std::to_string(lost_count_) + " were lost");
      lost_count_ = 0;
    }
    return true;
  } catch (const std::exception& error) {
    if (!is_failing_) note(std::string("warning: no record: ") + error.what());
    is_failing_ = true;
  }
  return false;
}

Recorder::Recorder(const Config& config, Doorbell& taker, Log& log)
    : config_(config.records),
      realtime_(config.realtime),
      taker_(taker),
      log_(log),
      folder_(config.records.folder, config.records.limits) {
  // Touched now, so that the first record costs the search no page faults.
  const std::size_t float_count = scan_buffer_bytes(config.search.limits) / sizeof(float);
  record_.loaded.scan.xyz_mm.resize(float_count);
  written_.loaded.scan.xyz_mm.resize(float_count);
  try_to([this] { folder_.open(); });
}

Recorder::~Recorder() {
  is_over_.store(true);
  bell_.ring();
  if (thread_.joinable()) thread_.join();
}

void Recorder::start() {
  thread_ = std::thread([this] { work(); });
}

// --- the search thread

void Recorder::commit(Task task) noexcept {
  task_ = task;
  saved_.store(Saved::kPending, std::memory_order_relaxed);
  is_taken_.store(true, std::memory_order_release);
  bell_.ring();
}

std::optional<bool> Recorder::saved() const noexcept {
  const Saved saved = saved_.load(std::memory_order_acquire);
  return saved == Saved::kPending ? std::nullopt : std::optional(saved == Saved::kYes);
}

bool Recorder::report(const port::Pick& pick) noexcept {
  const bool is_put = picks_.put(pick);
  bell_.ring();
  return is_put;
}

// --- the recorder

void Recorder::work() noexcept {
  for (const port::Step& step : port::set_up_background_thread(realtime_, "records"))
    if (!step.is_done) note("warning: not done: " + port::line_of(step));
  while (true) {
    const std::uint32_t seen = bell_.seen();
    const bool is_over = is_over_.load();
    port::Pick pick;
    const bool has_pick = picks_.take(pick);  // first: the record it is of was handed over before
    const bool has_record = is_taken_.load(std::memory_order_acquire);
    if (has_record) do_task();
    if (has_pick) try_to([&] { write_pick(pick); });
    tell_drops();
    if (has_record || has_pick) continue;
    if (is_over) return;
    bell_.wait(seen);
  }
}

void Recorder::do_task() noexcept {
  if (task_ == Task::kSave) {
    saved_.store(write_save() ? Saved::kYes : Saved::kNo, std::memory_order_release);
    return give_back();
  }
  std::string json;
  const bool is_written = try_to([&] { json = write_record(); });
  if (!is_written) ++lost_count_;
  if (is_written) std::swap(record_, written_);
  give_back();
  if (is_written) try_to([&] { put_last(json); });
}

void Recorder::give_back() noexcept {
  is_taken_.store(false, std::memory_order_release);
  taker_.ring();
}

std::string Recorder::write_record() {
  const std::uint32_t ticket = posted_ticket_.load(std::memory_order_acquire);
  if (ticket == record_.order.ticket) record_.times.posted_us = posted_us_.load();
  record_.dropped_count = dropped_.load();
  const port::RecordName name = folder_.named(port::name_of(record_));
  std::string json = port::record_json(record_, name);
  const std::vector<std::byte> pcd =
      record_.has_scan() ? port::record_pcd(record_) : std::vector<std::byte>{};
  folder_.add(name, pcd, json);
  last_sequence_ = name.sequence;
  if (first_sequence_ == 0) first_sequence_ = name.sequence;
  return json;
}

// The picture is of the newest record, or not there: a scan may be missing, or not to be drawn.
// What is copied here from the records need not outlast a loss of power.
void Recorder::put_last(const std::string& json) {
  folder_.put(kLastResult, bytes_of(json), port::NewName::kMayBeLost);
  if (!config_.draws) return;
  std::vector<std::byte> png;
  try {
    if (written_.has_scan()) png = port::record_picture(written_);
  } catch (const port::InputError&) {
  }
  std::error_code ignored;
  if (png.empty()) {
    std::filesystem::remove(folder_.path_of(kLastPicture), ignored);
  } else {
    folder_.put(kLastPicture, png, port::NewName::kMayBeLost);
  }
}

bool Recorder::write_save() noexcept {
  try {
    port::RecordName name = port::name_of(record_);
    name.kind = port::RecordName::Kind::kSaved;
    name.status.clear();
    name = folder_.named(name);
    folder_.save(name, port::record_pcd(record_), port::saved_json(record_, name));
    return true;
  } catch (const std::exception& error) {
    note("command " + std::to_string(record_.order.number) + ": " + error.what());
  }
  return false;
}

// Counted whether or not there is a record of it.
void Recorder::write_pick(const port::Pick& pick) {
  count_pick(pick);
  const auto name =
      first_sequence_ == 0 ? std::nullopt : folder_.find(pick.number, first_sequence_);
  if (!name)
    return note("pick of command " + std::to_string(pick.number) + ": there is no record of it");
  const std::string path = folder_.path_of(name->text() + ".json");
  const std::string json = port::with_pick(path, text_of(path), pick);
  folder_.put(name->text() + ".json", bytes_of(json));
  if (name->sequence == last_sequence_)
    folder_.put(kLastResult, bytes_of(json), port::NewName::kMayBeLost);
}

void Recorder::count_pick(const port::Pick& pick) {
  const std::string path = folder_.path_of(kPicks);
  std::string before;
  try {
    before = text_of(path);
  } catch (const port::InputError&) {  // none yet
  }
  std::string after;
  try {
    after = port::with_pick_counted(path, before, pick);
  } catch (const port::InputError& damage) {
    note("picks are counted anew: " + damage.line());
    after = port::with_pick_counted(path, {}, pick);
  }
  folder_.put(kPicks, bytes_of(after));
}

// At 1, 10, 100 and so on: a disk that is too slow for long does not fill the log.
void Recorder::tell_drops() noexcept {
  const std::uint64_t dropped = dropped_.load();
  if (dropped == 0 || dropped < told_drops_ * 10) return;
  told_drops_ = dropped;
  note("records: " + std::to_string(dropped) +
       " so far were dropped because the one before was still being written");
}

void Recorder::note(const std::string& text) noexcept {
  try {
    log_.line(text);
  } catch (...) {  // a log that fails costs no record
  }
}

}  // namespace flatpose::daemon
