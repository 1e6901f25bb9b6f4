#include "port/linux/daemon/search_engine.hpp"

#include <unistd.h>

#include <chrono>
#include <csignal>
#include <stdexcept>
#include <string>
#include <utility>

#include "port/linux/clock/real_clock.hpp"
#include "port/linux/realtime/thread_setup.hpp"

namespace flatpose::daemon {
namespace {

using Kind = job::SearchEvent::Kind;
using job::Answer;
using job::Command;

std::span<float> floats(port::PrefaultedMemory& memory) noexcept {
  const std::span<std::byte> bytes = memory.span();
  return {reinterpret_cast<float*>(bytes.data()), bytes.size() / sizeof(float)};
}

/// What a search has no say in.
void add_scan(const HeldScan& scan, job::ScanResult& result) noexcept {
  result.has_scan = true;
  result.scan_number = scan.number;
  result.acquired_us = scan.acquired_us;
  result.sensor_us = scan.sensor_us;
  result.is_repeated = scan.is_repeated;
  result.is_simulated = scan.is_simulated;
}

job::ScanResult result_of(const HeldScan* scan, Answer answer) noexcept {
  job::ScanResult result;
  result.answer = answer;
  if (scan != nullptr) add_scan(*scan, result);
  return result;
}

}  // namespace

SearchEngine::SearchEngine(const Config& config, std::shared_ptr<const JobSet> jobs, Log& log)
    : config_(config),
      log_(log),
      arena_(search_arena_bytes(config.search.limits)),
      buffers_{port::PrefaultedMemory(scan_buffer_bytes(config.search.limits)),
               port::PrefaultedMemory(scan_buffer_bytes(config.search.limits))},
      shelf_(std::move(jobs)),
      search_(shelf_.use(0), locator_) {
  const Status status = locator_.init(config.search.limits, arena_.span());
  if (status != Status::kOk)
    throw std::runtime_error(std::string("the limits of [search]: ") + to_string(status));
  source_ = make_scan_source(config, {floats(buffers_[0]), floats(buffers_[1])}, bell_,
                             event_.get(), log);
  if (!config.records.folder.empty()) recorder_ = std::make_unique<Recorder>(config, bell_, log);
}

void SearchEngine::start() {
  thread_ = std::thread([this] { work(); });
  is_ready_.wait(false);
  if (failure_) {
    stop();
    std::rethrow_exception(failure_);
  }
  if (source_) source_->start();
  if (recorder_) recorder_->start();
}

SearchEngine::~SearchEngine() { stop(); }

void SearchEngine::stop() noexcept {
  is_over_.store(true);
  bell_.ring();
  if (thread_.joinable()) thread_.join();
}

// --- the bus's side

std::uint32_t SearchEngine::ask() noexcept {
  const std::uint32_t asked = asked_.fetch_add(1) + 1;
  bell_.ring();
  if (source_) source_->ask();
  return asked;
}

void SearchEngine::give(const job::Order& order) noexcept {
  // First: a search that finds it not yet in force would end at once.
  in_force_.store(order.ticket);
  orders_.put({order, shelf_.generation()});
  bell_.ring();
}

bool SearchEngine::take(job::SearchEvent& event) noexcept {
  if ((source_ && source_->hear(event)) || events_.take(event)) return true;
  const std::uint32_t answered = answered_.load();
  if (std::exchange(heard_, answered) == answered) return false;
  event = {};
  event.kind = Kind::kSearchAlive;
  return true;
}

// --- the search thread

void SearchEngine::work() noexcept {
  try {
    // Before this thread is set up itself: threads inherit processor and priority from their maker.
    workers_ = std::make_unique<port::WorkerPool>(config_.search.thread_count, config_.realtime);
    steps_ = port::set_up_this_thread(config_.realtime, 0, "search 0");
    port::append(steps_, port::Steps(workers_->steps()));
  } catch (...) {
    failure_ = std::current_exception();
  }
  is_ready_.store(true);
  is_ready_.notify_one();
  while (!is_over_.load()) {
    const std::uint32_t seen = bell_.seen();
    answer_asker();
    const std::uint32_t generation = shelf_.generation();  // before looking for orders of an older
    Given given;
    if (orders_.take(given)) {
      search_.use(shelf_.use(given.generation));
      execute(given.order);
    } else {
      search_.use(shelf_.use(generation));
      bell_.wait(seen);
    }
  }
}

// From the search thread and from its workers: only who answers first writes anything.
void SearchEngine::answer_asker() noexcept {
  const std::uint32_t asked = asked_.load(std::memory_order_relaxed);
  if (answered_.load(std::memory_order_relaxed) == asked || answered_.exchange(asked) == asked)
    return;
  wake_bus();
}

void SearchEngine::execute(const job::Order& order) noexcept {
  if (order.kind != job::Order::Kind::kStart) return;
  const Replaced replaced(*this, order.ticket);
  switch (order.command) {
    case Command::kLocate: return locate(order, next_scan(order, replaced), replaced);
    case Command::kLocateInLast:
      return locate(order, source_ ? source_->last() : nullptr, replaced);
    case Command::kCapture: {
      const HeldScan* const scan = next_scan(order, replaced);
      const job::ScanResult result =
          result_of(scan, scan == nullptr ? Answer::kNoScan : Answer::kOk);
      finish(order, result);
      return keep(order, result, scan, false);
    }
    case Command::kVerifyAlignment: return verify(order, replaced);
    case Command::kSaveScan: return finish(order, save_scan(order, replaced));
    case Command::kReloadJobs: return finish(order, reload(order, replaced));
    case Command::kReportPick: finish(order, Answer::kOk); return report_pick(order);
    default: return finish(order, Answer::kInternal);
  }
}

void SearchEngine::locate(const job::Order& order, const HeldScan* scan,
                          const Cancel& replaced) noexcept {
  if (scan == nullptr) {
    finish(order, Answer::kNoScan);
    return keep(order, result_of(nullptr, Answer::kNoScan), nullptr, false);
  }
  times_ = {.begun_us = clock_.now_us()};
  job::ScanResult result = search_.run(order, *scan, {clock_, *workers_, &replaced});
  add_scan(*scan, result);
  times_.ended_us = clock_.now_us();
  finish(order, result);
  keep(order, result, scan, true);
}

// In the locator's memory, which holds nothing between two searches.
void SearchEngine::verify(const job::Order& order, const Cancel& replaced) noexcept {
  if (!search_.can_verify(order)) return finish(order, Answer::kNoAlignment);
  const HeldScan* const scan = next_scan(order, replaced);
  if (scan == nullptr) return finish(order, Answer::kNoScan);
  std::string told;
  job::ScanResult result =
      search_.verify(order, *scan, Arena(arena_.span()), {clock_, *workers_, &replaced}, told);
  add_scan(*scan, result);
  finish(order, result);
  keep(order, result, scan, false);
  if (!told.empty()) note("command " + std::to_string(order.number) + ": " + told);
}

// Another thread reads the files; this one makes room for what comes, and waits.
Answer SearchEngine::reload(const job::Order& order, const Cancel& replaced) noexcept {
  reload_answer_.store(0);
  reload_asked_.store(order.ticket);
  (void)::kill(::getpid(), SIGHUP);
  while (!replaced.is_asked_for()) {
    const std::uint32_t seen = bell_.seen();
    answer_asker();
    search_.use(shelf_.use(shelf_.generation()));
    const std::uint64_t answer = reload_answer_.load();
    if (answer >> 1 == order.ticket) {
      reload_asked_.store(0);
      return (answer & 1) != 0 ? Answer::kOk : Answer::kJobsRefused;
    }
    bell_.wait(seen);
  }
  reload_asked_.store(0);
  return Answer::kCancelled;
}

// The scan of this trigger; null when it could not be read or nobody wants it any more.
const HeldScan* SearchEngine::next_scan(const job::Order& order, const Cancel& replaced) noexcept {
  if (!source_) return nullptr;
  const HeldScan* scan = nullptr;
  source_->request({order.ticket, order.number, order.job, order.accepted_us, order.answer_by_us});
  while (true) {
    const std::uint32_t seen = bell_.seen();
    if (replaced.is_asked_for()) break;
    scan = source_->take(clock_.now_us());
    if (scan != nullptr) break;
    bell_.wait(seen);  // the loader rings, and so do a stop and an ask
  }
  if (scan == nullptr) {
    source_->abandon();
    return nullptr;
  }
  if (!scan->failure.empty()) {
    note("command " + std::to_string(order.number) + ": " + scan->failure);
    return nullptr;
  }
  said_ = {Kind::kScanned, order.ticket, {}};
  say_for_certain();
  return scan;
}

// --- what is kept, after the bus was told

void SearchEngine::keep(const job::Order& order, const job::ScanResult& result,
                        const HeldScan* scan, bool was_searched) noexcept {
  if (!recorder_) return;
  port::Record* const record = recorder_->free_record();
  if (record == nullptr) return recorder_->drop();
  try {
    record->result = result;
    record->times = was_searched ? times_ : port::RecordTimes{};
    record->times.said_us = clock_.now_us();
    record->trace.clear();
    if (was_searched) record->trace.take(search_.trace());
    fill(*record, order, scan);
    record->times.copied_us = clock_.now_us();
    recorder_->commit(Recorder::Task::kRecord);
  } catch (const std::exception&) {  // no memory: a record is not worth more
    recorder_->drop();
  }
}

void SearchEngine::fill(port::Record& record, const job::Order& order, const HeldScan* scan) {
  record.order = order;
  record.since_1970_us = port::real_now_us();
  record.arena_bytes = arena_.span().size();
  tool::LoadedScan& loaded = record.loaded;
  loaded.scan.width_px = loaded.scan.height_px = 0;
  loaded.path.clear();
  if (scan == nullptr) return;
  loaded.path = scan->name;
  loaded.load_us = scan->load_us;
  loaded.scan.up = scan->up;
  loaded.scan.up_reason = scan->up_reason;
  const bool was_searched = record.trace.part_count > 0;  // else the trace's frames are older
  loaded.frame = was_searched ? record.trace.face : job::FrameName::kScan;
  loaded.frames = was_searched ? record.trace.frames : frames_of_scan(scan->up == port::Up::kPlusZ);
  copy_scan(scan->view, loaded.scan);
}

// Who asked for this waits for the disk, and may cancel; the bus goes on, and the search is asked
// for signs of life.
Answer SearchEngine::save_scan(const job::Order& order, const Cancel& replaced) noexcept {
  const HeldScan* const scan = source_ ? source_->last() : nullptr;
  if (!recorder_ || scan == nullptr) return Answer::kNotSaved;
  bool is_committed = false;
  while (!replaced.is_asked_for()) {
    const std::uint32_t seen = bell_.seen();
    answer_asker();
    if (is_committed) {
      if (const auto saved = recorder_->saved()) return *saved ? Answer::kOk : Answer::kNotSaved;
    } else if (port::Record* const record = recorder_->free_record()) {
      try {
        record->result = result_of(scan, Answer::kOk);
        record->times = {};
        record->trace.clear();
        fill(*record, order, scan);
      } catch (const std::exception&) {
        return Answer::kNotSaved;
      }
      recorder_->commit(Recorder::Task::kSave);
      is_committed = true;
    }
    bell_.wait(seen);
  }
  return Answer::kCancelled;
}

void SearchEngine::report_pick(const job::Order& order) noexcept {
  const port::Pick pick{order.pick_number, order.pick_outcome, port::real_now_us()};
  if (recorder_ && recorder_->report(pick)) return;
  note("pick of command " + std::to_string(order.pick_number) + ": outcome " +
       std::to_string(order.pick_outcome));
}

void SearchEngine::finish(const job::Order& order, Answer answer) noexcept {
  finish(order, result_of(nullptr, answer));
}

void SearchEngine::finish(const job::Order& order, const job::ScanResult& result) noexcept {
  said_ = {Kind::kFinished, order.ticket, result};
  say_for_certain();
}

// What a master waits for is not lost.
void SearchEngine::say_for_certain() noexcept {
  constexpr std::chrono::milliseconds kPause(1);
  while (!events_.put(said_) && !is_over_.load()) std::this_thread::sleep_for(kPause);
  wake_bus();
}

void SearchEngine::note(const std::string& text) noexcept {
  try {
    log_.line(text);
  } catch (...) {  // a log that fails costs no answer
  }
}

}  // namespace flatpose::daemon
