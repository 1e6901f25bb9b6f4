#pragma once
// Scratch for chunks of work that may run side by side: each takes the lowest slot that is free, so
// that one after the other they share one, which stays near the processor.

#include <array>
#include <atomic>

#include "flatpose/core/executor.hpp"

namespace flatpose::rectify {

/// Chunks that a stage is cut into, at most; fixed, so that nothing depends on who runs them.
inline constexpr int kChunkCountMax = 8;

class Slots {
 public:
  /// The lowest of kChunkCountMax slots that nobody has; there is one for every chunk.
  int take() noexcept {
    for (int slot = 0; slot < kChunkCountMax; ++slot) {
      if (!taken_[static_cast<std::size_t>(slot)].exchange(true, std::memory_order_acquire))
        return slot;
    }
    return 0;  // never: more chunks than slots
  }
  void give_back(int slot) noexcept {
    taken_[static_cast<std::size_t>(slot)].store(false, std::memory_order_release);
  }

 private:
  std::array<std::atomic<bool>, kChunkCountMax> taken_{};
};

/// Rows of an image cut into chunks of whole blocks.
struct RowChunks {
  int height_px;
  int rows_per_chunk;

  RowChunks(int height_px_, int block_px) noexcept : height_px(height_px_) {
    const int blocks = (height_px + block_px - 1) / block_px;
    rows_per_chunk = (blocks + kChunkCountMax - 1) / kChunkCountMax * block_px;
  }
  [[nodiscard]] int count() const noexcept {
    return rows_per_chunk > 0 ? (height_px + rows_per_chunk - 1) / rows_per_chunk : 0;
  }
  [[nodiscard]] int begin(int chunk) const noexcept { return chunk * rows_per_chunk; }
  [[nodiscard]] int end(int chunk) const noexcept {
    const int next = (chunk + 1) * rows_per_chunk;
    return next < height_px ? next : height_px;
  }
};

}  // namespace flatpose::rectify
