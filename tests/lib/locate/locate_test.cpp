// The pipeline on scans whose parts are known exactly: what is found, what is not, and in which
// order.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "tests/lib/locate/made_bin.hpp"
#include "tests/lib/locate/simulated.hpp"

namespace flatpose::locate {
namespace {

using test::Block;
using test::Locating;
using test::MadeScan;

/// Index of the block a match lies on; -1 when on none. Checks the pose up to the part's symmetry.
int block_of(const Match& match, const std::vector<Block>& blocks) {
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    test::PoseError e = test::pose_error(match.face_T_object, blocks[i].scan_T_object);
    e.turn_deg = std::min(e.turn_deg, std::fabs(180.0 - e.turn_deg));
    if (e.in_plane_mm < 1.0 && e.z_mm < 0.3 && e.tilt_deg < 1.0 && e.turn_deg < 1.5)
      return static_cast<int>(i);
  }
  return -1;
}

void expect_none(const LocateResult& result) {
  EXPECT_EQ(result.match_count, 0);
  EXPECT_LT(static_cast<int>(result.outcome), 0);
}

TEST(Locate, FindsThePartWhereItLies) {
  const std::vector<Block> blocks{{test::pose_at(70, 60, 10, 0.5)}};
  Locating locating;
  ASSERT_EQ(locating.run(test::block_part(), test::bin_scan(blocks).view()), Status::kOk);
  const LocateResult& r = locating.result;
  EXPECT_EQ(r.outcome, Outcome::kOk);
  ASSERT_EQ(r.match_count, 1);
  EXPECT_EQ(block_of(r.matches[0], blocks), 0);
  EXPECT_GT(r.matches[0].score, 0.9);
  EXPECT_GT(r.matches[0].visible, 0.98);
  EXPECT_FALSE(r.matches[0].turn_is_free);
  EXPECT_GT(r.hypothesis_count, 0);
  EXPECT_GT(r.candidate_count, 0);
  const Match& m = r.matches[0];
  for (const double sigma :
       {m.sigma_mm.x, m.sigma_mm.y, m.sigma_mm.z, m.sigma_rad.x, m.sigma_rad.y, m.sigma_rad.z}) {
    EXPECT_GT(sigma, 0.0);
    EXPECT_LT(sigma, 0.5);
  }
}

TEST(Locate, FindsItWithEitherMethodOfRectifying) {
  const std::vector<Block> blocks{{test::pose_at(70, 60, 10, 0.5)}};
  LocateConfig config;
  config.method = rectify::Method::kBucket;
  Locating locating;
  ASSERT_EQ(locating.run(test::block_part(), test::bin_scan(blocks).view(), config), Status::kOk);
  ASSERT_EQ(locating.result.match_count, 1);
  EXPECT_EQ(block_of(locating.result.matches[0], blocks), 0);
}

TEST(Locate, OfEquivalentPosesReportsTheOneTurnedLeast) {
  for (const double turn_rad : {-3.0, -1.7, -1.4, 0.2, 1.4, 1.7, 2.9}) {
    Locating locating;
    ASSERT_EQ(locating.run(test::block_part(),
                           test::bin_scan({{test::pose_at(75, 60, 10, turn_rad)}}).view()),
              Status::kOk);
    ASSERT_EQ(locating.result.match_count, 1) << turn_rad;
    const Rotation& r = locating.result.matches[0].face_T_object.rotation;
    EXPECT_GE(r.m[0], -1e-9) << turn_rad;  // at most a quarter turn from x
  }
}

TEST(Locate, AScanWithoutPointsIsPoor) {
  const MadeScan nothing(150, 120, 1.0, [](double, double) { return test::kLost; });
  Locating locating;
  ASSERT_EQ(locating.run(test::block_part(), nothing.view()), Status::kOk);
  EXPECT_EQ(locating.result.outcome, Outcome::kScanPoor);
  expect_none(locating.result);
  const MadeScan hardly(
      150, 120, 1.0, [](double x, double y) { return x < 12.0 && y < 12.0 ? 0.0 : test::kLost; });
  ASSERT_EQ(locating.run(test::block_part(), hardly.view()), Status::kOk);
  EXPECT_EQ(locating.result.outcome, Outcome::kScanPoor);
}

TEST(Locate, PointsThatMakeNoSurfaceArePoor) {
  const MadeScan scattered(150, 120, 1.0, [](double x, double y) {
    return std::fmod(x + 2.0 * y, 5.0) < 0.5 ? 3.0 : test::kLost;
  });
  Locating locating;
  ASSERT_EQ(locating.run(test::block_part(), scattered.view()), Status::kOk);
  EXPECT_EQ(locating.result.outcome, Outcome::kScanPoor);
  const MadeScan line(150, 1, 1.0, [](double, double) { return 3.0; });
  ASSERT_EQ(locating.run(test::block_part(), line.view()), Status::kOk);
  EXPECT_EQ(locating.result.outcome, Outcome::kScanPoor);
}

TEST(Locate, APlainFloorHoldsNothing) {
  for (const double noise_mm : {0.0, 0.05, 1.0}) {
    Locating locating;
    ASSERT_EQ(locating.run(test::block_part(), test::bin_scan({}, noise_mm).view()), Status::kOk);
    expect_none(locating.result);
    EXPECT_TRUE(locating.result.outcome == Outcome::kEmptyScene ||
                locating.result.outcome == Outcome::kNoMatch)
        << to_string(locating.result.outcome);
  }
}

TEST(Locate, WhatIsAbsentIsNotFound) {
  // Others of like height and size.
  const std::vector<std::vector<Block>> scenes{{{test::pose_at(70, 60, 10, 0.5), 38.0, 38.0}},
                                               {{test::pose_at(70, 60, 10, 0.5), 64.0, 30.0}},
                                               {{test::pose_at(70, 60, 10, 0.5), 50.0, 20.0}},
                                               {{test::pose_at(70, 60, 10, 0.5), 90.0, 70.0}}};
  for (const std::vector<Block>& blocks : scenes) {
    Locating locating;
    ASSERT_EQ(locating.run(test::block_part(), test::bin_scan(blocks).view()), Status::kOk);
    EXPECT_EQ(locating.result.outcome, Outcome::kNoMatch) << blocks[0].width_mm;
    expect_none(locating.result);
    EXPECT_LT(locating.result.best_rejected_score, test::block_part().score_threshold);
  }
}

TEST(Locate, FindsEachInstanceOnce) {
  const std::vector<Block> blocks = test::three_blocks();
  Locating locating;
  LocateConfig config;
  config.max_matches = 10;
  ASSERT_EQ(locating.run(test::block_part(), test::bin_scan(blocks).view(), config), Status::kOk);
  ASSERT_EQ(locating.result.match_count, 3);
  std::vector<int> found;
  for (const Match& m : locating.result.found()) found.push_back(block_of(m, blocks));
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found, (std::vector<int>{0, 1, 2}));
}

