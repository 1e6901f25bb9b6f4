// The C API: the same answers as the library's own, and nothing a caller hands in is believed.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "flatpose/flatpose.h"
#include "tests/lib/c_api/finder.hpp"
#include "tests/lib/locate/simulated.hpp"

namespace flatpose {
namespace {

using test::c_limits;
using test::c_scan;

/// A finder, a part taught through the API, and scans to look in.
class CApi : public testing::Test {
 protected:
  void SetUp() override {
    part_memory_.resize(flatpose_part_required_bytes());
    const flatpose_scan scan = c_scan(lone_.view());
    const flatpose_scan* const scans[] = {&scan};
    flatpose_teach_config config = FLATPOSE_TEACH_CONFIG_INIT;
    config.name = "pad";
    ASSERT_EQ(flatpose_teach(finder_, scans, 1, &config, part_memory_.data(), part_memory_.size(),
                             &part_),
              FLATPOSE_STATUS_OK);
    ASSERT_NE(part_, nullptr);
  }
  flatpose_status locate(const flatpose_scan& scan, const flatpose_config* config = nullptr,
                         const flatpose_host* host = nullptr) {
    return flatpose_locate(finder_, part_, &scan, config, host, &result_);
  }

  const sim::SimulatedScan lone_ = test::simulated("single", "pad", test::clean_sensor(), 1);
  const sim::SimulatedScan other_ = test::simulated("single", "pad", test::clean_sensor(), 2);
  std::vector<std::byte> part_memory_;
  test::CFinder taught_{true};
  flatpose_finder* const finder_ = taught_.handle;
  flatpose_part* part_ = nullptr;
  flatpose_result result_ = FLATPOSE_RESULT_INIT;
};

TEST_F(CApi, TeachesAndFindsWhatTheLibraryItselfDoes) {
  teach::TeachConfig lesson;
  std::memcpy(lesson.name.data(), "pad", 3);
  const test::Taught taught = test::taught({test::teach_scan(lone_)}, lesson);
  test::Locating locating;
  ASSERT_EQ(locating.run(taught.part, other_.view()), Status::kOk);
  ASSERT_EQ(locating.result.match_count, 1);

  ASSERT_EQ(locate(c_scan(other_.view())), FLATPOSE_STATUS_OK);
  EXPECT_EQ(result_.outcome, FLATPOSE_OUTCOME_OK);
  EXPECT_EQ(result_.digest, locate::digest(locating.result));
  EXPECT_EQ(result_.hypothesis_count, locating.result.hypothesis_count);
  EXPECT_EQ(result_.is_exact, 1);
  flatpose_match match = FLATPOSE_MATCH_INIT;
  ASSERT_EQ(flatpose_match_at(finder_, 0, &match), FLATPOSE_STATUS_OK);
  const locate::Match& same = locating.result.matches[0];
  EXPECT_EQ(match.score, same.score);
  EXPECT_EQ(match.pose.position_mm[2], same.face_T_object.position_mm.z);
  EXPECT_EQ(match.pose.rotation[5], same.face_T_object.rotation.m[5]);
  EXPECT_EQ(match.sigma_deg[1], same.sigma_rad.y * kDegPerRad);
  EXPECT_EQ(flatpose_match_at(finder_, 1, &match), FLATPOSE_STATUS_INVALID_ARGUMENT);
  EXPECT_EQ(flatpose_match_at(finder_, -1, &match), FLATPOSE_STATUS_INVALID_ARGUMENT);
}

TEST_F(CApi, APartGoesThroughItsFile) {
  flatpose_part_info before = FLATPOSE_PART_INFO_INIT, after = FLATPOSE_PART_INFO_INIT;
  ASSERT_EQ(flatpose_part_describe(part_, &before), FLATPOSE_STATUS_OK);
  EXPECT_STREQ(before.name, "pad");
  EXPECT_GT(before.score_threshold, 0.5);
  std::vector<std::byte> file(flatpose_part_file_bytes_max());
  std::size_t size = 0;
  ASSERT_EQ(flatpose_part_save(part_, file.data(), file.size(), &size), FLATPOSE_STATUS_OK);
  std::vector<std::byte> memory(flatpose_part_required_bytes());
  flatpose_part* copy = nullptr;
  ASSERT_EQ(flatpose_part_load(file.data(), size, memory.data(), memory.size(), &copy),
            FLATPOSE_STATUS_OK);
  ASSERT_EQ(flatpose_part_describe(copy, &after), FLATPOSE_STATUS_OK);
  EXPECT_EQ(std::memcmp(&before, &after, sizeof before), 0);

  EXPECT_EQ(flatpose_part_load(file.data(), size - 1, memory.data(), memory.size(), &copy),
            FLATPOSE_STATUS_TRUNCATED);
  EXPECT_EQ(copy, nullptr);
  file[size / 2] ^= std::byte{1};
  EXPECT_EQ(flatpose_part_load(file.data(), size, memory.data(), memory.size(), &copy),
            FLATPOSE_STATUS_BAD_CHECKSUM);
  EXPECT_EQ(flatpose_part_load(file.data(), size, memory.data(), memory.size() - 1, &copy),
            FLATPOSE_STATUS_OUT_OF_MEMORY);
  EXPECT_EQ(flatpose_part_save(part_, file.data(), 10, &size), FLATPOSE_STATUS_OUT_OF_MEMORY);
  EXPECT_EQ(size, 0U);
}

TEST_F(CApi, AWorkPlaneIsTheFrameOfThePose) {
  const flatpose_pose shifted = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {10.0, 20.0, 30.0}};
  flatpose_scan scan = c_scan(other_.view());
  ASSERT_EQ(locate(scan), FLATPOSE_STATUS_OK);
  flatpose_match in_scan = FLATPOSE_MATCH_INIT, in_work = FLATPOSE_MATCH_INIT;
  ASSERT_EQ(flatpose_match_at(finder_, 0, &in_scan), FLATPOSE_STATUS_OK);
  scan.work_T_scan = &shifted;
  ASSERT_EQ(locate(scan), FLATPOSE_STATUS_OK);
  ASSERT_EQ(flatpose_match_at(finder_, 0, &in_work), FLATPOSE_STATUS_OK);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(in_work.pose.position_mm[i] - in_scan.pose.position_mm[i], 10.0 * (i + 1), 0.05);
  }
  flatpose_pose mirrored = shifted;
  mirrored.rotation[0] = -1.0;
  scan.work_T_scan = &mirrored;
  EXPECT_EQ(locate(scan), FLATPOSE_STATUS_INVALID_ARGUMENT);
}

