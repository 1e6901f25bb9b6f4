#pragma once
// Executors that run the chunks of a stage in other orders: what comes out must be the same.

#include <atomic>
#include <thread>
#include <vector>

#include "flatpose/core/executor.hpp"

namespace flatpose {

class ReverseExecutor final : public Executor {
 public:
  void parallel_for(int chunk_count, Task task, void* context) noexcept override {
    for (int i = chunk_count - 1; i >= 0; --i) task(context, i);
  }
};

/// Real threads, more than chunks or fewer.
class ThreadExecutor final : public Executor {
 public:
  explicit ThreadExecutor(int thread_count) : thread_count_(thread_count) {}

  void parallel_for(int chunk_count, Task task, void* context) noexcept override {
    std::atomic<int> next{0};
    std::vector<std::thread> threads;
    for (int t = 0; t < thread_count_; ++t) {
      threads.emplace_back([&] {
        for (int i = next++; i < chunk_count; i = next++) task(context, i);
      });
    }
    for (std::thread& thread : threads) thread.join();
  }

 private:
  int thread_count_;
};

/// Calls body(executor) for one after the other, the last first, and threads side by side.
template <class Body>
void for_each_executor(const Body& body) {
  InlineExecutor one_by_one;
  body(one_by_one);
  ReverseExecutor reverse;
  body(reverse);
  for (const int thread_count : {2, 3, 12}) {
    ThreadExecutor threads(thread_count);
    body(threads);
  }
}

}  // namespace flatpose
