// Fine images and the residuals that read them.

#include "flatpose/refine/pose_problem.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "flatpose/image/bspline.hpp"
#include "tests/lib/locate/made_scan.hpp"
#include "tests/lib/locate/simulated.hpp"

namespace flatpose::refine {
namespace {

using test::MadeScan;
using test::MadeScene;

constexpr double kWidth_mm = 50.0;
constexpr double kHeight_mm = 30.0;

const Pose kTruth{rotation_from_vector({0.06, -0.04, 0.0}) * rotation_about_z(0.4),
                  {60.3, 55.8, 12.0}};

/// A tilted rectangle over a floor.
double tilted_rectangle(double x, double y) {
  const Vec3 n = kTruth.rotation.column(2);
  const Vec3& t = kTruth.position_mm;
  const double z = t.z - (n.x * (x - t.x) + n.y * (y - t.y)) / n.z;
  const Vec3 p = kTruth.inverse() * Vec3{x, y, z};
  return std::fabs(p.x) <= 0.5 * kWidth_mm && std::fabs(p.y) <= 0.5 * kHeight_mm ? z : 0.0;
}

MadeScan tilted_scan() { return {120, 110, 1.0, tilted_rectangle}; }

class Perturbation {
 public:
  explicit Perturbation(unsigned seed) : generator_(seed) {}
  Vector<6> operator()(double turn_rad, double shift_mm) {
    Vector<6> step;
    std::uniform_real_distribution<double> u(-1.0, 1.0);
    for (int i = 0; i < 3; ++i) step[i] = turn_rad * u(generator_);
    for (int i = 3; i < 6; ++i) step[i] = shift_mm * u(generator_);
    return step;
  }

