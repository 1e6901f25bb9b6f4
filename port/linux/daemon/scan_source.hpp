#pragma once
// Scans from files, loaded on a thread of their own into two buffers: while one is searched, and
// kept for a search in the last scan, the other already holds the next. A replayed scan counts as
// acquired when a trigger takes it, and as simulated: it is not what lies before the sensor.

#include <array>
#include <atomic>
#include <cstdint>
#include <ctime>
#include <span>
#include <string>
#include <thread>

#include "flatpose/geometry/range_image.hpp"
#include "flatpose/job/order.hpp"
#include "port/linux/daemon/config.hpp"
#include "port/linux/daemon/mailbox.hpp"
#include "port/linux/daemon/replay_folder.hpp"
#include "port/linux/daemon/scan_buffer.hpp"

namespace flatpose::daemon {

/// A scan in one of the buffers, or why there is none.
struct HeldScan {
  RangeImageView view;
  port::Up up = port::Up::kMinusZ;
  std::string path;
  std::string failure;       ///< A line for the log; empty: the scan is there.
  bool is_repeated = false;  ///< Byte for byte as the one before.
  std::uint32_t number = 0;
  std::int64_t acquired_us = 0;  ///< When it was taken; 0: not yet.
  std::uint32_t sensor_us = 0;   ///< What the taker had to wait for.
};

/// Which file it was when it was read: another one under the name is read anew.
struct FileState {
  std::uint64_t device = 0;
  std::uint64_t inode = 0;
  std::int64_t bytes = 0;
  timespec changed{};

  [[nodiscard]] static FileState of(const std::string& path) noexcept;
  [[nodiscard]] bool operator==(const FileState& other) const noexcept;
};

class ScanSource {
 public:
  using Buffers = std::array<std::span<float>, kScanBufferCount>;
  using SourceEvents = Queue<job::SearchEvent, 4>;

  /// `taker` is rung when a scan is there, `wake` (an eventfd) written when the source has spoken.
  /// Refers to bell and buffers, which must outlive it.
  ScanSource(const Config& config, const Buffers& buffers, Doorbell& taker, int wake);
  ~ScanSource();
  ScanSource(const ScanSource&) = delete;
  ScanSource& operator=(const ScanSource&) = delete;

  void start();
  /// Any thread: asks for a sign of life.
  void ask() noexcept {
    is_asked_.store(true);
    bell_.ring();
  }
  /// The bus's thread: what the source says of itself.
  [[nodiscard]] SourceEvents& events() noexcept { return events_; }

  /// The searching thread: the next scan, or null as long as there is none; the last one is let go
  /// then. To be called again when the taker's bell has rung.
  [[nodiscard]] const HeldScan* take(std::int64_t now_us) noexcept;
  /// The searching thread: how long the scan just taken was waited for.
  void waited(std::int64_t time_us) noexcept;
  /// The scan taken last; null: none yet, or it could not be read.
  [[nodiscard]] const HeldScan* last() const noexcept;

 private:
  struct Slot {
    std::atomic<bool> is_loaded{false};
    std::uint64_t turn = 0;  ///< They are taken in the order in which they were loaded.
    HeldScan scan;
    FileState state;
    std::size_t value_count = 0;
  };

  void work() noexcept;
  void say_alive() noexcept;
  void load(int index) noexcept;
  void read_into(int index);
  [[nodiscard]] int next_loaded() const noexcept;
  [[nodiscard]] bool is_stale(const Slot& slot) const noexcept;

  const SourceConfig config_;
  const port::ReadLimits limits_;
  const locate::Limits sides_;
  ReplayFolder replay_;
  Buffers buffers_;
  Doorbell& taker_;
  const int wake_;
  std::array<Slot, kScanBufferCount> slots_;
  Doorbell bell_;
  SourceEvents events_;
  std::atomic<bool> is_asked_{false};
  std::atomic<bool> is_over_{false};
  std::uint64_t turn_ = 0;  ///< The loader's.
  int held_ = -1;           ///< The taker's, and the next two.
  std::uint32_t taken_count_ = 0;
  int rereads_ = 0;
  std::thread thread_;
};

}  // namespace flatpose::daemon
