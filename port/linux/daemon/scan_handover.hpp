#pragma once
// Scans from a source's thread to the searching one, each for the ticket that it was wanted for.
// One buffer holds the scan that was taken last, the other is filled.
//
//   source:  blank() ... fill ... publish(ticket)        only for a ticket that was asked for
//   taker:   take(ticket) | last()                       after it has asked for the ticket
//
// The source fills the buffer that the taker does not hold. It begins only when it has seen the
// newest request, and whoever has made that looks for nothing older any more: so a scan that is
// late lands where nobody reads.

#include <array>
#include <atomic>

#include "port/linux/daemon/scan_source.hpp"

namespace flatpose::daemon {

class ScanHandover {
 public:
  ScanHandover(const ScanBuffers& buffers, Doorbell& taker) noexcept
      : buffers_(buffers), taker_(taker) {}

  /// What is to be filled, and with what it may be compared: the points taken last.
  struct Blank {
    HeldScan& scan;
    std::span<float> xyz_mm;
    std::span<const float> last_xyz_mm;
    std::size_t& value_count;  ///< Of floats; 0: there is no scan.
  };

  /// The source's thread.
  [[nodiscard]] Blank blank() noexcept {
    ready_ticket_.store(kNone);
    const int index = 1 - held_.load();
    const int other = 1 - index;
    Slot& slot = slots_[index];
    slot.scan = {};
    slot.value_count = 0;
    return {slot.scan, buffers_[index], buffers_[other].first(slots_[other].value_count),
            slot.value_count};
  }
  /// The source's thread: what was filled, or failed, is there.
  void publish(std::uint32_t ticket) noexcept {
    ready_ticket_.store(ticket);
    taker_.ring();
  }

  /// The taker's thread: null as long as there is nothing for this ticket.
  [[nodiscard]] const HeldScan* take(std::uint32_t ticket) noexcept {
    if (ready_ticket_.load() != ticket) return nullptr;
    const int next = 1 - held_.load();
    HeldScan& scan = slots_[next].scan;
    scan.number = ++taken_count_;
    is_last_sound_ = scan.failure.empty();
    if (is_last_sound_) held_.store(next);
    ready_ticket_.store(kNone);
    return &scan;
  }
  /// The taker's thread: the scan taken last; null: none yet, or the last failed.
  [[nodiscard]] const HeldScan* last() const noexcept {
    return is_last_sound_ ? &slots_[held_.load()].scan : nullptr;
  }

 private:
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};
  struct Slot {
    HeldScan scan;
    std::size_t value_count = 0;
  };

  const ScanBuffers buffers_;
  Doorbell& taker_;
  std::array<Slot, kScanBufferCount> slots_;
  std::atomic<int> held_{1};
  std::atomic<std::uint64_t> ready_ticket_{kNone};
  bool is_last_sound_ = false;
  std::uint32_t taken_count_ = 0;
};

}  // namespace flatpose::daemon