TEST(Locate, TwoSideBySideAreTwo) {
  const std::vector<Block> blocks{{test::pose_at(45, 40, 10)}, {test::pose_at(99, 40, 10)}};
  Locating locating;
  LocateConfig config;
  config.max_matches = 10;
  ASSERT_EQ(locating.run(test::block_part(), test::bin_scan(blocks).view(), config), Status::kOk);
  ASSERT_EQ(locating.result.match_count, 2);
  EXPECT_NE(block_of(locating.result.matches[0], blocks),
            block_of(locating.result.matches[1], blocks));
}

TEST(Locate, ReturnsNoMoreThanAskedFor) {
  const MadeScan scan = test::bin_scan(test::three_blocks());
  for (int count = 1; count <= 3; ++count) {
    Locating locating;
    LocateConfig config;
    config.max_matches = count;
    ASSERT_EQ(locating.run(test::block_part(), scan.view(), config), Status::kOk);
    EXPECT_EQ(locating.result.match_count, count);
  }
}

TEST(Locate, OrdersAsAsked) {
  // The second block, the highest, is partly covered by a bar.
  std::vector<Block> blocks = test::three_blocks();
  std::vector<Block> all = blocks;
  all.push_back({test::pose_at(110, 64, 45, 0.0), 60.0, 22.0});
  const MadeScan scan = test::bin_scan(all);
  for (const Order order : {Order::kScore, Order::kHeight, Order::kVisible}) {
    Locating locating;
    LocateConfig config;
    config.max_matches = 5;
    config.min_visible = 0.3;
    config.order = order;
    ASSERT_EQ(locating.run(test::block_part(), scan.view(), config), Status::kOk);
    ASSERT_EQ(locating.result.match_count, 3);
    const auto key = [&](const Match& m) {
      if (order == Order::kHeight) return m.face_T_object.position_mm.z;
      return order == Order::kVisible ? m.visible : m.visible * m.score;
    };
    for (int i = 1; i < 3; ++i) {
      EXPECT_GE(key(locating.result.matches[i - 1]), key(locating.result.matches[i]));
    }
    const int covered = order == Order::kHeight ? 0 : 2;
    EXPECT_EQ(block_of(locating.result.matches[covered], blocks), 1);
  }
}