 private:
  std::mt19937 generator_;
};

double cost_at(const PoseProblem& problem, const Pose& pose) {
  NormalEquations<6> equations;
  EXPECT_TRUE(problem.evaluate(pose, &equations));
  return equations.cost();
}

TEST(FineImages, DistancesThatTheRefinementReadsAreBounded) {
  const MadeScene made(tilted_scan());
  int bounded_count = 0;
  for (int k = 0; k < image::kOctantCount; ++k) {
    const BoundedDistance bounded(made.fine, k);
    ASSERT_EQ(bounded.width_px, 120);
    ASSERT_EQ(bounded.height_px, 110);
    for (int y = 0; y < 110; ++y) {
      for (int x = 0; x < 120; ++x) {
        const int distance = made.fine.edge_distance_third_px[k](x, y);
        ASSERT_EQ(bounded(x, y), std::min<int>(distance, kEdgeDistanceMax_third_px));
        bounded_count += distance > kEdgeDistanceMax_third_px ? 1 : 0;
      }
    }
  }
  EXPECT_GT(bounded_count, 1000);
}

TEST(FineImages, EdgesCountInTheDirectionTheyFallOnly) {
  // A block whose four sides fall to four octants; the middle of each side, and how far its octant
  // and the opposite one see it.
  const MadeScan scan(80, 80, 1.0, [](double x, double y) {
    return x >= 30.0 && x <= 50.0 && y >= 30.0 && y <= 50.0 ? 8.0 : 0.0;
  });
  const MadeScene made(scan);
  const struct {
    int octant, column, row;
  } sides[] = {{0, 50, 40}, {2, 40, 50}, {4, 30, 40}, {6, 40, 30}};
  for (const auto& side : sides) {
    EXPECT_LE(made.fine.edge_distance_third_px[side.octant](side.column, side.row), 3);
    const int opposite = (side.octant + 4) % image::kOctantCount;
    EXPECT_GE(made.fine.edge_distance_third_px[opposite](side.column, side.row), 3 * 18);
  }
}

TEST(FineImages, SharesTheMapAndHasItsNormals) {
  const MadeScene made(tilted_scan());
  EXPECT_EQ(made.fine.height_mm.data, made.scene.map.height_mm.data);
  EXPECT_EQ(made.fine.filled_mm.data, made.scene.filled_mm.data);
  const Vec3 n = kTruth.rotation.column(2);
  EXPECT_NEAR(made.fine.normal_x(60, 55), n.x, 1e-3);
  EXPECT_NEAR(made.fine.normal_y(60, 55), n.y, 1e-3);
}

TEST(PoseProblem, GradientEqualsDifferencesOfTheCost) {
  const MadeScene made(tilted_scan());
  const model::Template part = test::rectangle_part(kWidth_mm, kHeight_mm, 12.0);
  const PoseProblemConfig config;
  const PoseProblem problem(part, made.fine, config);
  Perturbation perturbation(5);
  constexpr double kStep = 1e-6;
  for (int trial = 0; trial < 40; ++trial) {
    const Pose pose = moved(kTruth, perturbation(0.03, 1.5));
    NormalEquations<6> equations;
    ASSERT_TRUE(problem.evaluate(pose, &equations));
    for (int i = 0; i < 6; ++i) {
      Vector<6> step = Vector<6>::Zero();
      step[i] = kStep;
      const double above = cost_at(problem, problem.plus(pose, step));
      const double below = cost_at(problem, problem.plus(pose, Vector<6>(-step)));
      const double numeric = (above - below) / (2.0 * kStep);
      const double scale = std::sqrt(equations.hessian(i, i) * equations.square_sum());
      EXPECT_NEAR(equations.gradient()[i], numeric, 1e-4 * scale) << trial << " " << i;
    }
  }
}

TEST(PoseProblem, HessianIsThatOfTheResidualsAtTheTruth) {
  // Around its minimum the cost curves as H says, but for the second derivatives of the residuals.
  const MadeScene made(tilted_scan());
  const model::Template part = test::rectangle_part(kWidth_mm, kHeight_mm, 12.0);
  const PoseProblemConfig config;
  const PoseProblem problem(part, made.fine, config);
  NormalEquations<6> equations;
  ASSERT_TRUE(problem.evaluate(kTruth, &equations));
  EXPECT_TRUE(equations.is_finite());
  EXPECT_EQ(equations.residual_count(), std::min(config.contour_count, part.contour_count) +
                                            3 * std::min(config.surface_count, part.surface_count));
  for (int i = 0; i < 6; ++i) EXPECT_GT(equations.hessian(i, i), 0.0) << i;
}

TEST(PoseProblem, ContourFarFromAnyEdgeCostsWhatTheSplineSays) {
  // Most such points are told by one cell; the cost is that of sampling every one.
  const MadeScene made(tilted_scan());
  const model::Template part = test::rectangle_part(kWidth_mm, kHeight_mm, 12.0);
  PoseProblemConfig config;
  config.surface_count = 0;
  Perturbation perturbation(11);
  for (const double reach_mm : {1.0, 4.0, 10.0, 25.0}) {
    config.edge_reach_mm = reach_mm;
    const PoseProblem problem(part, made.fine, config);
    const RobustLoss loss = RobustLoss::tukey(reach_mm);
    for (int trial = 0; trial < 20; ++trial) {
      const Pose pose = moved(kTruth, perturbation(0.1, 15.0));
      double cost = 0.0;
      for (int i = 0; i < std::min(config.contour_count, part.contour_count); ++i) {
        const model::ContourPoint& p = part.contour[i];
        const Vec3 q_mm = pose * Vec3{p.x_mm, p.y_mm, p.z_mm};
        const Vec3 falling = pose.rotation * Vec3{p.nx, p.ny, 0.0};
        const BoundedDistance distance(made.fine, image::octant_of(static_cast<float>(falling.x),
                                                                   static_cast<float>(falling.y)));
        const double third_px = image::bspline_sample(distance, q_mm.x, q_mm.y).value;
        cost += loss(third_px / 3.0).cost / (config.edge_sigma_mm * config.edge_sigma_mm);
      }
      EXPECT_NEAR(cost_at(problem, pose), cost, 1e-9 * cost) << reach_mm << " " << trial;
    }
  }
}

TEST(PoseProblem, CostIsLeastNearTheTruth) {
  const MadeScene made(tilted_scan());
  const model::Template part = test::rectangle_part(kWidth_mm, kHeight_mm, 12.0);
  const PoseProblemConfig config;
  const PoseProblem problem(part, made.fine, config);
  const double at_truth = cost_at(problem, kTruth);
  for (int i = 0; i < 6; ++i) {
    for (const double side : {-1.0, 1.0}) {
      Vector<6> step = Vector<6>::Zero();
      step[i] = side * (i < 3 ? 0.1 : 2.0);
      EXPECT_GT(cost_at(problem, moved(kTruth, step)), at_truth) << i << " " << side;
    }
  }
}

TEST(PoseProblem, ConvergesFromMillimetresAndDegreesAway) {
  const MadeScene made(tilted_scan());
  const model::Template part = test::rectangle_part(kWidth_mm, kHeight_mm, 12.0);
  PoseProblemConfig config;
  config.edge_reach_mm = 8.0;
  config.height_reach_mm = 4.0;
  config.normal_reach = 0.4;
  const PoseProblem problem(part, made.fine, config);
  Perturbation perturbation(3);
  for (int trial = 0; trial < 30; ++trial) {
    const Pose start = moved(kTruth, perturbation(4.0 * kRadPerDeg, 3.0));
    const auto minimum = minimize<6>(problem, start);
    EXPECT_TRUE(is_converged(minimum.termination)) << static_cast<int>(minimum.termination);
    EXPECT_LE(minimum.cost_end, minimum.cost_start);
    const test::PoseError e = test::pose_error(minimum.x, kTruth);
    EXPECT_LT(e.in_plane_mm, 0.7) << trial;
    EXPECT_LT(e.z_mm, 0.05) << trial;
    EXPECT_LT(e.tilt_deg, 0.2) << trial;
    EXPECT_LT(e.turn_deg, 1.0) << trial;
  }
}

TEST(PoseProblem, RefusesAPoseThatLooksAway) {
  const MadeScene made(tilted_scan());
  const model::Template part = test::rectangle_part(kWidth_mm, kHeight_mm, 12.0);
  const PoseProblemConfig config;
  const PoseProblem problem(part, made.fine, config);
  const Pose away{rotation_from_vector({kPi, 0.0, 0.0}), kTruth.position_mm};
  NormalEquations<6> equations;
  EXPECT_FALSE(problem.evaluate(away, &equations));
  EXPECT_EQ((minimize<6>(problem, away).termination), Termination::kRefused);
}

TEST(PoseProblem, StaysFiniteOutsideOfTheField) {
  const MadeScene made(tilted_scan());
  const model::Template part = test::rectangle_part(kWidth_mm, kHeight_mm, 12.0);
  const PoseProblemConfig config;
  const PoseProblem problem(part, made.fine, config);
  for (const double away_mm : {-1e5, -300.0, 300.0, 1e5}) {
    NormalEquations<6> equations;
    ASSERT_TRUE(problem.evaluate(test::pose_at(away_mm, away_mm, 12.0), &equations));
    EXPECT_TRUE(equations.is_finite());
  }
}

TEST(Moved, ComposesInTheObjectsOwnFrame) {
  Vector<6> step;
  step << 0.0, 0.0, 0.5, 1.0, 0.0, 0.0;
  const Pose pose = test::pose_at(10.0, 20.0, 30.0, 0.5 * kPi);
  const Pose after = moved(pose, step);
  EXPECT_NEAR(after.position_mm.x, 10.0, 1e-12);
  EXPECT_NEAR(after.position_mm.y, 21.0, 1e-12);
  EXPECT_NEAR(angle_between_rad(after.rotation, rotation_about_z(0.5 * kPi + 0.5)), 0.0, 1e-12);
}

}  // namespace
}  // namespace flatpose::refine