TEST_F(CApi, ARegionBoundsTheOrigin) {
  const flatpose_scan scan = c_scan(other_.view());
  ASSERT_EQ(locate(scan), FLATPOSE_STATUS_OK);
  flatpose_match match = FLATPOSE_MATCH_INIT;
  ASSERT_EQ(flatpose_match_at(finder_, 0, &match), FLATPOSE_STATUS_OK);
  const double x = match.pose.position_mm[0], y = match.pose.position_mm[1];
  const double around[] = {x - 20, y - 20, x + 20, y - 20, x, y + 30};
  flatpose_config config = FLATPOSE_CONFIG_INIT;
  config.region.kind = FLATPOSE_REGION_POLYGON;
  config.region.vertex_count = 3;
  config.region.vertices_xy_mm = around;
  ASSERT_EQ(locate(scan, &config), FLATPOSE_STATUS_OK);
  EXPECT_EQ(result_.match_count, 1);
  const double beside[] = {x + 20, y - 20, x + 60, y + 20};
  config.region.kind = FLATPOSE_REGION_BOX;
  config.region.vertex_count = 2;
  config.region.vertices_xy_mm = beside;
  ASSERT_EQ(locate(scan, &config), FLATPOSE_STATUS_OK);
  EXPECT_EQ(result_.match_count, 0);
  config.region.vertices_xy_mm = nullptr;
  EXPECT_EQ(locate(scan, &config), FLATPOSE_STATUS_INVALID_ARGUMENT);
  config.region.kind = 7;
  EXPECT_EQ(locate(scan, &config), FLATPOSE_STATUS_INVALID_ARGUMENT);
}

/// What the callbacks were asked.
struct Asked {
  int times = 0;
  int chunks = 0;
  int cancels = 0;
  int cancel_at = INT32_MAX;
};

