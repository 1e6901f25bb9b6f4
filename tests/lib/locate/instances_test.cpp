// What keeps a pose from being refined or counted twice.

#include "flatpose/locate/instances.hpp"

#include <gtest/gtest.h>

#include <array>

#include "flatpose/locate/pose_set.hpp"

namespace flatpose::locate {
namespace {

Pose pose(double x_mm, double turn_rad = 0.0) {
  return {rotation_about_z(turn_rad), {x_mm, 0.0, 0.0}};
}

Verification worth(double score, double visible) {
  Verification v;
  v.score = score;
  v.visible = visible;
  return v;
}

TEST(PoseSet, ContainsWhatIsNearInPlaceAndAngle) {
  std::array<Pose, 2> memory;
  PoseSet set(memory, 4.0, 0.1);
  EXPECT_FALSE(set.contains(pose(0)));
  set.add(pose(10));
  EXPECT_TRUE(set.contains(pose(13, 0.09)));
  EXPECT_FALSE(set.contains(pose(14.5)));
  EXPECT_FALSE(set.contains(pose(10, 0.2)));
}

TEST(PoseSet, ForgetsWhatItHasNoRoomFor) {
  std::array<Pose, 1> memory;
  PoseSet set(memory, 1.0, 0.1);
  set.add(pose(0));
  set.add(pose(50));
  EXPECT_TRUE(set.contains(pose(0)));
  EXPECT_FALSE(set.contains(pose(50)));
}

TEST(Instances, AreSortedByScoreTimesVisible) {
  std::array<Instance, 3> memory;
  Instances instances(memory);
  instances.add(pose(1), worth(1.0, 0.5));
  instances.add(pose(2), worth(0.9, 0.9));
  instances.add(pose(0), worth(0.5, 1.0));
  EXPECT_TRUE(instances.is_full());
  instances.sort();
  EXPECT_EQ(instances[0].work_T_object.position_mm.x, 2.0);
  EXPECT_EQ(instances[1].work_T_object.position_mm.x, 0.0);  // equal in rank: by place
  EXPECT_EQ(instances[2].work_T_object.position_mm.x, 1.0);
}

TEST(Instances, KnowAPoseByPlaceAndRim) {
  std::array<Instance, 2> memory;
  Instances instances(memory);
  instances.add(pose(0), {});
  EXPECT_TRUE(instances.contains(pose(1.5), 2.0, 50.0));
  EXPECT_FALSE(instances.contains(pose(2.5), 2.0, 50.0));
  EXPECT_TRUE(instances.contains(pose(0, 0.03), 2.0, 50.0));
  EXPECT_FALSE(instances.contains(pose(0, 0.05), 2.0, 50.0));
}

}  // namespace
}  // namespace flatpose::locate
