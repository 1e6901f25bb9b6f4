// Small scenes that each hold one thing an edge detector can get wrong.

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "tests/lib/image/edge_fixture.hpp"

namespace flatpose::image {
namespace {

constexpr int kSize = 60;

bool near_any(const std::vector<EdgePoint>& edges, double x, double y, double radius_px) {
  return std::any_of(edges.begin(), edges.end(), [&](const EdgePoint& e) {
    return std::hypot(e.x_px - x, e.y_px - y) <= radius_px;
  });
}

TEST(Edges, OfAnAxisParallelStepLieHalfwayBetweenTheCellsAndPointDown) {
  for (int turn = 0; turn < 4; ++turn) {
    const auto z = Image<float>::of(kSize, kSize, [&](int x, int y) {
      const int along = turn % 2 == 0 ? x : y;
      return (turn < 2 ? along <= 29 : along > 29) ? 5.0F : 0.0F;
    });
    const Edges edges = edges_of(z);
    EXPECT_EQ(edges.points.size(), kSize - 2U);  // not on the outermost ring
    const float sign = turn < 2 ? 1.0F : -1.0F;
    for (const EdgePoint& e : edges.points) {
      EXPECT_NEAR(turn % 2 == 0 ? e.x_px : e.y_px, 29.5F, 1e-4);
      EXPECT_NEAR(e.dx, turn % 2 == 0 ? sign : 0.0F, 1e-4);
      EXPECT_NEAR(e.dy, turn % 2 == 0 ? 0.0F : sign, 1e-4);
      EXPECT_NEAR(e.step_mm, 5.0F, 1e-3);
      EXPECT_EQ(e.kind, EdgeKind::kJump);
      EXPECT_EQ(edges.kinds(e.column, e.row), static_cast<std::uint8_t>(e.kind));
    }
  }
}

TEST(Edges, ObeyBothThresholdsInMillimetres) {
  const auto step_of = [](float height_mm) {
    return Image<float>::of(kSize, kSize, [=](int x, int) { return x < 30 ? height_mm : 0.0F; });
  };
  EXPECT_TRUE(edges_of(step_of(1.95F)).points.empty());
  EXPECT_TRUE(edges_of(step_of(2.95F)).points.empty());
  EXPECT_EQ(edges_of(step_of(3.05F)).points.size(), kSize - 2U);
  // One end of the step is strong: the contour is followed to where it falls below the low one.
  const auto fading = Image<float>::of(
      kSize, kSize, [](int x, int y) { return x < 30 ? 4.0F - 0.05F * static_cast<float>(y) : 0; });
  const Edges edges = edges_of(fading);
  int last_row = 0;
  for (const EdgePoint& e : edges.points) last_row = std::max<int>(last_row, e.row);
  EXPECT_NEAR(last_row, 40, 2);
}

TEST(Edges, OfWallsAndGapsOfThreeCellsAreBothThere) {
  for (const bool gap : {false, true}) {
    for (const double width_px : {3.0, 4.0, 5.0}) {
      for (const double tilt_deg : {0.0, 30.0}) {
        for (double degree = 0.0; degree < 180.0; degree += 14.3) {
          StepScene plane;
          plane.tilt_rad = tilt_deg * kRadPerDeg;
          plane.tilt_azimuth_rad = degree;
          const double c = std::cos(degree * kRadPerDeg);
          const double s = std::sin(degree * kRadPerDeg);
          const auto z = Image<float>::of(kSize, kSize, [&](int x, int y) {
            const bool inside = std::fabs((x - 30) * c + (y - 30) * s - 0.2) < width_px / 2.0;
            return (inside != gap ? 8.0 : 0.0) + plane.plane(x, y);
          });
          const Edges edges = edges_of(z);
          for (const double side : {-1.0, 1.0}) {
            std::vector<EdgePoint> falling_out;
            for (const EdgePoint& e : edges.points) {
              if ((e.dx * c + e.dy * s) * side * (gap ? -1.0 : 1.0) > 0.8) falling_out.push_back(e);
            }
            const double d = 0.2 + side * width_px / 2.0;
            for (double u = -18.0; u <= 18.0; u += 1.0) {
              EXPECT_TRUE(near_any(falling_out, 30.0 + d * c - u * s, 30.0 + d * s + u * c, 1.2))
                  << (gap ? "gap " : "wall ") << width_px << " tilt " << tilt_deg << " angle "
                  << degree << " side " << side << " at " << u;
            }
          }
        }
      }
    }
  }
}

// A block on a floor, its shadow beside it.
TEST(Edges, OfAShadowAreTheUpperContourAlone) {
  const auto z = Image<float>::of(kSize, kSize, [](int x, int y) {
    const bool block = x >= 15 && x < 30 && y >= 15 && y < 45;
    const bool shadow = x >= 30 && x < 42 && y >= 15 && y < 45;
    return shadow ? kMissing : (block ? 12.0F : 0.0F);
  });
  const Edges edges = edges_of(z);
  int missing_borders = 0;
  for (const EdgePoint& e : edges.points) {
    const bool on_contour = e.x_px > 13.5F && e.x_px < 30.5F && e.y_px > 13.5F && e.y_px < 45.5F;
    EXPECT_TRUE(on_contour) << e.x_px << " " << e.y_px;
    if (e.kind != EdgeKind::kMissingBorder) continue;
    ++missing_borders;
    EXPECT_NEAR(e.x_px, 29.5F, 0.6F);
    EXPECT_GT(e.dx, 0.5F);
  }
  EXPECT_NEAR(missing_borders, 30, 3);
  for (int y = 16; y < 44; ++y) {
    EXPECT_TRUE(near_any(edges.points, 29.5, y, 0.2));
    EXPECT_TRUE(near_any(edges.points, 14.5, y, 0.2));
  }
}

// A slope that the filling made is none: it must not be held against the contour beside it.
TEST(Edges, BesideMissingCellsAreNotWeakenedByTheFilledSlope) {
  const auto z = Image<float>::of(kSize, kSize, [](int x, int y) {
    if (x < 30) return 12.0F;
    return y >= 10 && y < 50 ? kMissing : 8.0F - 3.0F * static_cast<float>(x - 30);
  });
  const Edges edges = edges_of(z);
  for (int y = 16; y < 44; ++y) EXPECT_TRUE(near_any(edges.points, 29.5, y, 1.0)) << y;
}

// What is missing to the end of the map is filled along its rows; the step between two such rows
// was never seen.
TEST(Edges, AreNotMadeBetweenFilledCells) {
  const auto z = Image<float>::of(
      kSize, kSize, [](int x, int y) { return x >= 25 ? kMissing : (y < 30 ? 10.0F : 0.0F); });
  const Edges edges = edges_of(z);
  EXPECT_TRUE(near_any(edges.points, 12.0, 29.5, 0.1));
  for (const EdgePoint& e : edges.points) EXPECT_LT(e.x_px, 25.5F);
}

TEST(Edges, AreNotMadeByLostPixelsOnATiltedPlane) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<float> share(0.0F, 1.0F);
  const auto z = Image<float>::of(kSize, kSize, [&](int x, int y) {
    return share(generator) < 0.05F ? kMissing
                                    : 0.6F * static_cast<float>(x) - 0.3F * static_cast<float>(y);
  });
  EXPECT_TRUE(edges_of(z).points.empty());
}

TEST(Edges, AreNoneAtFootAndTopOfARampUpTo40Degrees) {
  for (const double tilt_deg : {10.0, 20.0, 30.0, 40.0}) {
    const double slope = std::tan(tilt_deg * kRadPerDeg);
    for (double degree = 0.0; degree < 360.0; degree += 17.0) {
      const auto z = Image<float>::of(kSize, kSize, [&](int x, int y) {
        const double along = (x - 30) * std::cos(degree) + (y - 30) * std::sin(degree);
        return slope * std::clamp(along, -10.0, 10.0);
      });
      EXPECT_TRUE(edges_of(z).points.empty()) << tilt_deg << " " << degree;
    }
  }
}

EdgeConfig with_creases() {
  EdgeConfig config;
  config.crease_low_rad = static_cast<float>(15.0 * kRadPerDeg);
  config.crease_high_rad = static_cast<float>(20.0 * kRadPerDeg);
  return config;
}

TEST(Creases, RunAlongTheRidgeOfARoofAndPointDown) {
  for (const double cell_mm : {0.5, 1.0, 2.0}) {
    for (double degree = 0.0; degree < 180.0; degree += 14.3) {
      const double c = std::cos(degree * kRadPerDeg);
      const double s = std::sin(degree * kRadPerDeg);
      // Steeper to one side: the lower one is known. 37 degrees between the two.
      const auto z = Image<float>::of(kSize, kSize, [&](int x, int y) {
        const double d = (x - 30) * c + (y - 30) * s;
        return cell_mm * (d > 0.0 ? -0.5 * d : 0.18 * d);
      });
      const Edges edges = edges_of(z, with_creases(), cell_mm);
      for (const EdgePoint& e : edges.points) {
        if (std::hypot(e.x_px - 30.0F, e.y_px - 30.0F) > 22.0F) continue;
        EXPECT_EQ(e.kind, EdgeKind::kCrease);
        EXPECT_EQ(e.step_mm, 0.0F);
        EXPECT_LT(std::fabs((e.x_px - 30.0) * c + (e.y_px - 30.0) * s), 0.8);
        EXPECT_GT(e.dx * c + e.dy * s, 0.97);
      }
      for (double u = -20.0; u <= 20.0; u += 1.0) {
        EXPECT_TRUE(near_any(edges.points, 30.0 - u * s, 30.0 + u * c, 1.3)) << degree << " " << u;
      }
      EXPECT_TRUE(edges_of(z, {}, cell_mm).points.empty()) << "creases are off by default";
    }
  }
}

TEST(Creases, AreNotFoundBesideAJumpNorBelowTheAngle) {
  for (double degree = 0.0; degree < 360.0; degree += 7.3) {
    StepScene scene;
    scene.angle_rad = degree * kRadPerDeg;
    scene.step_mm = 10.0;
    scene.tilt_rad = 0.3;
    const Edges edges = edges_of(scene.map(1), with_creases());
    for (const EdgePoint& e : edges.points) EXPECT_EQ(e.kind, EdgeKind::kJump) << degree;
  }
  const auto gentle = Image<float>::of(
      kSize, kSize, [](int x, int) { return -0.1F * std::fabs(static_cast<float>(x) - 30.0F); });
  EXPECT_TRUE(edges_of(gentle, with_creases()).points.empty());
}

TEST(Edges, AreOpenCvsCannyContoursToACell) {
  auto z = Image<float>::of(kSize, kSize, [](int x, int y) {
    const bool disc = std::hypot(x - 22, y - 25) < 14.0;
    const bool bar = std::fabs(0.8 * (x - 42) + 0.6 * (y - 40)) < 6.0 &&
                     std::fabs(-0.6 * (x - 42) + 0.8 * (y - 40)) < 12.0;
    return disc ? 20.0F : (bar ? 12.0F : 0.0F);
  });
  auto grey = Image<std::uint8_t>::of(kSize, kSize, [&](int x, int y) { return 10.0F * z(x, y); });
  cv::Mat judge;
  cv::Canny(cv::Mat(kSize, kSize, CV_8U, grey.data()), judge, 200, 300, 3, true);
  const Edges edges = edges_of(z);
  ASSERT_GT(edges.points.size(), 120U);
  int theirs = 0;
  int found = 0;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      if (judge.at<std::uint8_t>(y, x) == 0) continue;
      ++theirs;
      found += near_any(edges.points, x, y, 1.5) ? 1 : 0;
    }
  }
  EXPECT_GE(found, 0.98 * theirs);
  for (const EdgePoint& e : edges.points) {
    double nearest = 1e9;
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        if (judge.at<std::uint8_t>(y, x) == 0) continue;
        nearest = std::min(
            nearest,
            std::hypot(e.x_px - static_cast<float>(x), e.y_px - static_cast<float>(y)) * 1.0);
      }
    }
    EXPECT_LE(nearest, 1.5) << e.x_px << " " << e.y_px;
  }
}

}  // namespace
}  // namespace flatpose::image