flatpose_host host_of(Asked& asked) {
  flatpose_host host = FLATPOSE_HOST_INIT;
  host.context = &asked;
  host.now_us = [](void* context) -> std::int64_t { return ++static_cast<Asked*>(context)->times; };
  host.parallel_for = [](void* context, std::int32_t count, flatpose_task task, void* of_task) {
    static_cast<Asked*>(context)->chunks += count;
    for (std::int32_t i = count - 1; i >= 0; --i) task(of_task, i);
  };
  host.is_cancelled = [](void* context) -> std::int32_t {
    Asked& a = *static_cast<Asked*>(context);
    return ++a.cancels >= a.cancel_at ? 1 : 0;
  };
  return host;
}

TEST_F(CApi, TimeHandsAndCancelAreTheHosts) {
  const flatpose_scan scan = c_scan(other_.view());
  ASSERT_EQ(locate(scan), FLATPOSE_STATUS_OK);
  const std::uint64_t digest = result_.digest;
  Asked asked;
  const flatpose_host host = host_of(asked);
  ASSERT_EQ(locate(scan, nullptr, &host), FLATPOSE_STATUS_OK);
  EXPECT_EQ(result_.digest, digest);
  EXPECT_GT(asked.chunks, 20);
  EXPECT_GT(asked.cancels, 100);
  EXPECT_GT(result_.total_us, 0);

  flatpose_config config = FLATPOSE_CONFIG_INIT;
  config.deadline_us = 50;  // readings of the clock, here
  ASSERT_EQ(locate(scan, &config, &host), FLATPOSE_STATUS_OK);
  EXPECT_EQ(result_.outcome, FLATPOSE_OUTCOME_DEADLINE);
  EXPECT_EQ(result_.is_exact, 0);
  EXPECT_EQ(result_.bound_gap, 1.0);

  asked = {};
  asked.cancel_at = 100;
  ASSERT_EQ(locate(scan, nullptr, &host), FLATPOSE_STATUS_OK);
  EXPECT_EQ(result_.outcome, FLATPOSE_OUTCOME_CANCELLED);
  EXPECT_EQ(result_.match_count, 0);
  EXPECT_LE(asked.cancels, 110);
}

TEST_F(CApi, NothingOfTheLastSearchIsLeftAfterARefusal) {
  ASSERT_EQ(locate(c_scan(other_.view())), FLATPOSE_STATUS_OK);
  ASSERT_EQ(result_.match_count, 1);
  flatpose_scan broken = c_scan(other_.view());
  broken.z_mm = nullptr;
  EXPECT_EQ(locate(broken), FLATPOSE_STATUS_INVALID_ARGUMENT);
  EXPECT_EQ(result_.match_count, 0);
  flatpose_match match = FLATPOSE_MATCH_INIT;
  EXPECT_EQ(flatpose_match_at(finder_, 0, &match), FLATPOSE_STATUS_INVALID_ARGUMENT);
}

TEST_F(CApi, BadArgumentsAreRefused) {
  const flatpose_scan scan = c_scan(other_.view());
  EXPECT_EQ(flatpose_locate(nullptr, part_, &scan, nullptr, nullptr, &result_),
            FLATPOSE_STATUS_INVALID_ARGUMENT);
  EXPECT_EQ(flatpose_locate(finder_, nullptr, &scan, nullptr, nullptr, &result_),
            FLATPOSE_STATUS_INVALID_ARGUMENT);
  EXPECT_EQ(flatpose_locate(finder_, part_, nullptr, nullptr, nullptr, &result_),
            FLATPOSE_STATUS_INVALID_ARGUMENT);
  EXPECT_EQ(flatpose_locate(finder_, part_, &scan, nullptr, nullptr, nullptr),
            FLATPOSE_STATUS_INVALID_ARGUMENT);
  flatpose_scan bad = scan;
  bad.up = 0;
  EXPECT_EQ(locate(bad), FLATPOSE_STATUS_INVALID_ARGUMENT);
  bad = scan;
  bad.row_stride_bytes += 2;
  EXPECT_EQ(locate(bad), FLATPOSE_STATUS_INVALID_ARGUMENT);
  bad = scan;
  bad.width_px = 301;
  EXPECT_EQ(locate(bad), FLATPOSE_STATUS_TOO_LARGE);
  flatpose_config config = FLATPOSE_CONFIG_INIT;
  config.order = 3;
  EXPECT_EQ(locate(scan, &config), FLATPOSE_STATUS_INVALID_ARGUMENT);
  config = FLATPOSE_CONFIG_INIT;
  config.max_tilt_deg = NAN;
  EXPECT_EQ(locate(scan, &config), FLATPOSE_STATUS_INVALID_ARGUMENT);
  flatpose_teach_config lesson = FLATPOSE_TEACH_CONFIG_INIT;
  const std::string long_name(FLATPOSE_NAME_BYTES, 'x');
  lesson.name = long_name.c_str();
  const flatpose_scan* const scans[] = {&scan};
  EXPECT_EQ(
      flatpose_teach(finder_, scans, 1, &lesson, part_memory_.data(), part_memory_.size(), &part_),
      FLATPOSE_STATUS_INVALID_ARGUMENT);
  EXPECT_EQ(flatpose_teach(finder_, scans, FLATPOSE_TEACH_SCAN_COUNT_MAX + 1, nullptr,
                           part_memory_.data(), part_memory_.size(), &part_),
            FLATPOSE_STATUS_INVALID_ARGUMENT);
}

