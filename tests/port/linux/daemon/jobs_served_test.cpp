// What a job says of its poses, through the daemon: picks, frames, preferences.

#include <gtest/gtest.h>

#include "tests/port/linux/daemon/served.hpp"

namespace flatpose::daemon {
namespace {

using job::Answer;

/// Products and inverses of the test's own: a pose as four rows of four.
struct Rows {
  double m[4][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};

  static Rows of(const Pose& pose) {
    Rows r;
    const double p[] = {pose.position_mm.x, pose.position_mm.y, pose.position_mm.z};
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) r.m[i][j] = pose.rotation.m[static_cast<std::size_t>(3 * i + j)];
      r.m[i][3] = p[i];
    }
    return r;
  }
  static Rows at(double x, double y, double z) { return of({{}, {x, y, z}}); }
  /// A turn by degrees about x (0), y (1) or z (2).
  static Rows about(int axis, double degrees) {
    Rows r;
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    const double c = std::cos(degrees * M_PI / 180), s = std::sin(degrees * M_PI / 180);
    r.m[a][a] = r.m[b][b] = c;
    r.m[a][b] = -s;
    r.m[b][a] = s;
    return r;
  }
  friend Rows operator*(const Rows& x, const Rows& y) {
    Rows r;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) {
        r.m[i][j] = 0;
        for (int k = 0; k < 4; ++k) r.m[i][j] += x.m[i][k] * y.m[k][j];
      }
    return r;
  }
  [[nodiscard]] Pose pose() const {
    Pose p;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) p.rotation.m[static_cast<std::size_t>(3 * i + j)] = m[i][j];
    p.position_mm = {m[0][3], m[1][3], m[2][3]};
    return p;
  }
};

class JobsServed : public Served {
 protected:
  static void expect_at(const Plc::Block& block, const Rows& face_T_reported) {
    // The registers' numbers come from another order of sums: a unit in the last place.
    const Pose pose = face_T_reported.pose();
    EXPECT_NEAR(static_cast<double>(block[Field::kPositionX]), pose.position_mm.x * 1000, 1.01);
    EXPECT_NEAR(static_cast<double>(block[Field::kPositionY]), pose.position_mm.y * 1000, 1.01);
    EXPECT_NEAR(static_cast<double>(block[Field::kPositionZ]), pose.position_mm.z * 1000, 1.01);
    const std::array<double, 4> numbers{
        static_cast<double>(block[Field::kRotation1]) * 1e-3 * M_PI / 180,
        static_cast<double>(block[Field::kRotation2]) * 1e-3 * M_PI / 180,
        static_cast<double>(block[Field::kRotation3]) * 1e-3 * M_PI / 180, 0};
    const Rows told = Rows::about(2, numbers[0] * 180 / M_PI) *
                      Rows::about(1, numbers[1] * 180 / M_PI) *
                      Rows::about(0, numbers[2] * 180 / M_PI);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) EXPECT_NEAR(told.m[i][j], face_T_reported.m[i][j], 4e-5);
  }
};

TEST_F(JobsServed, PickIsComposedWithTheObjectsPose) {
  // The first pick lies outside, by its x; the second is told, the third never.
  const std::string picks =
      "[[part]]\nname = \"gripped\"\nfile = \"" FLATPOSE_EXAMPLE
      "/pad.fpt\"\n"
      "[[part.pick]]\nposition_mm = [5000, 0, 0]\npriority = 9\n"
      "[[part.pick]]\nposition_mm = [1, 0, 0]\n"
      "[[part.pick]]\nposition_mm = [12, -7, 3]\nrotation = [30, 10, 170]\ntool = 4\n"
      "priority = 3\n"
      "[[job]]\nnumber = 2\nparts = [\"gripped\"]\nlimit_x_mm = [-1000, 1000]\n"
      "[[job]]\nnumber = 3\nparts = [\"gripped\"]\npose = \"object\"\n"
      "[[job]]\nnumber = 4\nparts = [\"pad\"]\npose = \"pick\"\n";
  const std::string config = dry_run({}, picks);
  const auto own = located(config, kScan);
  RunningDaemon daemon({"--config", config});
  Plc plc(daemon.port());
  ASSERT_TRUE(plc.waits_until_ready());
  const Rows scan_T_object = Rows::of(own->matches[0].face_T_object);

  const Plc::Block object = plc.trigger(1, 0, 1, 1);
  EXPECT_EQ(object[Field::kTool], 0);
  EXPECT_EQ(object[Field::kPick], 0);
  expect_at(object, scan_T_object);

  const Plc::Block pick = plc.trigger(2, 0, 1, 2);
  EXPECT_EQ(pick[Field::kTool], 4);
  EXPECT_EQ(pick[Field::kPick], 3);
  expect_at(pick, scan_T_object * Rows::at(12, -7, 3) * Rows::about(2, 30) * Rows::about(1, 10) *
                      Rows::about(0, 170));

  expect_at(plc.trigger(3, 0, 1, 3), scan_T_object);

  const Plc::Block usual = plc.trigger(4, 0, 1, 4);
  EXPECT_EQ(usual[Field::kTool], 1);
  EXPECT_EQ(usual[Field::kPick], 0);
  expect_at(usual, scan_T_object * Rows::about(0, 180));
}

TEST_F(JobsServed, ReferenceRotationChoosesTheBranch) {
  const std::string jobs =
      "pose = \"pick\"\n[[job]]\nnumber = 2\nparts = [\"pad\"]\npose = \"pick\"\n"
      "reference_rotation = [360, 0, 0]\n";
  RunningDaemon daemon({"--config", dry_run(jobs)});
  Plc plc(daemon.port());
  ASSERT_TRUE(plc.waits_until_ready());
  const Plc::Block plain = plc.trigger(1, 0, 1, 1);
  const Plc::Block near = plc.trigger(2, 0, 1, 2);
  const auto turns = [](std::int64_t raw) { return static_cast<double>(raw) / 360'000.0; };
  const double apart = turns(near[Field::kRotation1]) - turns(plain[Field::kRotation1]);
  EXPECT_NEAR(apart, std::round(apart), 1e-5);
  EXPECT_NEAR(turns(near[Field::kRotation1]), 1.0, 0.5);
  EXPECT_LT(std::fabs(turns(plain[Field::kRotation1])), 0.5 + 1e-6);
}

}  // namespace
}  // namespace flatpose::daemon
