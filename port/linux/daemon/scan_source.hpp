#pragma once
// Where scans come from. A source has a thread of its own; the searching thread asks it for one
// scan a command and sleeps at its own bell until there is one, or is not.
//
//   search thread:  request(order) ...  take() until it gives a scan  | abandon()
//   bus thread:     ask(), hear(event)
//
// Only a scan whose acquisition began after the command was accepted is given.

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "flatpose/geometry/range_image.hpp"
#include "flatpose/job/order.hpp"
#include "port/linux/daemon/config.hpp"
#include "port/linux/daemon/log.hpp"
#include "port/linux/daemon/mailbox.hpp"
#include "port/linux/daemon/scan_buffer.hpp"

namespace flatpose::daemon {

/// A scan in one of the buffers, or why there is none.
struct HeldScan {
  RangeImageView view;
  port::Up up = port::Up::kMinusZ;
  std::string up_reason;
  std::int64_t load_us = 0;  ///< What it took to bring it into memory.
  std::string name;          ///< Of its file, or of the driver it comes from.
  std::string failure;       ///< A line for the log; empty: the scan is there.
  bool is_simulated = true;  ///< Not known to be what lies before the sensor.
  bool is_repeated = false;  ///< Byte for byte as the one before.
  std::uint32_t number = 0;
  std::int64_t acquired_us = 0;  ///< End of acquisition, or a moment before it; 0: not yet.
  std::uint32_t sensor_us = 0;   ///< What the sensor took, or what was waited for it.
};

/// What a scan is wanted for. Times on CLOCK_MONOTONIC.
struct ScanOrder {
  std::uint32_t ticket = 0;
  std::uint16_t number = 0;  ///< The master's.
  std::uint16_t job = 0;
  std::int64_t accepted_us = 0;
  std::int64_t answer_by_us = 0;
};

/// What a source says of itself.
struct SourceLife {
  bool is_alive = false;
  bool is_simulated = false;
};

using ScanBuffers = std::array<std::span<float>, kScanBufferCount>;

class ScanSource {
 public:
  /// `wake`: an eventfd that is written when the source has spoken.
  explicit ScanSource(int wake) noexcept : wake_(wake) {}
  virtual ~ScanSource() = default;
  ScanSource(const ScanSource&) = delete;
  ScanSource& operator=(const ScanSource&) = delete;

  /// Once.  Fails: std::system_error.
  virtual void start() = 0;
  /// Asks for a sign of life.  Thread: any.
  virtual void ask() noexcept = 0;

  /// The searching thread: a command wants a scan; what was wanted before is wanted no more.
  virtual void request(const ScanOrder& order) noexcept = 0;
  /// The searching thread: the scan wanted, or why it failed; null as long as there is neither. To
  /// be called again when the taker's bell has rung. The scan taken before is let go by it.
  [[nodiscard]] virtual const HeldScan* take(std::int64_t now_us) noexcept = 0;
  /// The searching thread: nobody wants it any more.
  virtual void abandon() noexcept = 0;
  /// The scan taken last; null: none yet, or it failed.
  [[nodiscard]] virtual const HeldScan* last() const noexcept = 0;

  /// The bus's thread: what the source has to say, the newest alone.
  [[nodiscard]] bool hear(job::SearchEvent& event) noexcept;

 protected:
  /// The source's thread.
  void tell(const SourceLife& life) noexcept;

 private:
  const int wake_;
  Latest<SourceLife> life_;
};

/// The one that the config names; null: none. `taker` is rung when a scan is there. Refers to
/// buffers, taker and log, which must outlive it.  Fails: port::InputError, std::system_error.
[[nodiscard]] std::unique_ptr<ScanSource> make_scan_source(const Config& config,
                                                           const ScanBuffers& buffers,
                                                           Doorbell& taker, int wake, Log& log);

}  // namespace flatpose::daemon