TEST(Locate, HighestIsNearestToASensorThatLooksAlongZ) {
  const std::vector<Block> blocks = test::three_blocks();
  MadeScan scan = test::bin_scan(blocks);
  for (std::size_t i = 0; i < scan.xyz_mm.size(); i += 3) {  // half a turn about x
    scan.xyz_mm[i + 1] = -scan.xyz_mm[i + 1];
    scan.xyz_mm[i + 2] = -scan.xyz_mm[i + 2];
  }
  Locating locating;
  LocateConfig config;
  config.max_matches = 5;
  config.order = Order::kHeight;
  ASSERT_EQ(locating.locator.locate(test::block_part(), scan.view(), frames_of_scan(false), config,
                                    StoppedClock{}, locating.result),
            Status::kOk);
  ASSERT_EQ(locating.result.match_count, 3);
  const auto& m = locating.result.matches;
  EXPECT_NEAR(m[0].face_T_object.position_mm.z, -22.0, 0.3);
  EXPECT_NEAR(m[1].face_T_object.position_mm.z, -16.0, 0.3);
  EXPECT_NEAR(m[2].face_T_object.position_mm.z, -10.0, 0.3);
  EXPECT_LT(m[0].face_T_object.rotation.m[8], -0.99);  // z toward the sensor
}

Region circle(double x_mm, double y_mm, double radius_mm) {
  Region region;
  region.kind = Region::Kind::kCircle;
  region.x_mm = x_mm;
  region.y_mm = y_mm;
  region.radius_mm = radius_mm;
  return region;
}

TEST(Locate, LooksInTheRegionOnly) {
  const std::vector<Block> blocks = test::three_blocks();
  const MadeScan scan = test::bin_scan(blocks);
  for (int i = 0; i < 3; ++i) {
    const Vec3& p = blocks[i].scan_T_object.position_mm;
    Locating locating;
    LocateConfig config;
    config.max_matches = 5;
    config.region = circle(p.x, p.y, 6.0);
    ASSERT_EQ(locating.run(test::block_part(), scan.view(), config), Status::kOk);
    ASSERT_EQ(locating.result.match_count, 1);
    EXPECT_EQ(block_of(locating.result.matches[0], blocks), i);
  }
  Locating locating;
  LocateConfig config;
  config.region = circle(75.0, 62.0, 5.0);  // between the three
  ASSERT_EQ(locating.run(test::block_part(), scan.view(), config), Status::kOk);
  expect_none(locating.result);
  config.region = circle(1000.0, 1000.0, 20.0);  // where no scan is
  ASSERT_EQ(locating.run(test::block_part(), scan.view(), config), Status::kOk);
  expect_none(locating.result);
}

