#pragma once
// The executor of lib on threads of this process, started once and kept. Chunks are handed out by
// an atomic ticket, so that an idle thread takes the next one; a thread that has nothing to do
// looks for work for a while before it sleeps, because the next stage of a search is a fraction of
// a millisecond away.

#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

#include "flatpose/core/executor.hpp"
#include "port/linux/realtime/config.hpp"
#include "port/linux/realtime/step.hpp"

namespace flatpose::port {

class WorkerPool final : public Executor {
 public:
  /// The caller of parallel_for() is one of the `thread_count` (>= 1), number 0, and sets itself up
  /// (set_up_this_thread); the others are set up by `realtime` when this returns.
  /// Fails: std::system_error when the system gives no more threads.
  explicit WorkerPool(int thread_count, const RealtimeConfig& realtime = {});
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  /// Thread: one caller at a time; a task must not call it.  Memory: none.
  void parallel_for(int chunk_count, Task task, void* context) noexcept override;

  /// What became of the set-up, thread by thread.
  [[nodiscard]] const Steps& steps() const noexcept { return steps_; }

 private:
  void work() noexcept;
  void stop() noexcept;
  /// Takes chunks of the job that stands until none is left.
  void take_chunks() noexcept;

  // The job's number in the upper half, its next chunk in the lower. While a job is written down
  // the lower half is kClosed, so that who has read half of it can take nothing.
  static constexpr std::uint64_t kClosed = 0xFFFFFFFFU;
  std::atomic<std::uint64_t> ticket_{kClosed};
  std::atomic<Task> task_{nullptr};
  std::atomic<void*> context_{nullptr};
  std::atomic<std::uint32_t> chunk_count_{0};
  std::atomic<std::uint32_t> done_count_{0};
  std::atomic<std::uint32_t> call_{0};  ///< Counts jobs; who sleeps waits for it to change.
  std::atomic<bool> is_over_{false};
  std::atomic<int> ready_count_{0};
  Steps steps_;
  std::vector<std::thread> threads_;
};

}  // namespace flatpose::port
