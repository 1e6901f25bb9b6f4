// Holes and telltales of contours drawn by hand.

#include "flatpose/model/landmarks.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "flatpose/core/maths.hpp"

namespace flatpose::model {
namespace {

class Drawing {
 public:
  Drawing() : part_(std::make_shared<Template>()) { part_->radius_mm = 60.0; }

  /// The outline runs counterclockwise; the height falls to the right of the way.
  Drawing& line(double x0, double y0, double x1, double y1) {
    const double length = std::hypot(x1 - x0, y1 - y0);
    for (double s = 0.5; s < length; s += 1.0) {
      add(x0 + (x1 - x0) * s / length, y0 + (y1 - y0) * s / length, (y1 - y0) / length,
          -(x1 - x0) / length);
    }
    return *this;
  }
  Drawing& rectangle(double width_mm, double height_mm) {
    const double x = 0.5 * width_mm, y = 0.5 * height_mm;
    return line(-x, -y, x, -y).line(x, -y, x, y).line(x, y, -x, y).line(-x, y, -x, -y);
  }
  Drawing& hole(double x_mm, double y_mm, double radius_mm) {
    const int count = static_cast<int>(2.0 * kPi * radius_mm);
    for (int i = 0; i < count; ++i) {
      const double a = 2.0 * kPi * i / count;
      add(x_mm + radius_mm * std::cos(a), y_mm + radius_mm * std::sin(a), -std::cos(a),
          -std::sin(a));
    }
    return *this;
  }
  Drawing& boss(double x_mm, double y_mm, double radius_mm) {
    const int first = part_->contour_count;
    hole(x_mm, y_mm, radius_mm);
    for (int i = first; i < part_->contour_count; ++i) {
      part_->contour[i].nx = -part_->contour[i].nx;
      part_->contour[i].ny = -part_->contour[i].ny;
    }
    return *this;
  }
  Drawing& turn(double angle_rad) {
    const double c = std::cos(angle_rad), s = std::sin(angle_rad);
    for (int i = 0; i < part_->contour_count; ++i) {
      ContourPoint& p = part_->contour[i];
      p = point(c * p.x_mm - s * p.y_mm, s * p.x_mm + c * p.y_mm, c * p.nx - s * p.ny,
                s * p.nx + c * p.ny);
    }
    return *this;
  }
  [[nodiscard]] const Template& part() const { return *part_; }
  [[nodiscard]] Landmarks landmarks() const { return find_landmarks(*part_); }

