#include "port/linux/threads/worker_pool.hpp"

#include <string>

#include "port/linux/realtime/thread_setup.hpp"

namespace flatpose::port {
namespace {

// Some tens of microseconds to a few hundred, by processor.
constexpr int kLooksBeforeSleep = 4000;
/// Who waits for others lets go of the processor now and then: with a fixed priority nobody else of
/// the same would run on it.
constexpr int kLooksBeforeYield = 4000;

void pause() noexcept {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#endif
}

}  // namespace

WorkerPool::WorkerPool(int thread_count, const RealtimeConfig& realtime) {
  std::vector<Steps> by_thread(static_cast<std::size_t>(thread_count < 1 ? 1 : thread_count));
  try {
    for (int i = 1; i < thread_count; ++i) {
      threads_.emplace_back([this, i, &realtime, &steps = by_thread[static_cast<std::size_t>(i)]] {
        steps = set_up_this_thread(realtime, i, "search " + std::to_string(i));
        ready_count_.fetch_add(1);
        ready_count_.notify_one();
        work();
      });
    }
  } catch (...) {
    stop();
    throw;
  }
  for (int ready = ready_count_.load(); ready + 1 < thread_count; ready = ready_count_.load())
    ready_count_.wait(ready);
  for (Steps& steps : by_thread) append(steps_, std::move(steps));
}

WorkerPool::~WorkerPool() { stop(); }

void WorkerPool::stop() noexcept {
  is_over_.store(true);
  call_.fetch_add(1);
  call_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void WorkerPool::parallel_for(int chunk_count, Task task, void* context) noexcept {
  if (threads_.empty() || chunk_count <= 1) {
    for (int i = 0; i < chunk_count; ++i) task(context, i);
    return;
  }
  const std::uint64_t number = (ticket_.load() >> 32) + 1;
  ticket_.store(number << 32 | kClosed);
  task_.store(task);
  context_.store(context);
  chunk_count_.store(static_cast<std::uint32_t>(chunk_count));
  done_count_.store(0);
  ticket_.store((number + 1) << 32);
  call_.fetch_add(1);
  call_.notify_all();
  take_chunks();
  for (int looks = 1; done_count_.load() < static_cast<std::uint32_t>(chunk_count); ++looks) {
    pause();
    if (looks % kLooksBeforeYield == 0) std::this_thread::yield();
  }
}

void WorkerPool::take_chunks() noexcept {
  std::uint64_t ticket = ticket_.load();
  for (;;) {
    const Task task = task_.load();
    void* const context = context_.load();
    const std::uint64_t chunk = ticket & 0xFFFFFFFFU;
    if (chunk >= chunk_count_.load()) return;  // kClosed is one of these
    // Succeeds only as long as the job is the one that was read.
    if (!ticket_.compare_exchange_weak(ticket, ticket + 1)) continue;
    task(context, static_cast<int>(chunk));
    done_count_.fetch_add(1);
    ticket = ticket_.load();
  }
}

void WorkerPool::work() noexcept {
  std::uint32_t seen = 0;
  while (!is_over_.load()) {
    for (int i = 0; i < kLooksBeforeSleep && call_.load() == seen; ++i) pause();
    call_.wait(seen);
    seen = call_.load();
    take_chunks();
  }
}

}  // namespace flatpose::port
