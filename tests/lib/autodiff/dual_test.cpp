#include "flatpose/autodiff/dual.hpp"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "tests/lib/autodiff/dual_transcendental.hpp"
#include "tests/lib/autodiff/random_expression.hpp"

namespace flatpose::autodiff {
namespace {

using Dual3 = Dual<3>;
using Jet3 = ceres::Jet<double, 3>;
constexpr int kExpressionCount = 3000;

std::array<double, 3> random_point(Random& random) {
  return {random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)};
}

template <class T, class Seed>
T evaluate_at(const Program& program, const std::array<double, 3>& at, Seed seed_of) {
  return run<T>(program, {seed_of(at[0], 0), seed_of(at[1], 1), seed_of(at[2], 2)});
}

Dual3 dual_of(const Program& program, const std::array<double, 3>& at) {
  return evaluate_at<Dual3>(program, at, [](double v, int i) { return seed<3>(v, i); });
}

double value_of(const Program& program, const std::array<double, 3>& at) {
  return evaluate_at<double>(program, at, [](double v, int) { return v; });
}

TEST(Dual, EqualsCeresJetOnRandomExpressions) {
  Random random(1);
  for (int k = 0; k < kExpressionCount; ++k) {
    const Program program = random_program(random);
    const auto at = random_point(random);
    const Dual3 ours = dual_of(program, at);
    const Jet3 theirs = evaluate_at<Jet3>(program, at, [](double v, int i) { return Jet3(v, i); });
    ASSERT_NEAR(ours.value, theirs.a, 1e-11 * (1.0 + std::fabs(theirs.a))) << k;
    for (int i = 0; i < 3; ++i)
      ASSERT_NEAR(ours.derivative[i], theirs.v[i], 1e-10 * (1.0 + theirs.v.norm())) << k;
  }
}

TEST(Dual, EqualsCentralDifferencesOnRandomExpressions) {
  Random random(2);
  int compared_count = 0;
  for (int k = 0; k < kExpressionCount; ++k) {
    const Program program = random_program(random);
    const auto at = random_point(random);
    const Dual3 ours = dual_of(program, at);
    for (int i = 0; i < 3; ++i) {
      // Two steps that disagree tell a kink or strong curvature, where differences say nothing.
      const auto difference = [&](double step) {
        auto low = at, high = at;
        low[i] -= step;
        high[i] += step;
        return (value_of(program, high) - value_of(program, low)) / (2 * step);
      };
      const double coarse = difference(2e-4), fine = difference(1e-4);
      const double tolerance = 1e-6 * (1.0 + std::fabs(fine));
      if (!(std::fabs(coarse - fine) < tolerance)) continue;
      ++compared_count;
      ASSERT_NEAR(ours.derivative[i], fine, 3 * tolerance) << k << " " << i;
    }
  }
  EXPECT_GT(compared_count, 2 * kExpressionCount);
}

TEST(Dual, ValueEqualsTheSameExpressionInDoubleBitForBit) {
  Random random(3);
  for (int k = 0; k < kExpressionCount; ++k) {
    const Program program = random_program(random);
    const auto at = random_point(random);
    ASSERT_EQ(dual_of(program, at).value, value_of(program, at)) << k;
  }
}

TEST(Dual, OperatorsWithDoubleEqualThoseWithAConstantDual) {
  Random random(4);
  const auto expect_equal = [](const Dual3& a, const Dual3& b) {
    EXPECT_DOUBLE_EQ(a.value, b.value);
    for (int i = 0; i < 3; ++i) EXPECT_DOUBLE_EQ(a.derivative[i], b.derivative[i]);
  };
  for (int k = 0; k < 100; ++k) {
    const Dual3 a(random.uniform(0.1, 2), {random.uniform(-1, 1), random.uniform(-1, 1), 0.0});
    const double b = random.uniform(0.1, 2);
    expect_equal(a + b, a + Dual3(b));
    expect_equal(b + a, Dual3(b) + a);
    expect_equal(a - b, a - Dual3(b));
    expect_equal(b - a, Dual3(b) - a);
    expect_equal(a * b, a * Dual3(b));
    expect_equal(b * a, Dual3(b) * a);
    expect_equal(a / b, a / Dual3(b));
    expect_equal(b / a, Dual3(b) / a);
    Dual3 sum = a;
    sum += a;
    sum *= a;
    sum -= a;
    sum /= a;
    expect_equal(sum, (((a + a) * a) - a) / a);
  }
}

// x^2 + 2 x + 2 at 3, the example of Ingberg 2015 (2.3), where 17 is misprinted as 19.
TEST(Dual, SolvesTheExampleOfTheThesis) {
  const auto x = seed<1>(3.0, 0);
  const auto f = x * x + 2.0 * x + 2.0;
  EXPECT_EQ(f.value, 17.0);
  EXPECT_EQ(f.derivative[0], 8.0);
}

TEST(Dual, ComparesByValueAlone) {
  const Dual<1> a(1.0, {5.0}), same(1.0, {-5.0}), above(2.0, {0.0});
  EXPECT_TRUE(a == same && a <= same && !(a < same));
  EXPECT_TRUE(a < above && above > a && a != above);
  EXPECT_TRUE(a < 1.5 && 0.5 < a && a == 1.0 && 1.0 >= a);
  const Dual<1> nan(std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(nan < a || nan >= a || nan == nan);
}

TEST(Dual, TakesANamedSideOnAKink) {
  const Dual<1> zero(0.0, {3.0}), first(1.0, {1.0}), second(1.0, {2.0});
  EXPECT_EQ(fabs(zero).derivative[0], 3.0);
  EXPECT_EQ(fabs(Dual<1>(-2.0, {3.0})).derivative[0], -3.0);
  EXPECT_EQ(min(first, second).derivative[0], 1.0);
  EXPECT_EQ(max(first, second).derivative[0], 1.0);
  EXPECT_EQ(min(first, Dual<1>(0.5, {7.0})).derivative[0], 7.0);
  EXPECT_EQ(max(first, Dual<1>(1.5, {7.0})).derivative[0], 7.0);
}

TEST(Dual, IsNotFiniteWhereThereIsNoDerivative) {
  EXPECT_FALSE(std::isfinite(sqrt(Dual<1>(0.0, {1.0})).derivative[0]));
  EXPECT_FALSE(std::isfinite(sqrt(Dual<1>(-1.0, {1.0})).value));
  EXPECT_FALSE(std::isfinite(atan2(Dual<1>(0.0, {1.0}), Dual<1>(0.0, {1.0})).derivative[0]));
  EXPECT_FALSE(std::isfinite((Dual<1>(1.0, {1.0}) / Dual<1>(0.0, {1.0})).value));
}

TEST(ScalarPart, IsTheValueOfDoubleAndDual) {
  EXPECT_EQ(scalar_part(2.5), 2.5);
  EXPECT_EQ(scalar_part(Dual<2>(2.5, {1.0, 2.0})), 2.5);
  static_assert(scalar_part(seed<2>(4.0, 1)) == 4.0);
  static_assert(seed<2>(4.0, 1).derivative[1] == 1.0 && seed<2>(4.0, 1).derivative[0] == 0.0);
}

}  // namespace
}  // namespace flatpose::autodiff
