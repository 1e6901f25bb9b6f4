#pragma once
// Memory that never makes a search wait: every page is there before it begins, and stays.

#include <cstddef>
#include <span>

#include "port/linux/realtime/step.hpp"

namespace flatpose::port {

/// Stack of the threads that are started after lock_all_memory(), which would otherwise lock the
/// usual 8 MB for each.
inline constexpr std::size_t kStackOfThread_bytes = 2 * 1024 * 1024;

/// Pages of its own, all of them touched.
class PrefaultedMemory {
 public:
  /// Cost: some 0.2 s a gigabyte.  Fails: std::bad_alloc when the system refuses; one that grants
  /// more than it has ends the process, so ask read_machine() first.
  explicit PrefaultedMemory(std::size_t size_bytes);
  ~PrefaultedMemory();
  PrefaultedMemory(const PrefaultedMemory&) = delete;
  PrefaultedMemory& operator=(const PrefaultedMemory&) = delete;

  [[nodiscard]] std::span<std::byte> span() noexcept { return {bytes_, size_bytes_}; }

 private:
  std::byte* bytes_ = nullptr;
  std::size_t size_bytes_ = 0;
};

/// Locks what the process has and will have, and lets the heap give nothing back, so that what was
/// freed is there when it is needed again. Call it before threads are started.
[[nodiscard]] Step lock_all_memory();

}  // namespace flatpose::port
