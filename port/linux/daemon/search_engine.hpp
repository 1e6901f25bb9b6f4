#pragma once
// The search's own thread, its workers and all memory of a search, taken and set up at the start.
// Whoever serves a bus never waits for it.

#include <array>
#include <atomic>
#include <cstdint>
#include <exception>
#include <thread>

#include "flatpose/locate/locator.hpp"
#include "port/linux/daemon/config.hpp"
#include "port/linux/daemon/scan_buffer.hpp"
#include "port/linux/realtime/memory.hpp"
#include "port/linux/realtime/step.hpp"

namespace flatpose::daemon {

class SearchEngine {
 public:
  /// Takes the memory.  Fails: std::bad_alloc, std::runtime_error when the library refuses the
  /// limits.
  explicit SearchEngine(const Config& config);
  ~SearchEngine();
  SearchEngine(const SearchEngine&) = delete;
  SearchEngine& operator=(const SearchEngine&) = delete;

  /// Once, and when the process is set up: memory that is locked first can be refused afterwards.
  /// Returns when the threads are set up and wait.  Fails: std::system_error.
  void start();

  /// Of all threads.
  [[nodiscard]] const port::Steps& steps() const noexcept { return steps_; }

  /// Asks the search thread for a sign of life, which it gives between two searches.
  void ask() noexcept;
  /// Whether it has answered all that it was asked.
  [[nodiscard]] bool has_answered() const noexcept { return answered_.load() == asked_.load(); }

 private:
  void work() noexcept;
  void stop() noexcept;

  const Config config_;
  port::PrefaultedMemory arena_;
  std::array<port::PrefaultedMemory, kScanBufferCount> scans_;
  locate::Locator locator_;
  port::Steps steps_;
  std::exception_ptr failure_;         ///< Of the thread's start.
  std::atomic<bool> is_ready_{false};  ///< Steps and failure stand.
  std::atomic<bool> is_over_{false};
  std::atomic<std::uint32_t> call_{0};  ///< Who sleeps waits for it to change.
  std::atomic<std::uint32_t> asked_{0};
  std::atomic<std::uint32_t> answered_{0};
  std::thread thread_;
};

}  // namespace flatpose::daemon
