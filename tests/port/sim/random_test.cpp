#include "port/sim/random.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace flatpose::sim {
namespace {

TEST(Random, IsThePublishedSplitMix64) {
  Random random(0);
  EXPECT_EQ(random.bits(), 0xE220A8397B1DCDAFULL);
  EXPECT_EQ(random.bits(), 0x6E789E6AA1B965F4ULL);
  EXPECT_EQ(random.bits(), 0x06C45D188009454FULL);
}

TEST(NaturalLog, AgreesWithTheLibrary) {
  for (double x = 1e-300; x < 1e300; x *= 1.37) {
    EXPECT_NEAR(natural_log(x), std::log(x), 1e-15 * std::max(1.0, std::fabs(std::log(x)))) << x;
  }
  for (double x = 0.5; x < 2.0; x += 0.001) EXPECT_NEAR(natural_log(x), std::log(x), 2e-16) << x;
  EXPECT_EQ(natural_log(1.0), 0.0);
}

TEST(Random, UniformFillsItsRangeEvenly) {
  Random random(7);
  int bins[10] = {};
  for (int i = 0; i < 100000; ++i) {
    const double u = random.uniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    ++bins[static_cast<int>(10.0 * u)];
  }
  for (const int count : bins) EXPECT_NEAR(count, 10000, 400);  // sigma 95
}

TEST(Random, IndexReachesEveryValueAndNoOther) {
  Random random(7);
  int seen[7] = {};
  for (int i = 0; i < 7000; ++i) {
    const int k = random.index(7);
    ASSERT_GE(k, 0);
    ASSERT_LT(k, 7);
    ++seen[k];
  }
  for (const int count : seen) EXPECT_NEAR(count, 1000, 150);
}

TEST(Random, NormalPairHasTheMomentsOfTheNormalLaw) {
  Random random(11);
  constexpr int kCount = 200000;
  double sum = 0.0, sum2 = 0.0, sum4 = 0.0, mixed = 0.0;
  for (int i = 0; i < kCount / 2; ++i) {
    const auto [a, b] = random.normal_pair();
    sum += a + b;
    sum2 += a * a + b * b;
    sum4 += a * a * a * a + b * b * b * b;
    mixed += a * b;
  }
  EXPECT_NEAR(sum / kCount, 0.0, 0.01);
  EXPECT_NEAR(sum2 / kCount, 1.0, 0.015);
  EXPECT_NEAR(sum4 / kCount, 3.0, 0.1);
  EXPECT_NEAR(2.0 * mixed / kCount, 0.0, 0.015);
}

TEST(Random, NeighbouringStreamsAreUnrelated) {
  // Correlation of the first numbers of streams 0, 1, 2... with those of the next stream and seed.
  double next_key = 0.0, next_seed = 0.0;
  constexpr int kCount = 100000;
  for (int key = 0; key < kCount; ++key) {
    const double own = Random(5, key).uniform() - 0.5;
    next_key += own * (Random(5, key + 1).uniform() - 0.5);
    next_seed += own * (Random(6, key).uniform() - 0.5);
  }
  EXPECT_NEAR(12.0 * next_key / kCount, 0.0, 0.015);
  EXPECT_NEAR(12.0 * next_seed / kCount, 0.0, 0.015);
}

}  // namespace
}  // namespace flatpose::sim
