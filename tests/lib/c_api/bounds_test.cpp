// Exclusions, heights and picks through the C API: as the library has them, held against what is
// known of a made scan.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "flatpose/locate/sigma.hpp"
#include "flatpose/model/template_file.hpp"
#include "tests/lib/c_api/finder.hpp"
#include "tests/lib/locate/made_bin.hpp"
#include "tests/lib/locate/simulated.hpp"

namespace flatpose {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

flatpose_region circle(double x_mm, double y_mm, double radius_mm) {
  return {FLATPOSE_REGION_CIRCLE, x_mm, y_mm, radius_mm, 0, nullptr};
}

/// Three blocks of a part that looks alike after half a turn, at three heights.
class CApiBounds : public testing::Test {
 protected:
  CApiBounds() {
    std::vector<std::byte> file(flatpose_part_file_bytes_max());
    const auto bytes = model::write_template(test::block_part(), file);
    EXPECT_TRUE(bytes);
    EXPECT_EQ(model::read_template({file.data(), *bytes}, known_), Status::kOk);
    EXPECT_EQ(
        flatpose_part_load(file.data(), *bytes, part_memory_.data(), part_memory_.size(), &part_),
        FLATPOSE_STATUS_OK);
    config_.max_matches = 5;
  }
  flatpose_status locate() {
    const flatpose_scan scan = test::c_scan(scan_.view());
    return flatpose_locate(finder_.handle, part_, &scan, &config_, nullptr, &result_);
  }
  /// The blocks that matches lie on, in the order of the blocks.
  [[nodiscard]] std::vector<int> found() {
    EXPECT_EQ(locate(), FLATPOSE_STATUS_OK);
    std::vector<int> on;
    for (int i = 0; i < 3; ++i) {
      const Vec3& p = blocks_[static_cast<std::size_t>(i)].scan_T_object.position_mm;
      for (int m = 0; m < result_.match_count; ++m) {
        const flatpose_pose pose = match(m).pose;
        const double* at = pose.position_mm;
        if (std::hypot(at[0] - p.x, at[1] - p.y, at[2] - p.z) < 1.0) on.push_back(i);
      }
    }
    EXPECT_EQ(on.size(), static_cast<std::size_t>(result_.match_count));
    return on;
  }
  [[nodiscard]] flatpose_match match(int index) const {
    flatpose_match match = FLATPOSE_MATCH_INIT;
    EXPECT_EQ(flatpose_match_at(finder_.handle, index, &match), FLATPOSE_STATUS_OK);
    return match;
  }
  /// The library itself, asked for the same.
  [[nodiscard]] const locate::LocateResult& own(const locate::LocateConfig& config) {
    EXPECT_EQ(own_.run(known_, scan_.view(), config), Status::kOk);
    return own_.result;
  }
  [[nodiscard]] const Vec3& place(std::size_t block) const {
    return blocks_[block].scan_T_object.position_mm;
  }

