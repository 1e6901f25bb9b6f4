#include "port/linux/threads/worker_pool.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <set>
#include <thread>
#include <vector>

namespace flatpose::port {
namespace {

class WorkerPoolOf : public testing::TestWithParam<int> {};

TEST_P(WorkerPoolOf, RunsEveryChunkOnce) {
  WorkerPool pool(GetParam());
  for (const int chunk_count : {0, 1, 2, 3, 7, 64, 1000}) {
    std::vector<std::atomic<int>> runs(static_cast<std::size_t>(chunk_count));
    auto count = [&](int i) { ++runs[static_cast<std::size_t>(i)]; };
    for_each_chunk(pool, chunk_count, count);
    for (const auto& run : runs) EXPECT_EQ(run, 1);
  }
}

// What a job wrote is there when parallel_for returns, job after job, without a pause or after one
// long enough to fall asleep in.
TEST_P(WorkerPoolOf, IsDoneWhenItReturns) {
  WorkerPool pool(GetParam());
  std::vector<int> values(37, 0);
  for (int job = 1; job <= 2000; ++job) {
    auto set = [&](int i) { values[static_cast<std::size_t>(i)] = job; };
    for_each_chunk(pool, static_cast<int>(values.size()), set);
    for (const int value : values) ASSERT_EQ(value, job);
    if (job % 500 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

INSTANTIATE_TEST_SUITE_P(Threads, WorkerPoolOf, testing::Values(1, 2, 3, 8));

TEST(WorkerPool, SharesTheWorkOut) {
  WorkerPool pool(2);
  std::atomic<int> started = 0;
  // Each chunk waits until both are under way: one thread alone would never finish.
  auto meet = [&](int) {
    ++started;
    while (started < 2) std::this_thread::yield();
  };
  for_each_chunk(pool, 2, meet);
  EXPECT_EQ(started, 2);
}

TEST(WorkerPool, OfOneThreadIsTheCallers) {
  WorkerPool pool(1);
  std::set<std::thread::id> threads;
  auto note = [&](int) { threads.insert(std::this_thread::get_id()); };
  for_each_chunk(pool, 5, note);
  EXPECT_EQ(threads, std::set{std::this_thread::get_id()});
}

}  // namespace
}  // namespace flatpose::port
