#pragma once
// The search's own thread, its workers and all memory of a search, taken and set up at the start.
// Whoever serves a bus never waits for it: orders go in and events come out through mailboxes.
//
//   bus:  give(order) --Latest-->  search thread  --Queue, eventfd-->  bus:  take(event)
//
// One order is in force. A newer one, also a stop, ends a search of the older within a fraction of
// a millisecond, because the search asks for the ticket in force again and again.

#include <array>
#include <atomic>
#include <cstdint>
#include <exception>
#include <memory>
#include <thread>

#include "flatpose/core/cancel.hpp"
#include "flatpose/job/order.hpp"
#include "flatpose/locate/locator.hpp"
#include "port/linux/clock/steady_clock.hpp"
#include "port/linux/daemon/config.hpp"
#include "port/linux/daemon/event_file.hpp"
#include "port/linux/daemon/job_search.hpp"
#include "port/linux/daemon/job_set.hpp"
#include "port/linux/daemon/job_shelf.hpp"
#include "port/linux/daemon/log.hpp"
#include "port/linux/daemon/mailbox.hpp"
#include "port/linux/daemon/recorder.hpp"
#include "port/linux/daemon/scan_buffer.hpp"
#include "port/linux/daemon/scan_source.hpp"
#include "port/linux/realtime/memory.hpp"
#include "port/linux/realtime/step.hpp"
#include "port/linux/threads/worker_pool.hpp"

namespace flatpose::daemon {

class SearchEngine {
 public:
  /// Takes the memory. Refers to the log, which must outlive it.  Fails: std::bad_alloc,
  /// std::system_error, std::runtime_error when the library refuses the limits.
  SearchEngine(const Config& config, std::shared_ptr<const JobSet> jobs, Log& log);
  ~SearchEngine();
  SearchEngine(const SearchEngine&) = delete;
  SearchEngine& operator=(const SearchEngine&) = delete;

  /// Once, and when the process is set up: memory that is locked first can be refused afterwards.
  /// Returns when the threads are set up and wait.  Fails: std::system_error.
  void start();

  /// Of all threads.
  [[nodiscard]] const port::Steps& steps() const noexcept { return steps_; }

  /// Asks search and scan source for a sign of life. The search gives it when it waits, and within
  /// a search whenever it looks whether it is still wanted: a search that gets nowhere gives none.
  /// Returns what to hold against has_answered().  Thread: any.
  std::uint32_t ask() noexcept;
  /// Whether the search has answered that one.
  [[nodiscard]] bool has_answered(std::uint32_t asked) const noexcept {
    return static_cast<std::int32_t>(answered_.load() - asked) >= 0;
  }

  /// The bus's thread: an order takes the place of all before it.  Cost: no wait.
  void give(const job::Order& order) noexcept;
  /// The bus's thread: what search and source have to say.  Cost: no wait.
  [[nodiscard]] bool take(job::SearchEvent& event) noexcept;
  /// The bus's thread: a result is on its board, for the records.
  void note_posted(std::uint32_t ticket, std::int64_t now_us) noexcept {
    if (recorder_) recorder_->note_posted(ticket, now_us);
  }
  /// The bus's thread: where the table of new jobs lies when there is one. Orders given after it
  /// was adopted are of the new set.
  [[nodiscard]] JobShelf& shelf() noexcept { return shelf_; }

  /// Who loads jobs: the ticket of the command that asks for it; 0: none does.
  [[nodiscard]] std::uint32_t asked_to_reload() const noexcept { return reload_asked_.load(); }
  /// Who loads jobs: how that command ended.
  void answer_reload(std::uint32_t ticket, bool is_done) noexcept {
    reload_answer_.store(std::uint64_t{ticket} << 1 | (is_done ? 1U : 0U));
    bell_.ring();
  }
  /// Any thread: the search looks whether there is something new.
  void ring() noexcept { bell_.ring(); }
  /// Any thread.
  void wake_bus() const noexcept { event_.ring(); }
  /// An eventfd that is readable when there is something to take.
  [[nodiscard]] int event() const noexcept { return event_.get(); }

 private:
  /// Asks whether the order that a search is of is in force no more.
  class Replaced final : public Cancel {
   public:
    Replaced(SearchEngine& engine, std::uint32_t ticket) noexcept
        : engine_(engine), ticket_(ticket) {}
    [[nodiscard]] bool is_asked_for() const noexcept override {
      engine_.answer_asker();
      return engine_.in_force_.load(std::memory_order_relaxed) != ticket_ ||
             engine_.is_over_.load(std::memory_order_relaxed);
    }

   private:
    SearchEngine& engine_;
    std::uint32_t ticket_;
  };

  void work() noexcept;
  void stop() noexcept;
  void execute(const job::Order& order) noexcept;
  void verify(const job::Order& order, const Cancel& replaced) noexcept;
  [[nodiscard]] job::Answer reload(const job::Order& order, const Cancel& replaced) noexcept;
  void locate(const job::Order& order, const HeldScan* scan, const Cancel& replaced) noexcept;
  [[nodiscard]] const HeldScan* next_scan(const job::Order& order, const Cancel& replaced) noexcept;
  void finish(const job::Order& order, const job::ScanResult& result) noexcept;
  void finish(const job::Order& order, job::Answer answer) noexcept;
  void keep(const job::Order& order, const job::ScanResult& result, const HeldScan* scan,
            bool was_searched) noexcept;
  void fill(port::Record& record, const job::Order& order, const HeldScan* scan);
  [[nodiscard]] job::Answer save_scan(const job::Order& order, const Cancel& replaced) noexcept;
  void report_pick(const job::Order& order) noexcept;
  void say_for_certain() noexcept;
  void answer_asker() noexcept;
  void note(const std::string& text) noexcept;

  const Config config_;
  Log& log_;
  port::SteadyClock clock_;
  port::PrefaultedMemory arena_;
  std::array<port::PrefaultedMemory, kScanBufferCount> buffers_;
  EventFile event_;
  locate::Locator locator_;
  JobShelf shelf_;
  JobSearch search_;
  Doorbell bell_;
  struct Given {
    job::Order order;
    std::uint32_t generation = 0;  ///< Of the jobs that it was accepted under.
  };
  Latest<Given> orders_;
  Queue<job::SearchEvent, 8> events_;
  job::SearchEvent said_;  ///< The search thread's: an event is some kilobytes.
  std::unique_ptr<ScanSource> source_;
  std::unique_ptr<Recorder> recorder_;
  port::RecordTimes times_;
  std::unique_ptr<port::WorkerPool> workers_;
  port::Steps steps_;
  std::exception_ptr failure_;         ///< Of the thread's start.
  std::atomic<bool> is_ready_{false};  ///< Steps and failure stand.
  std::atomic<bool> is_over_{false};
  std::atomic<std::uint32_t> in_force_{0};  ///< The ticket.
  std::atomic<std::uint32_t> asked_{0};
  std::atomic<std::uint32_t> answered_{0};
  std::atomic<std::uint32_t> reload_asked_{0};   ///< The ticket; 0: nobody asks.
  std::atomic<std::uint64_t> reload_answer_{0};  ///< Twice the ticket, one more when it was done.
  std::uint32_t heard_ = 0;                      ///< The bus's: which answer was the last.
  std::thread thread_;
};

}  // namespace flatpose::daemon
