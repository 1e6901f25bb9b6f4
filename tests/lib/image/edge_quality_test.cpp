// How good edges are, in numbers: each test prints what it measured and holds a limit near it.

#include <algorithm>
#include <cstdio>

#include "tests/lib/image/edge_fixture.hpp"

namespace flatpose::image {
namespace {

struct Quality {
  double direction_rms_deg = 0.0;
  double direction_max_deg = 0.0;
  double place_rms_px = 0.0;
  double place_max_px = 0.0;
  double place_mean_px = 0.0;
  double step_rms_mm = 0.0;
  double edges_per_px = 0.0;
  int gaps = 0;    // places of the contour with no edge within a cell
  int ghosts = 0;  // edges more than 1.5 cells off it, or pointing elsewhere
};

// All orientations in steps that share no period with the grid; only what lies off the border.
Quality measure(StepScene scene) {
  constexpr double kRadius_px = 40.0;
  Quality q;
  int count = 0;
  int length_px = 0;
  for (double degree = 0.0; degree < 360.0; degree += 7.3) {
    scene.angle_rad = degree * kRadPerDeg;
    scene.offset_px = 0.37 * std::sin(degree);
    scene.tilt_azimuth_rad = 1.3 * degree;
    const Edges edges = edges_of(scene.map(static_cast<unsigned>(degree * 10.0)));
    const double c = std::cos(scene.angle_rad);
    const double s = std::sin(scene.angle_rad);
    std::vector<double> along;
    for (const EdgePoint& e : edges.points) {
      const double x = e.x_px - StepScene::kMiddle_px;
      const double y = e.y_px - StepScene::kMiddle_px;
      if (std::hypot(x, y) > kRadius_px + 2.0) continue;
      const double off_px = scene.beyond(e.x_px, e.y_px);
      const double off_deg = std::acos(std::min(1.0, e.dx * c + e.dy * s)) * kDegPerRad;
      if (std::fabs(off_px) > 1.5 || off_deg > 40.0) {
        ++q.ghosts;
        continue;
      }
      along.push_back(-x * s + y * c);
      if (std::hypot(x, y) > kRadius_px) continue;
      ++count;
      q.direction_rms_deg += off_deg * off_deg;
      q.direction_max_deg = std::max(q.direction_max_deg, off_deg);
      q.place_rms_px += off_px * off_px;
      q.place_mean_px += off_px;
      q.place_max_px = std::max(q.place_max_px, std::fabs(off_px));
      q.step_rms_mm += (e.step_mm - scene.step_mm) * (e.step_mm - scene.step_mm);
    }
    for (double u = -kRadius_px; u <= kRadius_px; u += 1.0) {
      const bool seen = std::any_of(along.begin(), along.end(),
                                    [&](double a) { return std::fabs(a - u) <= 1.0; });
      q.gaps += seen ? 0 : 1;
      ++length_px;
    }
  }
  q.direction_rms_deg = std::sqrt(q.direction_rms_deg / count);
  q.place_rms_px = std::sqrt(q.place_rms_px / count);
  q.place_mean_px /= count;
  q.step_rms_mm = std::sqrt(q.step_rms_mm / count);
  q.edges_per_px = static_cast<double>(count) / length_px;
  std::printf(
      "step %4.1f mm tilt %2.0f deg noise %.1f mm %-9s: direction rms %.2f max %.1f deg, place rms "
      "%.3f max %.2f mean %+.3f px, step rms %.2f mm, %.2f edges/px, gaps %d, ghosts %d of %d\n",
      scene.step_mm, scene.tilt_rad * kDegPerRad, scene.noise_mm,
      scene.samples > 1 ? "averaged" : "sampled", q.direction_rms_deg, q.direction_max_deg,
      q.place_rms_px, q.place_max_px, q.place_mean_px, q.step_rms_mm, q.edges_per_px, q.gaps,
      q.ghosts, length_px);
  return q;
}

TEST(EdgeQuality, CleanStepsOfEveryOrientationAreWholeAndThinAtEveryTilt) {
  for (const int samples : {1, 6}) {
    for (const double tilt_deg : {0.0, 20.0, 40.0}) {
      for (const double step_mm : {4.0, 20.0}) {
        StepScene scene;
        scene.samples = samples;
        scene.step_mm = step_mm;
        scene.tilt_rad = tilt_deg * kRadPerDeg;
        const Quality q = measure(scene);
        EXPECT_LT(q.direction_rms_deg, samples > 1 ? 1.0 : 2.2);
        EXPECT_LT(q.direction_max_deg, samples > 1 ? 2.0 : 11.0);
        // A point-sampled step is known to half a cell only.
        EXPECT_LT(q.place_rms_px, samples > 1 ? 0.06 : 0.18);
        EXPECT_LT(q.place_max_px, samples > 1 ? 0.12 : 0.51);
        EXPECT_LT(std::fabs(q.place_mean_px), 0.02);
        EXPECT_LT(q.step_rms_mm, 0.15);
        EXPECT_LT(q.edges_per_px, 1.1);
        EXPECT_EQ(q.gaps, 0);
        EXPECT_EQ(q.ghosts, 0);
      }
    }
  }
}

TEST(EdgeQuality, NoiseOfATenthOfTheStepMovesLittle) {
  for (const double tilt_deg : {0.0, 20.0, 40.0}) {
    StepScene scene;
    scene.samples = 6;
    scene.noise_mm = 0.4;
    scene.tilt_rad = tilt_deg * kRadPerDeg;
    const Quality q = measure(scene);
    EXPECT_LT(q.direction_rms_deg, 3.0);
    EXPECT_LT(q.place_rms_px, 0.11);
    EXPECT_LT(q.step_rms_mm, 0.7);
    EXPECT_LE(q.gaps, 4);
    EXPECT_LE(q.ghosts, 4);
  }
}

TEST(EdgeQuality, NoiseBesideASteepTiltedContourMakesFewGhosts) {
  int ghosts = 0;
  for (const int samples : {1, 6}) {
    for (const double step_mm : {4.0, 8.0, 20.0}) {
      StepScene scene;
      scene.samples = samples;
      scene.step_mm = step_mm;
      scene.noise_mm = 0.4;
      scene.tilt_rad = 40.0 * kRadPerDeg;
      ghosts += measure(scene).ghosts;
    }
  }
  std::printf("ghosts in all: %d\n", ghosts);
  EXPECT_LE(ghosts, 25);
}

TEST(EdgeQuality, NoisyPlanesOfAnyTiltUpTo45DegreesHaveNextToNoEdges) {
  constexpr int kWidth_px = 600;
  constexpr int kHeight_px = 250;
  int total = 0;
  for (int tilt_deg = 0; tilt_deg <= 45; tilt_deg += 5) {
    StepScene plane;
    plane.tilt_rad = tilt_deg * kRadPerDeg;
    plane.tilt_azimuth_rad = 0.7 * tilt_deg;
    std::mt19937 generator(static_cast<unsigned>(tilt_deg));
    std::normal_distribution<double> noise(0.0, 0.4);
    const auto z = Image<float>::of(
        kWidth_px, kHeight_px, [&](int x, int y) { return plane.plane(x, y) + noise(generator); });
    total += static_cast<int>(edges_of(z).points.size());
  }
  std::printf(
      "false edges in 10 planes of %d x %d cells, noise 0.4 mm, thresholds 2 and 3 mm: %d\n",
      kWidth_px, kHeight_px, total);
  EXPECT_LE(total, 5);
}

}  // namespace
}  // namespace flatpose::image