 private:
  static ContourPoint point(double x, double y, double nx, double ny) {
    ContourPoint p;
    p.x_mm = static_cast<float>(x);
    p.y_mm = static_cast<float>(y);
    p.nx = static_cast<float>(nx);
    p.ny = static_cast<float>(ny);
    p.step_mm = 5.0F;
    return p;
  }
  void add(double x, double y, double nx, double ny) {
    ASSERT_LT(part_->contour_count, kContourPointCountMax);
    part_->contour[part_->contour_count++] = point(x, y, nx, ny);
  }
  std::shared_ptr<Template> part_;  // the links of a chain draw on one part
};

Drawing l_shape(double first_mm, double second_mm) {
  Drawing d;
  d.line(0, 0, first_mm, 0).line(first_mm, 0, first_mm, 20).line(first_mm, 20, 20, 20);
  d.line(20, 20, 20, second_mm).line(20, second_mm, 0, second_mm).line(0, second_mm, 0, 0);
  return d;
}

TEST(Landmarks, OfARectangleAreNone) {
  const Landmarks found = Drawing().rectangle(80, 30).landmarks();
  EXPECT_EQ(found.hole_count, 0);
  EXPECT_EQ(found.telltale_count, 0);
  EXPECT_EQ(found.mirrored_count, 0);
}

TEST(Landmarks, HolesAreLoopsThatFallInward) {
  const Drawing d = Drawing().rectangle(100, 40).hole(-25, 0, 6).hole(25, 3, 9);
  const Landmarks found = d.landmarks();
  ASSERT_EQ(found.hole_count, 2);
  for (int i = 0; i < d.part().contour_count; ++i) {
    const ContourPoint& p = d.part().contour[i];
    const bool in_left = std::hypot(p.x_mm + 25.0, p.y_mm - 0.0) < 6.5;
    const bool in_right = std::hypot(p.x_mm - 25.0, p.y_mm - 3.0) < 9.5;
    EXPECT_EQ(found.hole[i] == 1, in_left) << i;
    EXPECT_EQ(found.hole[i] == 2, in_right) << i;
  }
  EXPECT_EQ(found.hole_point_count[1], 37);
  EXPECT_EQ(found.hole_point_count[2], 56);
  EXPECT_EQ(Drawing().rectangle(100, 40).boss(0, 0, 8).landmarks().hole_count, 0);
}

TEST(Landmarks, TelltalesAreWhatTheMirroredSelfLacks) {
  // Two holes of different size beside the long axis: on its face the part shows them with sizes
  // swapped.
  const Drawing d = Drawing().rectangle(100, 40).hole(-25, 6, 5).hole(25, 6, 10);
  const Landmarks found = d.landmarks();
  int in_holes = 0;
  for (int i = 0; i < d.part().contour_count; ++i) {
    if (found.telltale_gap_px[i] == 0.0F) continue;
    EXPECT_GT(found.hole[i], 0) << "a point of the outline, which is its own mirror image";
    ++in_holes;
  }
  EXPECT_EQ(in_holes, found.telltale_count);
  EXPECT_GT(in_holes, 60);  // of 31 + 62
}

TEST(Landmarks, HoldWhatTheMirroredSelfWouldShow) {
  // Where the small hole is, it would show the large one, and the other way round.
  const Landmarks found = Drawing().rectangle(100, 40).hole(-25, 6, 5).hole(25, 6, 10).landmarks();
  ASSERT_GT(found.mirrored_count, 60);
  for (int i = 0; i < found.mirrored_count; ++i) {
    const ContourPoint& p = found.mirrored[i];
    const double to_left = std::hypot(p.x_mm + 25.0, p.y_mm - 6.0);
    const double to_right = std::hypot(p.x_mm - 25.0, p.y_mm - 6.0);
    EXPECT_NEAR(p.x_mm < 0.0F ? to_left : to_right, p.x_mm < 0.0F ? 10.0 : 5.0, 1.0) << i;
    EXPECT_NEAR(std::hypot(p.nx, p.ny), 1.0, 1e-5);
    EXPECT_GE(found.mirrored_gap_px[i], 1.5F);
  }
}

TEST(Landmarks, EqualHolesTellNothing) {
  EXPECT_EQ(Drawing().rectangle(100, 40).hole(-25, 6, 8).hole(25, 6, 8).landmarks().telltale_count,
            0);
}

TEST(Landmarks, AnOffCentreHoleIsATelltaleUntilAMirrorPassesThroughIt) {
  EXPECT_EQ(Drawing().rectangle(100, 40).hole(-25, 0, 8).landmarks().telltale_count, 0);
  EXPECT_GT(Drawing().rectangle(100, 40).hole(-25, 9, 8).landmarks().telltale_count, 20);
}

TEST(Landmarks, ArmsOfDifferentLengthTellTheFace) {
  EXPECT_EQ(l_shape(80, 80).landmarks().telltale_count, 0);
  EXPECT_GT(l_shape(100, 60).landmarks().telltale_count, 40);
}

TEST(Landmarks, DoNotDependOnHowThePartWasTaught) {
  const int upright = l_shape(100, 60).landmarks().telltale_count;
  for (const double turn_rad : {0.3, 1.1, 2.6, 4.4}) {
    EXPECT_NEAR(l_shape(100, 60).turn(turn_rad).landmarks().telltale_count, upright, 8) << turn_rad;
    EXPECT_EQ(l_shape(80, 80).turn(turn_rad).landmarks().telltale_count, 0) << turn_rad;
    EXPECT_EQ(Drawing().boss(3, 4, 40).turn(turn_rad).landmarks().telltale_count, 0) << turn_rad;
  }
}

TEST(Landmarks, OfNoContourAreNone) {
  const Landmarks found = Drawing().landmarks();
  EXPECT_EQ(found.hole_count, 0);
  EXPECT_EQ(found.telltale_count, 0);
}

}  // namespace
}  // namespace flatpose::model
