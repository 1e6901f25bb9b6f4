#pragma once
// Scans from files, loaded ahead into two buffers: while one is searched, and kept for a search in
// the last scan, the other already holds the next. A replayed scan counts as acquired when a
// trigger takes it, and as simulated, whatever is in the file: it is not what lies before the
// sensor.

#include <array>
#include <atomic>
#include <thread>

#include "port/linux/files/replay_folder.hpp"
#include "port/linux/daemon/scan_file.hpp"
#include "port/linux/daemon/scan_source.hpp"

namespace flatpose::daemon {

class ReplaySource final : public ScanSource {
 public:
  ReplaySource(const Config& config, const ScanBuffers& buffers, Doorbell& taker, int wake);
  ~ReplaySource() override;

  void start() override;
  void ask() noexcept override;
  void request(const ScanOrder& order) noexcept override;
  [[nodiscard]] const HeldScan* take(std::int64_t now_us) noexcept override;
  void abandon() noexcept override {}
  [[nodiscard]] const HeldScan* last() const noexcept override;

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

  const std::string path_;
  const ScanFileReader reader_;
  port::ReplayFolder replay_;
  ScanBuffers buffers_;
  Doorbell& taker_;
  std::array<Slot, kScanBufferCount> slots_;
  Doorbell bell_;
  std::atomic<bool> is_asked_{false};
  std::atomic<bool> is_over_{false};
  std::uint64_t turn_ = 0;        ///< The loader's.
  std::int64_t accepted_us_ = 0;  ///< The taker's, and the next three.
  int held_ = -1;
  std::uint32_t taken_count_ = 0;
  int rereads_ = 0;
  std::thread thread_;
};

}  // namespace flatpose::daemon
