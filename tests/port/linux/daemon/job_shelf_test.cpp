// Jobs that come into force while orders run.

#include "port/linux/daemon/job_shelf.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "port/linux/daemon/mailbox.hpp"

namespace flatpose::daemon {
namespace {

/// A set that is known by the number of its one job.
std::shared_ptr<const JobSet> set_of(std::uint16_t number) {
  auto set = std::make_shared<JobSet>();
  Job job;
  job.config.rule.job = number;
  set->jobs.push_back(job);
  return set;
}

TEST(JobShelf, AnOrderKeepsTheSetItWasAcceptedUnder) {
  JobShelf shelf(set_of(1));
  const std::uint32_t before = shelf.generation();
  const JobSet& old = shelf.use(before);
  ASSERT_TRUE(shelf.has_room());
  shelf.offer(set_of(2));
  EXPECT_FALSE(shelf.has_room());
  EXPECT_FALSE(shelf.is_adopted());
  EXPECT_EQ(shelf.generation(), before);  // not in force before the machine has it
  ASSERT_NE(shelf.offered(), nullptr);
  EXPECT_EQ(shelf.offered()->rules[0].job, 2);
  shelf.adopt();
  EXPECT_EQ(shelf.offered(), nullptr);
  EXPECT_TRUE(shelf.is_adopted());
  EXPECT_NE(shelf.generation(), before);
  EXPECT_EQ(old.jobs[0].config.rule.job, 1);  // still searched in
  EXPECT_FALSE(shelf.has_room());             // so nothing may take its place
  EXPECT_EQ(shelf.use(shelf.generation()).jobs[0].config.rule.job, 2);
  EXPECT_TRUE(shelf.has_room());
}

TEST(JobShelf, LetsGoOfSetsThatNobodyUses) {
  std::shared_ptr<const JobSet> first = set_of(1);
  const std::weak_ptr<const JobSet> seen = first;
  JobShelf shelf(std::move(first));
  for (std::uint16_t number = 2; number < 4; ++number) {
    shelf.offer(set_of(number));
    shelf.adopt();
    (void)shelf.use(shelf.generation());
  }
  EXPECT_TRUE(seen.expired());
}

/// An order names the job of the set that its giver knew; whoever executes it must find that one.
struct Given {
  std::uint16_t job = 0;
  std::uint32_t generation = 0;
};

TEST(JobShelf, ThreeThreadsNeverMixSets) {
  constexpr int kExecuted = 300;
  JobShelf shelf(set_of(1));
  Latest<Given> orders;
  std::atomic<bool> is_over{false};
  std::atomic<int> mixed{0};
  std::atomic<int> executed{0};
  std::jthread search([&] {
    while (!is_over.load()) {
      const std::uint32_t generation = shelf.generation();
      Given given;
      if (!orders.take(given)) {
        (void)shelf.use(generation);
        continue;
      }
      const JobSet& set = shelf.use(given.generation);
      for (int look = 0; look < 20; ++look) {
        if (set.jobs[0].config.rule.job != given.job) mixed.fetch_add(1);
        std::this_thread::yield();  // the others go on while the set is used
      }
      executed.fetch_add(1);
    }
  });
  std::jthread bus([&] {
    std::uint16_t job = 1;  // what the machine's table says
    while (!is_over.load()) {
      if (const job::JobTable* const table = shelf.offered()) {
        job = table->rules[0].job;
        shelf.adopt();
      }
      orders.put({job, shelf.generation()});
    }
  });
  for (std::uint16_t number = 2; executed.load() < kExecuted; ++number) {
    while (!shelf.has_room()) std::this_thread::yield();
    shelf.offer(set_of(number));
  }
  is_over.store(true);
  search.join();
  bus.join();
  EXPECT_EQ(mixed.load(), 0);
}

}  // namespace
}  // namespace flatpose::daemon