// A robot's frame: turned, far away, leaning. What is found is the same, told from there, and the
// region is a prism along its z.
TEST(Locate, TellsPosesAndTakesRegionsInAnyFrameAtTheFace) {
  const std::vector<Block> blocks = test::three_blocks();
  const MadeScan scan = test::bin_scan(blocks);
  for (const double turn_rad : {0.8, 2.4, -2.2}) {
    for (const double lean_rad : {0.0, 0.5, 3.0}) {
      const Pose face_T_scan{
          rotation_about_z(turn_rad) * rotation_from_vector({lean_rad, 0.3 * lean_rad, 0.0}),
          {900, -400, 700}};
      const Frames frames{{}, face_T_scan};
      for (int i = 0; i < 3; ++i) {
        const Vec3 p = face_T_scan * blocks[i].scan_T_object.position_mm;
        LocateConfig config;
        config.max_matches = 5;
        config.region = circle(p.x, p.y, 6.0);
        Locating locating;
        ASSERT_EQ(locating.locator.locate(test::block_part(), scan.view(), frames, config,
                                          StoppedClock{}, locating.result),
                  Status::kOk);
        ASSERT_EQ(locating.result.match_count, 1) << turn_rad << " " << lean_rad << " " << i;
        Match m = locating.result.matches[0];
        m.face_T_object = face_T_scan.inverse() * m.face_T_object;
        EXPECT_EQ(block_of(m, blocks), i);
      }
    }
  }
}

TEST(Locate, LooksNowhereInAnExclusion) {
  const std::vector<Block> blocks = test::three_blocks();
  const MadeScan scan = test::bin_scan(blocks);
  for (const Pose& face_T_scan :
       {Pose{}, Pose{rotation_from_vector({3.0, 0.3, 0.2}), {900, -400, 700}}}) {
    const Frames frames{{}, face_T_scan};
    for (int wanted = 0; wanted < 3; ++wanted) {
      std::vector<Region> exclusions;
      for (int i = 0; i < 3; ++i) {
        const Vec3 p = face_T_scan * blocks[i].scan_T_object.position_mm;
        if (i != wanted) exclusions.push_back(circle(p.x, p.y, 12.0));
      }
      // One match is asked for: what is excluded takes none of its room.
      LocateConfig config;
      config.exclusions = exclusions;
      Locating locating;
      ASSERT_EQ(locating.locator.locate(test::block_part(), scan.view(), frames, config,
                                        StoppedClock{}, locating.result),
                Status::kOk);
      ASSERT_EQ(locating.result.match_count, 1);
      Match m = locating.result.matches[0];
      m.face_T_object = face_T_scan.inverse() * m.face_T_object;
      EXPECT_EQ(block_of(m, blocks), wanted);
    }
  }
}

TEST(Locate, LooksInTheRangeOfHeightsOnly) {
  const std::vector<Block> blocks = test::three_blocks();
  const MadeScan scan = test::bin_scan(blocks);
  const auto found_at = [&](double low_mm, double high_mm) {
    LocateConfig config;
    config.max_matches = 5;
    config.height_min_mm = low_mm;
    config.height_max_mm = high_mm;
    Locating locating;
    EXPECT_EQ(locating.run(test::block_part(), scan.view(), config), Status::kOk);
    std::vector<int> found;
    for (const Match& m : locating.result.found()) found.push_back(block_of(m, blocks));
    std::sort(found.begin(), found.end());
    return found;
  };
  EXPECT_EQ(found_at(-1e9, 1e9), (std::vector<int>{0, 1, 2}));
  for (int i = 0; i < 3; ++i) {
    const double z_mm = blocks[i].scan_T_object.position_mm.z;
    std::vector<int> expected;
    for (int j = 0; j < 3; ++j)
      if (std::fabs(blocks[j].scan_T_object.position_mm.z - z_mm) < 0.4) expected.push_back(j);
    EXPECT_EQ(found_at(z_mm - 0.4, z_mm + 0.4), expected);
    EXPECT_EQ(found_at(z_mm + 300.0, z_mm + 301.0), std::vector<int>{});
  }
}

