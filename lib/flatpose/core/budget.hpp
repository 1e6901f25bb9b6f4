#pragma once
// What one run may use: hands, and time. Stages look at it between pieces of work of a stated size,
// leave when it is over, and report kStopped; what they have written until then means nothing.

#include <atomic>
#include <cstdint>

#include "flatpose/core/host.hpp"
#include "flatpose/core/status.hpp"

namespace flatpose {

/// Rows of a scan or a map that are gone through once between two looks.
inline constexpr int kRowsPerLook = 16;
/// Blocks of places that are searched at all angles between two looks.
inline constexpr int kBlocksPerLook = 16;
/// Points of lists (edges, contours) between two looks.
inline constexpr int kPointsPerLook = 4096;

class Budget {
 public:
  /// One that does not end.
  Budget(Executor& executor = callers_thread) noexcept : executor_(executor) {}  // NOLINT
  /// Until the host's clock shows `end_us` (kNoEnd: never), or the host cancels.
  Budget(const Host& host, std::int64_t end_us) noexcept
      : executor_(host.executor),
        clock_(end_us != kNoEnd ? &host.clock : nullptr),
        cancel_(host.cancel),
        end_us_(end_us) {}
  static constexpr std::int64_t kNoEnd = INT64_MAX;

  [[nodiscard]] Executor& executor() const noexcept { return executor_; }

  /// Looks whether time is up or the run is cancelled; once it is over it stays so.
  /// Cost: a reading of the clock.  Thread: any.
  [[nodiscard]] bool is_over() const noexcept {
    if (was_over()) return true;
    if (cancel_ != nullptr && cancel_->is_asked_for()) {
      end_.store(End::kCancelled, std::memory_order_relaxed);
    } else if (clock_ != nullptr && clock_->now_us() >= end_us_) {
      end_.store(End::kDeadline, std::memory_order_relaxed);
    }
    return was_over();
  }
  /// As is_over(), once every kRowsPerLook rows; between them what was seen before.
  [[nodiscard]] bool is_over_at(int row) const noexcept {
    return row % kRowsPerLook == 0 ? is_over() : was_over();
  }
  /// Whether a look has found it over.
  [[nodiscard]] bool was_over() const noexcept {
    return end_.load(std::memory_order_relaxed) != End::kNone;
  }
  [[nodiscard]] bool was_cancelled() const noexcept {
    return end_.load(std::memory_order_relaxed) == End::kCancelled;
  }

 private:
  enum class End : int { kNone, kDeadline, kCancelled };
  static_assert(std::atomic<End>::is_always_lock_free);

  Executor& executor_;
  const Clock* clock_ = nullptr;
  const Cancel* cancel_ = nullptr;
  std::int64_t end_us_ = kNoEnd;
  mutable std::atomic<End> end_{End::kNone};
};

/// Calls `body(chunk_index)` for every chunk that begins before the budget is over. Returns whether
/// that were all, and all of each.
template <class Body>
[[nodiscard]] bool for_each_chunk(const Budget& budget, int chunk_count, Body& body) noexcept {
  auto unless_over = [&](int chunk_index) {
    if (!budget.is_over()) body(chunk_index);
  };
  for_each_chunk(budget.executor(), chunk_count, unless_over);
  return !budget.was_over();
}

}  // namespace flatpose
