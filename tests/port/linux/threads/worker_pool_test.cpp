#include "port/linux/threads/worker_pool.hpp"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/prctl.h>

#include <atomic>
#include <chrono>
#include <set>
#include <thread>
#include <vector>

#include "port/linux/realtime/thread_setup.hpp"

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

TEST(WorkerPool, SetsItsThreadsUp) {
  RealtimeConfig config;
  config.timer_slack_ns = 4321;
  WorkerPool pool(3, config);
  ASSERT_EQ(pool.steps().size(), 2U);  // the caller's thread is the caller's
  for (const Step& step : pool.steps()) EXPECT_TRUE(step.is_done) << line_of(step);
  std::atomic<int> started = 0;
  std::atomic<int> set_up = 0;
  auto look = [&](int) {
    ++started;
    while (started < 3) std::this_thread::yield();
    if (prctl(PR_GET_TIMERSLACK) == 4321) ++set_up;
  };
  for_each_chunk(pool, 3, look);
  EXPECT_EQ(set_up, 2);
}

// A chunk that has to wait for something lets its thread sleep. When it wakes up, the caller, of
// the same priority on the same processor, must make room. Without the right to a priority this
// shows nothing.
TEST(WorkerPool, EndsOnOneProcessorWithAPriority) {
  std::atomic<bool> is_done = false;
  std::thread([&] {
    RealtimeConfig config;
    config.cpus = {sched_getcpu()};
    config.priority = 1;
    const Steps steps = set_up_this_thread(config, 0, "test");
    WorkerPool pool(2, config);
    auto wait_a_little = [](int) { std::this_thread::sleep_for(std::chrono::milliseconds(1)); };
    for (int job = 0; job < 20; ++job) for_each_chunk(pool, 2, wait_a_little);
    is_done = true;
  }).join();
  EXPECT_TRUE(is_done);
}

}  // namespace
}  // namespace flatpose::port