// Many copies of the part where it may not lie, and one where it may: candidates are of the latter.
TEST(Locate, WhatIsExcludedTakesNoRoomAmongTheCandidates) {
  const std::vector<Block> blocks = test::three_blocks();
  const MadeScan scan = test::bin_scan(blocks);
  const Vec3& p = blocks[0].scan_T_object.position_mm;
  Region all_but_it;  // a frame around everything, with the one place cut out by a slit
  all_but_it.kind = Region::Kind::kPolygon;
  const double xy[][2] = {{-500, -500},   {p.x, -500},    {p.x, p.y - 8}, {p.x - 8, p.y},
                          {p.x, p.y + 8}, {p.x + 8, p.y}, {p.x, p.y - 8}, {p.x + 1e-3, -500},
                          {500, -500},    {500, 500},     {-500, 500}};
  for (const auto& corner : xy) {
    all_but_it.vertex_x_mm[all_but_it.vertex_count] = corner[0];
    all_but_it.vertex_y_mm[all_but_it.vertex_count++] = corner[1];
  }
  ASSERT_FALSE(all_but_it.contains(p.x + 1, p.y + 1));
  ASSERT_TRUE(all_but_it.contains(p.x + 30, p.y + 30));
  LocateConfig config;
  config.max_matches = 5;
  Locating everywhere;
  ASSERT_EQ(everywhere.run(test::block_part(), scan.view(), config), Status::kOk);
  config.exclusions = {&all_but_it, 1};
  Locating locating;
  ASSERT_EQ(locating.run(test::block_part(), scan.view(), config), Status::kOk);
  ASSERT_EQ(locating.result.match_count, 1);
  EXPECT_EQ(block_of(locating.result.matches[0], blocks), 0);
  EXPECT_LT(locating.result.candidate_count, everywhere.result.candidate_count);
}

TEST(Locate, RefusesBoundsThatAreNone) {
  LocateConfig config;
  EXPECT_EQ(validate(config), Status::kOk);
  config.height_min_mm = 2.0;
  config.height_max_mm = 1.0;
  EXPECT_EQ(validate(config), Status::kInvalidArgument);
  config.height_max_mm = std::nan("");
  EXPECT_EQ(validate(config), Status::kInvalidArgument);
  config = {};
  std::vector<Region> exclusions(1);
  config.exclusions = exclusions;
  EXPECT_EQ(validate(config), Status::kInvalidArgument);  // everything is excluded
  exclusions.assign(kExclusionCountMax + 1, circle(0, 0, 1));
  config.exclusions = exclusions;
  EXPECT_EQ(validate(config), Status::kInvalidArgument);
}

TEST(Locate, TakesNoneThatShowsTooLittle) {
  // About a third of the part lies under something.
  const std::vector<Block> blocks{{test::pose_at(70, 60, 10, 0.2)}};
  std::vector<Block> all = blocks;
  all.push_back({test::pose_at(98, 60, 40, 0.2), 40.0, 60.0});
  const MadeScan scan = test::bin_scan(all);
  Locating locating;
  LocateConfig config;
  config.min_visible = 0.4;
  ASSERT_EQ(locating.run(test::block_part(), scan.view(), config), Status::kOk);
  ASSERT_EQ(locating.result.match_count, 1);
  const Match& m = locating.result.matches[0];
  EXPECT_EQ(block_of(m, blocks), 0);
  EXPECT_GT(m.visible, 0.5);
  EXPECT_LT(m.visible, 0.85);
  EXPECT_GE(m.score, test::block_part().score_threshold);
  config.min_visible = 0.9;
  ASSERT_EQ(locating.run(test::block_part(), scan.view(), config), Status::kOk);
  expect_none(locating.result);
}

TEST(Locate, TakesNoneThatLeansTooFar) {
  const Pose leaning{rotation_from_vector({0.0, 0.42, 0.0}) * rotation_about_z(0.3),
                     {75.0, 60.0, 30.0}};
  const MadeScan scan = test::bin_scan({{leaning}});
  Locating locating;
  LocateConfig config;
  config.max_tilt_rad = 0.6;
  ASSERT_EQ(locating.run(test::block_part(), scan.view(), config), Status::kOk);
  ASSERT_EQ(locating.result.match_count, 1);
  EXPECT_EQ(block_of(locating.result.matches[0], {{leaning}}), 0);
  config.max_tilt_rad = 0.35;
  ASSERT_EQ(locating.run(test::block_part(), scan.view(), config), Status::kOk);
  expect_none(locating.result);
}