  const std::vector<test::Block> blocks_ = test::three_blocks();
  const test::MadeScan scan_ = test::bin_scan(blocks_);
  test::CFinder finder_;
  std::vector<std::byte> part_memory_ = std::vector<std::byte>(flatpose_part_required_bytes());
  flatpose_part* part_ = nullptr;
  model::Template known_;
  test::Locating own_;
  flatpose_config config_ = FLATPOSE_CONFIG_INIT;
  flatpose_result result_ = FLATPOSE_RESULT_INIT;
};

TEST_F(CApiBounds, AreTheLibrarysOwn) {
  EXPECT_EQ(found(), (std::vector<int>{0, 1, 2}));
  // One of each kind: the first block, half of the second's surface but not its origin, the third.
  const double around[] = {place(0).x - 9, place(0).y - 9, place(0).x + 9, place(0).y + 9};
  const double beside[] = {place(1).x + 2,  place(1).y - 20, place(1).x + 30,
                           place(1).y - 20, place(1).x + 2,  place(1).y + 20};
  const flatpose_region exclusions[] = {{FLATPOSE_REGION_BOX, 0, 0, 0, 2, around},
                                        {FLATPOSE_REGION_POLYGON, 0, 0, 0, 3, beside},
                                        circle(place(2).x, place(2).y, 12.0)};
  std::array<Region, 3> same;
  same[0].kind = Region::Kind::kBox;
  same[1].kind = Region::Kind::kPolygon;
  same[2].kind = Region::Kind::kCircle;
  for (const int i : {0, 1}) {
    const auto at = static_cast<std::size_t>(i);
    same[at].vertex_count = exclusions[i].vertex_count;
    for (int v = 0; v < same[at].vertex_count; ++v) {
      same[at].vertex_x_mm[v] = exclusions[i].vertices_xy_mm[2 * v];
      same[at].vertex_y_mm[v] = exclusions[i].vertices_xy_mm[2 * v + 1];
    }
  }
  same[2].x_mm = place(2).x;
  same[2].y_mm = place(2).y;
  same[2].radius_mm = 12.0;
  locate::LocateConfig wanted;
  wanted.max_matches = 5;
  config_.exclusions = exclusions;
  for (const std::size_t count : {3U, 2U, 1U}) {
    config_.exclusion_count = static_cast<std::int32_t>(count);
    wanted.exclusions = std::span(same).first(count);
    EXPECT_EQ(found(), count == 3 ? std::vector<int>{1} : (std::vector<int>{1, 2}));
    const locate::LocateResult& expected = own(wanted);
    EXPECT_EQ(result_.digest, locate::digest(expected));
    EXPECT_EQ(result_.evaluated_count, expected.evaluated_count);
    EXPECT_EQ(result_.rival_score, expected.rival_score);
    EXPECT_EQ(result_.best_rejected_score, expected.best_rejected_score);
  }
  config_.exclusion_count = 0;  // then the pointer is not looked at
  EXPECT_EQ(found(), (std::vector<int>{0, 1, 2}));

  config_.height_min_mm = wanted.height_min_mm = 13.0;
  config_.height_max_mm = wanted.height_max_mm = 19.0;
  wanted.exclusions = {};
  EXPECT_EQ(found(), (std::vector<int>{0, 1, 2}));  // heights are not looked at unless there are
  config_.has_heights = 1;
  EXPECT_EQ(found(), std::vector<int>{2});
  EXPECT_EQ(result_.digest, locate::digest(own(wanted)));
  config_.height_min_mm = -kInfinity;
  EXPECT_EQ(found(), (std::vector<int>{0, 2}));
  config_.height_min_mm = config_.height_max_mm = 40.0;
  EXPECT_EQ(found(), std::vector<int>{});
  EXPECT_EQ(result_.outcome, FLATPOSE_OUTCOME_NO_MATCH);
}

TEST_F(CApiBounds, ThatAreNoneAreRefused) {
  const auto refused = [&] {
    result_.match_count = 99;
    const bool is_refused = locate() == FLATPOSE_STATUS_INVALID_ARGUMENT;
    return is_refused && result_.match_count == 0;
  };
  std::vector<flatpose_region> exclusions(FLATPOSE_EXCLUSION_COUNT_MAX + 1, circle(500, 0, 1));
  config_.exclusions = exclusions.data();
  for (const std::int32_t count : {FLATPOSE_EXCLUSION_COUNT_MAX + 1, INT32_MAX, -1}) {
    config_.exclusion_count = count;
    EXPECT_TRUE(refused()) << count;
  }
  config_.exclusion_count = FLATPOSE_EXCLUSION_COUNT_MAX;
  EXPECT_EQ(locate(), FLATPOSE_STATUS_OK);
  const flatpose_region bad[] = {
      {FLATPOSE_REGION_ALL, 0, 0, 0, 0, nullptr},  // everything is excluded
      {9, 0, 0, 1, 0, nullptr},
      {FLATPOSE_REGION_POLYGON, 0, 0, 0, 3, nullptr},
      circle(0, 0, 0),
      circle(kNan, 0, 1),
      circle(0, kInfinity, 1)};
  for (const flatpose_region& region : bad) {
    exclusions[FLATPOSE_EXCLUSION_COUNT_MAX - 1] = region;
    EXPECT_TRUE(refused()) << region.kind;
  }
  config_.exclusions = nullptr;
  EXPECT_TRUE(refused());

  config_ = FLATPOSE_CONFIG_INIT;
  config_.has_heights = 1;
  config_.height_min_mm = 5.0;
  config_.height_max_mm = 4.0;
  EXPECT_TRUE(refused());
  config_.height_max_mm = kNan;
  EXPECT_TRUE(refused());
  config_.height_min_mm = kNan;
  config_.height_max_mm = 4.0;
  EXPECT_TRUE(refused());
  config_.height_min_mm = 4.0;
  EXPECT_EQ(locate(), FLATPOSE_STATUS_OK);
}

TEST_F(CApiBounds, EarlierCallersHaveNone) {
  config_.exclusion_count = 99;  // whatever lies behind their struct
  config_.has_heights = 1;
  config_.height_min_mm = kNan;
  config_.struct_size = offsetof(flatpose_config, exclusion_count);
  EXPECT_EQ(found(), (std::vector<int>{0, 1, 2}));
  flatpose_result early = FLATPOSE_RESULT_INIT;
  early.struct_size = offsetof(flatpose_result, rival_score);
  early.rival_score = 7.0;
  const flatpose_scan scan = test::c_scan(scan_.view());
  EXPECT_EQ(flatpose_locate(finder_.handle, part_, &scan, &config_, nullptr, &early),
            FLATPOSE_STATUS_OK);
  EXPECT_EQ(early.rival_score, 7.0);
  EXPECT_EQ(early.digest, result_.digest);
}

Pose pose_of(const flatpose_pose& from) {
  Pose pose;
  for (std::size_t i = 0; i < 9; ++i) pose.rotation.m[i] = from.rotation[i];
  pose.position_mm = {from.position_mm[0], from.position_mm[1], from.position_mm[2]};
  return pose;
}

void expect_same(const Pose& a, const Pose& b) {
  for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(a.rotation.m[i], b.rotation.m[i], 1e-12);
  EXPECT_NEAR(norm(a.position_mm - b.position_mm), 0.0, 1e-9);
}

/// 20 mm along the part's x, z into the surface, x turned by 30 degrees.
flatpose_pick leaning_pick() {
  const Pose pose{rotation_from_vector({kPi, 0, 0}) * rotation_about_z(kPi / 6), {20.0, -3.0, 1.5}};
  flatpose_pick pick = FLATPOSE_PICK_INIT;
  for (std::size_t i = 0; i < 9; ++i) pick.object_T_pick.rotation[i] = pose.rotation.m[i];
  pick.object_T_pick.position_mm[0] = pose.position_mm.x;
  pick.object_T_pick.position_mm[1] = pose.position_mm.y;
  pick.object_T_pick.position_mm[2] = pose.position_mm.z;
  return pick;
}

TEST_F(CApiBounds, APickIsToldWithItsOwnSigma) {
  ASSERT_EQ(found().size(), 3U);
  const locate::LocateResult& expected = own([] {
    locate::LocateConfig config;
    config.max_matches = 5;
    return config;
  }());
  const flatpose_pick pick = leaning_pick();
  const flatpose_pick origin = FLATPOSE_PICK_INIT;
  for (int i = 0; i < 3; ++i) {
    const flatpose_match whole = match(i);
    flatpose_match told = FLATPOSE_MATCH_INIT;
    ASSERT_EQ(flatpose_pick_at(finder_.handle, i, &origin, &told), FLATPOSE_STATUS_OK);
    expect_same(pose_of(told.pose), pose_of(whole.pose));
    ASSERT_EQ(flatpose_pick_at(finder_.handle, i, &pick, &told), FLATPOSE_STATUS_OK);
    expect_same(pose_of(told.pose), pose_of(whole.pose) * pose_of(pick.object_T_pick));
    const locate::Match& own_match = expected.matches[static_cast<std::size_t>(i)];
    const locate::Sigma sigma = locate::sigma_of(own_match, pose_of(pick.object_T_pick));
    EXPECT_NEAR(told.sigma_mm[1], sigma.mm.y, 1e-12);
    EXPECT_NEAR(told.sigma_deg[2], sigma.rad.z * kDegPerRad, 1e-12);
    EXPECT_GT(std::hypot(told.sigma_mm[0], told.sigma_mm[1], told.sigma_mm[2]),
              std::hypot(whole.sigma_mm[0], whole.sigma_mm[1], whole.sigma_mm[2]));
    EXPECT_EQ(told.score, whole.score);
    EXPECT_EQ(told.surface_rms_mm, whole.surface_rms_mm);
  }
}

TEST_F(CApiBounds, APreferredAngleChoosesAmongTheEquivalents) {
  ASSERT_EQ(found().size(), 3U);
  flatpose_pick pick = leaning_pick();
  const Pose half_turn{rotation_about_z(kPi), {}};
  for (int i = 0; i < 3; ++i) {
    const Pose first = pose_of(match(i).pose) * pose_of(pick.object_T_pick);
    const Pose second = pose_of(match(i).pose) * half_turn * pose_of(pick.object_T_pick);
    for (const double angle_deg : {-360.0, -100.0, 0.0, 45.0, 80.0, 170.0, 360.0}) {
      const Vec3 towards{std::cos(angle_deg * kRadPerDeg), std::sin(angle_deg * kRadPerDeg), 0.0};
      const bool is_first =
          dot(first.rotation.column(0), towards) > dot(second.rotation.column(0), towards);
      pick.has_preferred_angle = 1;
      pick.preferred_angle_deg = angle_deg;
      flatpose_match told = FLATPOSE_MATCH_INIT;
      ASSERT_EQ(flatpose_pick_at(finder_.handle, i, &pick, &told), FLATPOSE_STATUS_OK);
      expect_same(pose_of(told.pose), is_first ? first : second);
    }
  }
}

TEST_F(CApiBounds, PicksThatAreNoneAreRefused) {
  ASSERT_EQ(found().size(), 3U);
  flatpose_match told = FLATPOSE_MATCH_INIT;
  const auto status_of = [&](auto&& change) {
    flatpose_pick pick = FLATPOSE_PICK_INIT;
    change(pick);
    return flatpose_pick_at(finder_.handle, 0, &pick, &told);
  };
  EXPECT_EQ(status_of([](flatpose_pick&) {}), FLATPOSE_STATUS_OK);
  const flatpose_pick pick = FLATPOSE_PICK_INIT;
  for (const int index : {-1, 3})
    EXPECT_EQ(flatpose_pick_at(finder_.handle, index, &pick, &told),
              FLATPOSE_STATUS_INVALID_ARGUMENT);
  EXPECT_EQ(flatpose_pick_at(nullptr, 0, &pick, &told), FLATPOSE_STATUS_INVALID_ARGUMENT);
  EXPECT_EQ(flatpose_pick_at(finder_.handle, 0, nullptr, &told), FLATPOSE_STATUS_INVALID_ARGUMENT);
  EXPECT_EQ(flatpose_pick_at(finder_.handle, 0, &pick, nullptr), FLATPOSE_STATUS_INVALID_ARGUMENT);
  EXPECT_EQ(status_of([](flatpose_pick& p) { p.struct_size = 0; }),
            FLATPOSE_STATUS_INVALID_ARGUMENT);
  EXPECT_EQ(status_of([](flatpose_pick& p) { p.struct_size += 8; }), FLATPOSE_STATUS_BAD_VERSION);
  EXPECT_EQ(status_of([](flatpose_pick& p) { p.object_T_pick.rotation[0] = -1.0; }),
            FLATPOSE_STATUS_INVALID_ARGUMENT);  // a mirror
  EXPECT_EQ(status_of([](flatpose_pick& p) { p.object_T_pick.rotation[4] = kNan; }),
            FLATPOSE_STATUS_INVALID_ARGUMENT);
  EXPECT_EQ(status_of([](flatpose_pick& p) { p.object_T_pick.position_mm[1] = kNan; }),
            FLATPOSE_STATUS_NOT_FINITE);
  for (const double angle_deg : {kNan, kInfinity, -360.1, 360.1}) {
    const auto preferred = [&](flatpose_pick& p) {
      p.has_preferred_angle = 1;
      p.preferred_angle_deg = angle_deg;
    };
    EXPECT_EQ(status_of(preferred), FLATPOSE_STATUS_INVALID_ARGUMENT) << angle_deg;
    const auto unasked = [&](flatpose_pick& p) { p.preferred_angle_deg = angle_deg; };
    EXPECT_EQ(status_of(unasked), FLATPOSE_STATUS_OK) << angle_deg;
  }
}

}  // namespace
}  // namespace flatpose