TEST_F(CApi, StructsOfEarlierCallersAreReadAndOfLaterOnesRefused) {
  const flatpose_scan scan = c_scan(other_.view());
  flatpose_config config = FLATPOSE_CONFIG_INIT;
  config.region.kind = 99;  // beyond what an earlier caller's struct would hold
  config.struct_size = offsetof(flatpose_config, region);
  EXPECT_EQ(locate(scan, &config), FLATPOSE_STATUS_OK);
  config.struct_size = sizeof config + 8;
  EXPECT_EQ(locate(scan, &config), FLATPOSE_STATUS_BAD_VERSION);
  config.struct_size = 0;
  EXPECT_EQ(locate(scan, &config), FLATPOSE_STATUS_INVALID_ARGUMENT);
  // What an earlier caller's result has no room for is not written.
  flatpose_result early = FLATPOSE_RESULT_INIT;
  early.struct_size = offsetof(flatpose_result, bound_gap);
  early.digest = 12345;
  EXPECT_EQ(flatpose_locate(finder_, part_, &scan, nullptr, nullptr, &early), FLATPOSE_STATUS_OK);
  EXPECT_EQ(early.match_count, 1);
  EXPECT_EQ(early.digest, 12345U);
  EXPECT_EQ(early.struct_size, offsetof(flatpose_result, bound_gap));
}

TEST(CApiLimits, SayWhatMemoryIsNeeded) {
  flatpose_limits limits = c_limits();
  const std::size_t bytes = flatpose_required_bytes(&limits);
  ASSERT_GT(bytes, 0U);
  std::vector<std::byte> memory(bytes);
  flatpose_finder* finder = nullptr;
  EXPECT_EQ(flatpose_init(&limits, memory.data(), bytes, &finder), FLATPOSE_STATUS_OK);
  EXPECT_EQ(flatpose_init(&limits, memory.data(), bytes - 1, &finder),
            FLATPOSE_STATUS_OUT_OF_MEMORY);
  EXPECT_EQ(finder, nullptr);
  limits.vector_path = 9;
  EXPECT_EQ(flatpose_required_bytes(&limits), 0U);
  EXPECT_EQ(flatpose_init(&limits, memory.data(), bytes, &finder),
            FLATPOSE_STATUS_INVALID_ARGUMENT);
  limits = c_limits();
  limits.cell_count = 0;
  EXPECT_EQ(flatpose_required_bytes(&limits), 0U);
  EXPECT_EQ(flatpose_required_bytes(nullptr), 0U);
}

TEST(CApiText, NamesWhatThereIs) {
  EXPECT_STREQ(flatpose_status_text(FLATPOSE_STATUS_TRUNCATED), "truncated");
  EXPECT_STREQ(flatpose_outcome_name(FLATPOSE_OUTCOME_EMPTY_SCENE), "empty_scene");
  EXPECT_STREQ(flatpose_outcome_name(77), "unknown");
  EXPECT_GE(flatpose_version(), 100U);
}

}  // namespace
}  // namespace flatpose
