// Every form of the block loop on the images of whole scans, real and simulated: there evidence
// hangs together, costs are low and most blocks end early, which random images do not show.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "flatpose/rectify/survey.hpp"
#include "port/linux/files/scan.hpp"
#include "port/sim/simulate.hpp"
#include "tests/lib/scene/made_scene.hpp"
#include "tests/lib/search/made_parts.hpp"
#include "tests/lib/search/search_ground.hpp"
#include "tests/lib/search/slow_block.hpp"
#include "tests/lib/search/vector_paths.hpp"

namespace flatpose::search {
namespace {

std::filesystem::path data_folder() {
  const char* folder = std::getenv("FLATPOSE_REAL_DATA");
  return folder != nullptr ? folder : FLATPOSE_REAL_DATA_DEFAULT;
}

template <class AnyScan>
scene::Built built(const AnyScan& scan, bool z_is_up, double cell_mm) {
  const Frames frames = frames_of_scan(z_is_up);
  rectify::Scan copy(scan.width_px, scan.height_px);
  copy.xyz_mm = scan.xyz_mm;
  rectify::Scratch scratch(rectify::survey_required_bytes());
  const auto survey = rectify::survey(copy.view(), frames.work_T_scan, scratch.arena);
  EXPECT_TRUE(survey);
  const auto grid = rectify::choose_grid(*survey, {.cell_mm = cell_mm});
  EXPECT_TRUE(grid);
  scene::SceneConfig config;
  config.noise_mm = std::max(0.05, survey->noise_sigma_mm);
  config.pitch_mm = survey->pitch_along_row_mm;
  return scene::Built(copy, config, frames, *grid);
}

Block block_of(const Places& places, const PlaceBlock& from) {
  Block block;
  block.column = from.column;
  block.row = from.row;
  block.wanted_bin = from.bin;
  const std::size_t first = places.index(from.column, from.row);
  std::copy_n(places.height_unit.begin() + first, kBlockSize, block.place_unit.begin());
  std::copy_n(places.bin.begin() + first, kBlockSize, block.bin.begin());
  return block;
}

/// All blocks of all bins; how many hypotheses cost less than the cut-off is given back.
int compare_all_blocks(const SearchGround& ground, const model::Template& part, int angle_count) {
  int found_count = 0;
  const Places& places = ground.places;
  for (std::size_t bin = 0; bin < kBinCount; ++bin) {
    if (places.bin_begin[bin] == places.bin_begin[bin + 1]) continue;
    std::vector<ProjectedTemplate> angles;
    for (int i = 0; i < angle_count; ++i) {
      angles.push_back(project(part, part.anchors[0], slope_x_of_bin(static_cast<int>(bin)),
                               slope_y_of_bin(static_cast<int>(bin)), kPi * i / angle_count,
                               ground.images, {}));
    }
    const auto turned = all_shifted(angles, ground.images);
    for (int i = places.bin_begin[bin]; i < places.bin_begin[bin + 1]; ++i) {
      Block block = block_of(places, places.blocks[static_cast<std::size_t>(i)]);
      block.cutoff = static_cast<std::uint8_t>(cost_max(ground.images, angles[0]) * 6 / 10);
      const BlockBest slow = slow_block(ground.images, block, angles);
      for (const VectorPath path : vector_paths()) {
        const BlockBest fast = fast_block(ground.images, block, turned, path);
        EXPECT_EQ(fast.cost, slow.cost) << testing::PrintToString(path);
        EXPECT_EQ(fast.angle, slow.angle) << testing::PrintToString(path);
        if (testing::Test::HasFailure()) return 0;
      }
      for (const std::uint8_t angle : slow.angle[0])
        found_count += angle != kNoAngle && angle != BlockBest::kUntouched ? 1 : 0;
    }
  }
  return found_count;
}

void compare_every_way(const scene::Scene& scene, const model::Template& part) {
  SearchImagesConfig with_heights{2, 60};
  with_heights.height_tolerance_mm = 1.5;
  SearchImagesConfig as_the_thesis = with_heights;
  as_the_thesis.stride_px = 3;
  as_the_thesis.use_height = as_the_thesis.use_directions = false;
  for (const SearchImagesConfig& config : {with_heights, as_the_thesis}) {
    const SearchGround ground(scene, config);
    EXPECT_GT(ground.places.place_count, 500);
    EXPECT_GT(compare_all_blocks(ground, part, 18), 100);
  }
}

TEST(ScanBlockSearch, EqualsTheScalarCostOnARealScan) {
  if (!std::filesystem::is_directory(data_folder())) {
    const char* ci = std::getenv("CI");
    ASSERT_FALSE(ci != nullptr && std::string(ci) == "true") << "no real scans";
    GTEST_SKIP() << "no real scans in " << data_folder();
  }
  const port::Scan scan = port::read_scan(data_folder() / "sick_shapes/shapes.pcd");
  const scene::Built scene = built(scan, scan.up == port::Up::kPlusZ, 0.4);
  ASSERT_EQ(scene.status, Status::kOk);
  compare_every_way(scene.scene, *plate(31.0, 5.7));
}

TEST(ScanBlockSearch, EqualsTheScalarCostOnASimulatedScan) {
  sim::SensorConfig sensor;
  sensor.columns = 300;
  sensor.rows = 250;
  sim::SceneConfig config;
  config.scene = "medium";
  const scene::Built scene = built(sim::simulate(config, sensor, 5), true, 1.5);
  ASSERT_EQ(scene.status, Status::kOk);
  compare_every_way(scene.scene, *plate(80.0, 50.0));
}

}  // namespace
}  // namespace flatpose::search
