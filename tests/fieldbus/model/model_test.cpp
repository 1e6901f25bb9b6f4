// Ten million random steps of two PLCs, their lines, a server and its search, each of which may
// fail at any moment; and machines with one line changed, which must be found out.

#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>

#include "tests/fieldbus/model/world.hpp"

namespace flatpose::model {
namespace {

constexpr int kSeedCount = 50;
constexpr int kStepsPerSeed = 200'000;
constexpr int kStepsBetweenCalms = 10'000;

/// Returns how many steps were taken; stops at the first failure.
int run(World& world) {
  for (int step = 1; step <= kStepsPerSeed; ++step) {
    world.step();
    if (step % kStepsBetweenCalms == 0) {
      world.calm_for(0);
      world.calm_for(1);
    }
    if (!world.judge().failures().empty()) return step;
  }
  return kStepsPerSeed;
}

#ifndef FLATPOSE_MUTANT

TEST(JobModel, NeverStaleNeverTwiceNeverADeadEndInTenMillionSteps) {
  int answers = 0, starts = 0, restarts = 0;
  for (int seed = 1; seed <= kSeedCount; ++seed) {
    World world(static_cast<std::uint64_t>(seed));
    const int steps = run(world);
    for (const std::string& failure : world.judge().failures())
      ADD_FAILURE() << failure << ", seed " << seed << ", step " << steps;
    answers += world.answer_count();
    starts += world.start_count();
    restarts += world.server_starts() - 1;
  }
  std::printf("%d poses taken, %d orders, %d restarts of the server\n", answers, starts, restarts);
  // The walk does get somewhere.
  EXPECT_GT(answers, 5'000);
  EXPECT_GT(starts, 20'000);
  EXPECT_GT(restarts, 200);
}

#else

TEST(JobMutantFoundOut, FLATPOSE_MUTANT_NAME) {
  for (int seed = 1; seed <= kSeedCount; ++seed) {
    World world(static_cast<std::uint64_t>(seed));
    const int steps = run(world);
    if (world.judge().failures().empty()) continue;
    for (const std::string& failure : world.judge().failures())
      std::printf("seed %d, step %d: %s\n", seed, steps, failure.c_str());
    EXPECT_NE(std::string(FLATPOSE_MUTANT).find(*world.judge().failures().begin()),
              std::string::npos)
        << "found out, but not for what was changed";
    return;
  }
  ADD_FAILURE() << "the mutant behaved";
}

#endif

}  // namespace
}  // namespace flatpose::model
