#pragma once
// The caller's memory, handed out from the bottom up. One function lays a room's data out, first in
// a measuring arena (which has no memory and only counts), then in the caller's: so
// required_bytes() cannot disagree with init().

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>

#include "flatpose/core/image_view.hpp"

namespace flatpose {

class Arena {
 public:
  static constexpr std::size_t kAlignmentBytes = 64;  // a cache line, and the widest vector

  /// An arena that counts what would be taken and hands out nothing.
  static Arena measuring() noexcept {
    Arena arena;
    arena.capacity_bytes_ = std::numeric_limits<std::size_t>::max() / 2;
    return arena;
  }

  Arena() = default;
  explicit Arena(std::span<std::byte> memory) noexcept {
    const auto address = reinterpret_cast<std::uintptr_t>(memory.data());
    const std::size_t skip_bytes = (kAlignmentBytes - address % kAlignmentBytes) % kAlignmentBytes;
    if (memory.size() > skip_bytes) {
      base_ = memory.data() + skip_bytes;
      capacity_bytes_ = memory.size() - skip_bytes;
    }
  }

  /// Takes room for `count` values, uninitialised. An empty span with failed() set when the arena
  /// is full.
  template <class T>
  std::span<T> take(std::size_t count) noexcept {
    static_assert(std::is_trivially_destructible_v<T> && std::is_trivially_copyable_v<T>);
    static_assert(alignof(T) <= kAlignmentBytes);
    if (failed_ || count > (capacity_bytes_ - used_bytes_) / sizeof(T)) return fail<T>();
    const std::size_t size_bytes = round_up(count * sizeof(T));
    if (size_bytes > capacity_bytes_ - used_bytes_) return fail<T>();
    std::byte* start = base_ == nullptr ? nullptr : base_ + used_bytes_;
    used_bytes_ += size_bytes;
    if (used_bytes_ > peak_bytes_) peak_bytes_ = used_bytes_;
    if (start == nullptr) return {};
    return {reinterpret_cast<T*>(start), count};
  }

  /// Takes a dense image; a view of no pixels when the arena is full or measuring.
  template <class T>
  ImageView<T> take_image(int width_px, int height_px) noexcept {
    const std::span<T> pixels =
        take<T>(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px));
    return pixels.empty() ? ImageView<T>{}
                          : ImageView<T>{pixels.data(), width_px, height_px, width_px};
  }

  [[nodiscard]] bool failed() const noexcept { return failed_; }
  [[nodiscard]] std::size_t used_bytes() const noexcept { return used_bytes_; }
  [[nodiscard]] std::size_t peak_bytes() const noexcept { return peak_bytes_; }
  /// Bytes to ask for so that everything measured fits, whatever the address of the memory.
  [[nodiscard]] std::size_t required_bytes() const noexcept {
    return peak_bytes_ + kAlignmentBytes;
  }

  /// Gives back all that was taken since `mark = used_bytes()`.
  void rewind(std::size_t mark_bytes) noexcept { used_bytes_ = mark_bytes; }

 private:
  static std::size_t round_up(std::size_t size_bytes) noexcept {
    return (size_bytes + kAlignmentBytes - 1) / kAlignmentBytes * kAlignmentBytes;
  }
  template <class T>
  std::span<T> fail() noexcept {
    failed_ = true;
    return {};
  }

  std::byte* base_ = nullptr;
  std::size_t capacity_bytes_ = 0;
  std::size_t used_bytes_ = 0;
  std::size_t peak_bytes_ = 0;
  bool failed_ = false;
};

/// Gives the arena back what was taken in a scope.
class ArenaScope {
 public:
  explicit ArenaScope(Arena& arena) noexcept : arena_(arena), mark_bytes_(arena.used_bytes()) {}
  ~ArenaScope() { arena_.rewind(mark_bytes_); }
  ArenaScope(const ArenaScope&) = delete;
  ArenaScope& operator=(const ArenaScope&) = delete;

 private:
  Arena& arena_;
  std::size_t mark_bytes_;
};

}  // namespace flatpose
