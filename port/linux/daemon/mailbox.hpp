#pragma once
// Values from one thread to one other, without locks: the newest alone, or all in their order.

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace flatpose::daemon {

/// A newer value replaces an older one, taken or not. One writer, one reader; neither ever waits:
/// of three slots each has one, and the third is exchanged.
template <class T>
class Latest {
 public:
  void put(const T& value) noexcept {
    slots_[writers_] = value;
    writers_ = spare_.exchange(writers_ | kNew, std::memory_order_acq_rel) & kIndex;
  }

  /// Returns whether there was a new one.
  [[nodiscard]] bool take(T& value) noexcept {
    if ((spare_.load(std::memory_order_acquire) & kNew) == 0) return false;
    readers_ = spare_.exchange(readers_, std::memory_order_acq_rel) & kIndex;
    value = slots_[readers_];
    return true;
  }

 private:
  static constexpr std::uint32_t kNew = 4;
  static constexpr std::uint32_t kIndex = 3;

  std::array<T, 3> slots_{};
  std::uint32_t writers_ = 0;
  std::uint32_t readers_ = 1;
  std::atomic<std::uint32_t> spare_{2};
};

/// A short queue. One writer, one reader; put() says no when it is full.
template <class T, std::size_t kCount>
class Queue {
 public:
  [[nodiscard]] bool put(const T& value) noexcept {
    const std::size_t end = end_.load(std::memory_order_relaxed);
    if (end - begin_.load(std::memory_order_acquire) == kCount) return false;
    slots_[end % kCount] = value;
    end_.store(end + 1, std::memory_order_release);
    return true;
  }
  [[nodiscard]] bool take(T& value) noexcept {
    const std::size_t begin = begin_.load(std::memory_order_relaxed);
    if (begin == end_.load(std::memory_order_acquire)) return false;
    value = slots_[begin % kCount];
    begin_.store(begin + 1, std::memory_order_release);
    return true;
  }

 private:
  std::array<T, kCount> slots_{};
  std::atomic<std::size_t> begin_{0};
  std::atomic<std::size_t> end_{0};
};

/// What one thread sleeps at and any other rings. A ring between seen() and wait() is not lost.
class Doorbell {
 public:
  void ring() noexcept {
    count_.fetch_add(1);
    count_.notify_all();
  }
  [[nodiscard]] std::uint32_t seen() const noexcept { return count_.load(); }
  void wait(std::uint32_t seen) const noexcept { count_.wait(seen); }

 private:
  std::atomic<std::uint32_t> count_{0};
};

}  // namespace flatpose::daemon
