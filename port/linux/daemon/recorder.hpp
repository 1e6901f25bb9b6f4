#pragma once
// Writes records on a thread of its own, off the fast path. The search thread copies what is to be
// kept into the one record there is, when it is free, after the bus was told; when it is not, the
// record is dropped and counted. Nobody waits for a disk but who asked for a scan to be saved.
//
//   search thread:  free_record() -> fill -> commit()          recorder: writes, frees it, draws
//                   report(pick) --Queue-->                    recorder: adds it to its record

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <thread>

#include "port/linux/daemon/config.hpp"
#include "port/linux/daemon/log.hpp"
#include "port/linux/daemon/mailbox.hpp"
#include "port/linux/records/record.hpp"
#include "port/linux/records/record_folder.hpp"
#include "port/linux/records/record_text.hpp"

namespace flatpose::daemon {

class Recorder {
 public:
  enum class Task : std::uint8_t { kRecord, kSave };

  /// Takes the memory of two scans and opens the folder. `taker` is rung when a record is free
  /// again and when a scan is saved or not; it and the log must outlive this.  Fails:
  /// std::bad_alloc.
  Recorder(const Config& config, Doorbell& taker, Log& log);
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  void start();

  /// The search thread, and so the next four: the record to fill; null: it is being written.
  [[nodiscard]] port::Record* free_record() noexcept {
    return is_taken_.load(std::memory_order_acquire) ? nullptr : &record_;
  }
  void commit(Task task) noexcept;
  /// A record that found none free.
  void drop() noexcept { dropped_.fetch_add(1, std::memory_order_relaxed); }
  /// How the save that was committed went; nothing as long as it is on its way.
  [[nodiscard]] std::optional<bool> saved() const noexcept;
  /// False: too many wait.
  [[nodiscard]] bool report(const port::Pick& pick) noexcept;

  /// The bus's thread: a result is on its board.
  void note_posted(std::uint32_t ticket, std::int64_t now_us) noexcept {
    posted_us_.store(now_us, std::memory_order_relaxed);
    posted_ticket_.store(ticket, std::memory_order_release);
  }

 private:
  enum class Saved : std::uint8_t { kPending, kYes, kNo };

  void work() noexcept;
  void do_task() noexcept;
  void give_back() noexcept;
  /// Returns its JSON.
  [[nodiscard]] std::string write_record();
  void put_last(const std::string& json);
  [[nodiscard]] bool write_save() noexcept;
  void write_pick(const port::Pick& pick);
  void count_pick(const port::Pick& pick);
  void tell_drops() noexcept;
  /// Runs what writes; a failure is told once, and so is its end.  Returns whether it worked.
  template <class Write>
  bool try_to(const Write& write) noexcept;
  void note(const std::string& text) noexcept;

  const RecordsConfig config_;
  const port::RealtimeConfig realtime_;
  Doorbell& taker_;
  Log& log_;
  port::RecordFolder folder_;
  port::Record record_;
  port::Record written_;  ///< The recorder's: the one before, to be drawn.
  Doorbell bell_;
  Queue<port::Pick, 16> picks_;
  std::atomic<bool> is_taken_{false};
  std::atomic<bool> is_over_{false};
  std::atomic<Saved> saved_{Saved::kPending};
  std::atomic<std::uint64_t> dropped_{0};
  std::atomic<std::uint32_t> posted_ticket_{0};
  std::atomic<std::int64_t> posted_us_{0};
  Task task_ = Task::kRecord;
  std::uint64_t first_sequence_ = 0;  ///< The recorder's, and all below: of this process.
  std::uint64_t last_sequence_ = 0;
  std::uint64_t lost_count_ = 0;  ///< Since the disk last took one.
  std::uint64_t told_drops_ = 0;
  bool is_failing_ = false;
  std::thread thread_;
};

/// Copies the pixels; no memory is taken when `to` was prepared for as many.
/// Cost: a copy of 12 bytes a pixel.
void copy_scan(const RangeImageView& from, port::Scan& to);

}  // namespace flatpose::daemon