TEST(Locate, TakesNoneUnderTheScoreAskedFor) {
  // A quarter of the part is broken off.
  const std::vector<Block> blocks{{test::pose_at(70, 60, 10, 0.2), 40.0, 30.0}};
  const MadeScan scan = test::bin_scan(blocks);
  Locating locating;
  LocateConfig config;
  config.min_score = 0.3;
  ASSERT_EQ(locating.run(test::block_part(), scan.view(), config), Status::kOk);
  ASSERT_EQ(locating.result.match_count, 1);
  EXPECT_GE(locating.result.matches[0].score, 0.3);
  const double score = locating.result.matches[0].score;
  config.min_score = std::min(1.0, score + 0.05);
  ASSERT_EQ(locating.run(test::block_part(), scan.view(), config), Status::kOk);
  expect_none(locating.result);
}

TEST(Locate, FullSymmetryLeavesTheTurnFree) {
  const MadeScan scan(
      150, 120, 1.0,
      [](double x, double y) {
        return (x - 70.2) * (x - 70.2) + (y - 60.7) * (y - 60.7) <= 25.0 * 25.0 ? 10.0 : 0.0;
      },
      0.05);
  Locating locating;
  ASSERT_EQ(locating.run(test::disc_part(25.0, 10.0), scan.view()), Status::kOk);
  ASSERT_EQ(locating.result.match_count, 1);
  const Match& m = locating.result.matches[0];
  EXPECT_TRUE(m.turn_is_free);
  EXPECT_NEAR(m.face_T_object.position_mm.x, 70.2, 0.2);
  EXPECT_NEAR(m.face_T_object.position_mm.y, 60.7, 0.2);
  // Of all equivalents the one whose x is the face's.
  EXPECT_NEAR(m.face_T_object.rotation.m[1], 0.0, 1e-6);
  EXPECT_NEAR(m.face_T_object.rotation.m[0], 1.0, 1e-3);
}

TEST(Locate, SimulatedPairIsFoundTwiceAndAStrangerNot) {
  const sim::SensorConfig sensor = test::noisy_sensor(0.2);
  const auto lesson = test::simulated("single", "bracket", sensor, 5);
  const test::Taught taught = test::taught({test::teach_scan(lesson)});
  ASSERT_EQ(taught.status, Status::kOk) << to_string(taught.status);
  const Pose truth_T_taught =
      lesson.instances[0].scan_T_object.inverse() * taught.part.scan_T_object;
  const auto bracket = std::make_shared<const sim::Part>(sim::catalogue_part("bracket"));
  sim::Scene scene;
  for (const Pose& pose : {test::pose_at(-75, -45, bracket->thickness_mm, 2.0),
                           test::pose_at(70, 55, bracket->thickness_mm, -0.7)}) {
    scene.instances.push_back({bracket, pose});
  }
  const sim::SimulatedScan pair = sim::scan(scene, sensor, 6);
  Locating locating;
  LocateConfig config;
  config.max_matches = 8;
  ASSERT_EQ(locating.run(taught.part, pair.view(), config), Status::kOk);
  ASSERT_EQ(locating.result.match_count, 2);
  for (const sim::SimulatedInstance& instance : pair.instances) {
    const bool found = std::any_of(
        locating.result.matches.begin(), locating.result.matches.begin() + 2, [&](const Match& m) {
          const auto e =
              test::pose_error(m.face_T_object * truth_T_taught.inverse(), instance.scan_T_object);
          return e.in_plane_mm < 1.0 && e.z_mm < 0.3 && e.turn_deg < 1.0 && e.tilt_deg < 1.0;
        });
    EXPECT_TRUE(found);
  }
  for (const char* stranger : {"pad", "plate"}) {
    const auto scan = test::simulated("single", stranger, sensor, 7);
    ASSERT_EQ(locating.run(taught.part, scan.view(), config), Status::kOk);
    EXPECT_EQ(locating.result.match_count, 0) << stranger;
  }
}

}  // namespace
}  // namespace flatpose::locate
