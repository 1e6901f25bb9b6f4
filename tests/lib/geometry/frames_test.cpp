#include "flatpose/geometry/frames.hpp"

#include <gtest/gtest.h>

namespace flatpose {
namespace {

const Vec3 kPoint_mm{3.5, -7.25, 11.0};

void expect_identity(const Pose& pose) {
  for (int i = 0; i < 9; ++i) EXPECT_NEAR(pose.rotation.m[i], i % 4 == 0 ? 1.0 : 0.0, 1e-14);
  EXPECT_NEAR(norm(pose.position_mm), 0.0, 1e-12);
}

TEST(Frames, AScanWithZUpIsWorkAsItStands) {
  const Frames frames = frames_of_scan(true);
  EXPECT_EQ(frames.work_T_scan * kPoint_mm, kPoint_mm);
  EXPECT_EQ(frames.face_T_work * kPoint_mm, kPoint_mm);
}

TEST(Frames, AScanWithZDownIsTurnedOverAboutX) {
  const Frames frames = frames_of_scan(false);
  const Vec3 p_work_mm = frames.work_T_scan * kPoint_mm;
  EXPECT_EQ(p_work_mm, (Vec3{kPoint_mm.x, -kPoint_mm.y, -kPoint_mm.z}));
  const Rotation& r = frames.work_T_scan.rotation;
  EXPECT_EQ(dot(cross(r.column(0), r.column(1)), r.column(2)), 1.0) << "turned, not mirrored";
}

TEST(Frames, WithoutAlignmentTheFaceIsTheScan) {
  for (const bool up_is_plus_z : {true, false}) {
    const Frames frames = frames_of_scan(up_is_plus_z);
    expect_identity(frames.face_T_work * frames.work_T_scan);
    EXPECT_EQ(frames.face_T_work * (frames.work_T_scan * kPoint_mm), kPoint_mm);
  }
}

TEST(Frames, WithAnAlignmentTheFaceIsWork) {
  const Pose work_T_scan{rotation_from_vector({2.9, 0.2, -0.1}), {10, 20, 300}};
  const Frames frames = frames_of_work(work_T_scan);
  expect_identity(frames.face_T_work);
  EXPECT_EQ(frames.work_T_scan * kPoint_mm, work_T_scan * kPoint_mm);
}

TEST(Frames, ToTheFaceAndBackCancels) {
  const Pose tilted{rotation_from_vector({0.3, -0.2, 0.9}), {1, 2, 3}};
  for (const Frames& frames : {frames_of_scan(true), frames_of_scan(false), frames_of_work(tilted),
                               Frames{tilted, tilted.inverse()}}) {
    expect_identity(frames.work_T_face() * frames.face_T_work);
    expect_identity(frames.face_T_work * frames.work_T_face());
  }
}

}  // namespace
}  // namespace flatpose
