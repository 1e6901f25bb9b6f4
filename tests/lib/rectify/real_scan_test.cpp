// Scans of a real sensor, looked for in FLATPOSE_REAL_DATA.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <string>

#include "flatpose/rectify/rectify.hpp"
#include "tests/lib/rectify/scan_fixture.hpp"

namespace flatpose::rectify {
namespace {

/// Binary PCD of x y z float32 and nothing else; empty when the file is not there.
std::unique_ptr<Scan> read_pcd(const std::string& name) {
  const char* const folder = std::getenv("FLATPOSE_REAL_DATA");
  std::ifstream file(std::string(folder ? folder : FLATPOSE_REAL_DATA_DEFAULT) + "/" + name,
                     std::ios::binary);
  int width_px = 0, height_px = 0;
  for (std::string line; std::getline(file, line) && line != "DATA binary";) {
    std::sscanf(line.c_str(), "WIDTH %d", &width_px);
    std::sscanf(line.c_str(), "HEIGHT %d", &height_px);
  }
  if (width_px * height_px == 0) return nullptr;
  auto scan = std::make_unique<Scan>(width_px, height_px);
  file.read(reinterpret_cast<char*>(scan->xyz_mm.data()),
            static_cast<std::streamsize>(scan->xyz_mm.size() * sizeof(float)));
  return file ? std::move(scan) : nullptr;
}

/// For looking at by eye: heights between two limits as grey, missing cells black.
void write_pgm(const Map& map, double low_mm, double high_mm, const std::string& name) {
  const char* const folder = std::getenv("FLATPOSE_TEST_PICTURES");
  if (folder == nullptr) return;
  std::ofstream file(std::string(folder) + "/" + name, std::ios::binary);
  file << "P5 " << map.map.grid.width_px << " " << map.map.grid.height_px << " 255\n";
  for (const float z_mm : map.heights_mm) {
    const double grey = 30 + 225 * (static_cast<double>(z_mm) - low_mm) / (high_mm - low_mm);
    file.put(std::isnan(z_mm) ? '\0'
                              : static_cast<char>(static_cast<int>(std::clamp(grey, 30.0, 255.0))));
  }
}

struct Rectified {
  Survey survey;
  std::unique_ptr<Map> map;
};

Rectified rectify_real(const Scan& scan, double cell_mm, Method method) {
  const Pose work_T_scan = looking_down(400.0);
  Scratch survey_scratch(survey_required_bytes());
  Rectified out;
  out.survey = *survey(scan.view(), work_T_scan, survey_scratch.arena);
  const Grid grid = *choose_grid(out.survey, {.cell_mm = cell_mm});
  out.map = std::make_unique<Map>(grid);
  Scratch scratch(required_bytes(method, scan.width_px, scan.height_px, grid));
  const RectifyConfig config{method, paint_config_for(out.survey)};
  EXPECT_EQ(rectify(scan.view(), work_T_scan, config, scratch.arena, out.map->map), Status::kOk);
  return out;
}

/// Share of missing cells in a box of the work frame.
double missing_share(const Map& map, double x0, double y0, double x1, double y1) {
  int missing = 0, count = 0;
  for (int row = 0; row < map.map.grid.height_px; ++row) {
    for (int column = 0; column < map.map.grid.width_px; ++column) {
      const double x = map.map.grid.x_of(column), y = map.map.grid.y_of(row);
      if (x < x0 || x > x1 || y < y0 || y > y1) continue;
      ++count;
      missing += map.seen(column, row) ? 0 : 1;
    }
  }
  EXPECT_GT(count, 100);
  return static_cast<double>(missing) / count;
}

class RealScan : public testing::TestWithParam<double> {
 protected:
  std::unique_ptr<Scan> scan(const std::string& name) {
    auto found = read_pcd(name);
    EXPECT_TRUE(found || std::getenv("CI") == nullptr) << "no real scans in CI";
    return found;
  }
};

TEST_P(RealScan, OfShapesHasNoHolesInItsBasePlate) {
  const auto shapes = scan("sick_shapes/shapes.pcd");
  if (!shapes) GTEST_SKIP();
  const Rectified result = rectify_real(*shapes, GetParam(), Method::kPaint);
  EXPECT_NEAR(result.survey.pitch_along_row_mm, 0.21585, 2e-4);
  EXPECT_NEAR(result.survey.pitch_along_column_mm, 0.20882, 2e-4);
  EXPECT_NEAR(result.survey.noise_sigma_mm, 0.045, 0.015);
  write_pgm(*result.map, result.survey.min_mm.z, result.survey.max_mm.z,
            "shapes_" + std::to_string(GetParam()) + ".pgm");
  // Clear of parts and shadows; y of the work frame is minus the scan's.
  const auto x = [](double column) { return -73.94 + 0.21585 * column; };
  const auto y = [](double row) { return -0.20882 * row; };
  EXPECT_EQ(missing_share(*result.map, x(230), y(410), x(340), y(310)), 0.0);
  // A bar's top lies 4.95 mm above the plate.
  const Grid& grid = result.map->map.grid;
  const auto height_mm = [&](double column, double row) {
    return static_cast<double>(
        result.map->height_mm(static_cast<int>(std::lround(grid.column_of(x(column)))),
                              static_cast<int>(std::lround(grid.row_of(y(row))))));
  };
  EXPECT_NEAR(height_mm(244, 116) - height_mm(280, 360), 4.95, 0.35);
}

TEST_P(RealScan, OfDiscHasNoHolesInItsPlate) {
  for (const char* const name : {"disc_teach", "disc_match"}) {
    const auto disc = scan("sick_disc/" + std::string(name) + ".pcd");
    if (!disc) GTEST_SKIP();
    const Rectified result = rectify_real(*disc, GetParam(), Method::kPaint);
    write_pgm(*result.map, result.survey.min_mm.z, result.survey.max_mm.z,
              name + ("_" + std::to_string(GetParam())) + ".pgm");
    EXPECT_NEAR(result.survey.noise_sigma_mm, 0.07, 0.02);
    if (name == std::string("disc_teach")) {
      EXPECT_EQ(missing_share(*result.map, -45, -66, -5, -46), 0.0);
    }
  }
}

TEST_P(RealScan, IsSeenAlikeByBothMethods) {
  const auto shapes = scan("sick_shapes/shapes.pcd");
  if (!shapes) GTEST_SKIP();
  const Rectified painted = rectify_real(*shapes, GetParam(), Method::kPaint);
  const Rectified sorted = rectify_real(*shapes, GetParam(), Method::kBucket);
  int both = 0, alike = 0;
  for (std::size_t i = 0; i < painted.map->heights_mm.size(); ++i) {
    const float a_mm = painted.map->heights_mm[i], b_mm = sorted.map->heights_mm[i];
    if (std::isnan(a_mm) || std::isnan(b_mm)) continue;
    ++both;
    alike += std::fabs(a_mm - b_mm) < 0.3F ? 1 : 0;
  }
  EXPECT_GT(alike, 0.95 * both);
}

INSTANTIATE_TEST_SUITE_P(Cells, RealScan, testing::Values(0.25, 1.0),
                         [](const auto& test) { return test.param < 1.0 ? "Quarter" : "One"; });

}  // namespace
}  // namespace flatpose::rectify
