#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/lib/scene/made_scene.hpp"

namespace flatpose::scene {
namespace {

Status built_in(std::size_t size_bytes, const Scan& scan, const SceneConfig& config) {
  rectify::Scratch memory(size_bytes);
  Scene scene;
  return build_scene(scan.view(), frames_of_scan(true), made_grid(), config, memory.arena, scene);
}

TEST(SceneInput, FailsInTooLittleMemoryAndFitsIntoWhatWasMeasured) {
  const Surroundings s;
  const Scan scan = scan_of(Box{}, s);
  const std::size_t enough_bytes = scene_bytes(scan, made_grid());
  Arena kept = Arena::measuring();
  std::span<image::EdgePoint> edges;
  (void)take_scene(kept, made_grid(), edges);
  for (const auto method : {rectify::Method::kPaint, rectify::Method::kBucket}) {
    const SceneConfig config = config_for(s, method);
    EXPECT_EQ(built_in(enough_bytes, scan, config), Status::kOk);
    for (std::size_t size_bytes = 0; size_bytes < enough_bytes; size_bytes += 4096) {
      const Status status = built_in(size_bytes, scan, config);
      const bool refused = status == Status::kOutOfMemory;
      EXPECT_TRUE(refused || status == Status::kOk) << to_string(status);
      if (size_bytes < kept.used_bytes()) {
        EXPECT_TRUE(refused) << size_bytes;
      }
    }
  }
}

TEST(SceneInput, KeepsWhatTakeSceneTakesAndGivesTheRestBack) {
  const Surroundings s;
  const Built built(scan_of(Box{}, s), config_for(s));
  Arena kept = Arena::measuring();
  std::span<image::EdgePoint> edges;
  (void)take_scene(kept, made_grid(), edges);
  EXPECT_EQ(built.memory.arena.used_bytes(), kept.used_bytes());
  EXPECT_GE(edges.size() + 96U * 76U / kCellsPerEdge, built.scene.edges.size());
}

TEST(SceneInput, OfAScanWithNothingInItSaysSo) {
  const Surroundings s;
  Scan scan = scan_of(Box{}, s);
  for (int r = 0; r < scan.height_px; ++r) {
    for (int c = 0; c < scan.width_px; ++c) scan.lose(c, r);
  }
  EXPECT_EQ(Built(scan, config_for(s)).status, Status::kTooFewPoints);
  EXPECT_EQ(Built(scan, config_for(s, rectify::Method::kBucket)).status, Status::kTooFewPoints);
}

TEST(SceneInput, AGridBesideTheScanSeesNothing) {
  const Surroundings s;
  rectify::Grid grid = made_grid();
  grid.x0_mm = 5000.0;
  EXPECT_EQ(Built(scan_of(Box{}, s), config_for(s), frames_of_scan(true), grid).status,
            Status::kTooFewPoints);
}

TEST(SceneInput, PointsThatAreNotFiniteAreMissing) {
  const Surroundings s;
  Scan lost = scan_of(Box{}, s);
  Scan infinite = lost;
  for (int i = 20; i < 40; ++i) {
    lost.lose(i, 60);
    const double bad = std::numeric_limits<double>::infinity();
    infinite.set(i, 60, {i % 3 == 0 ? bad : 1.0, i % 3 == 1 ? -bad : 1.0, i % 3 == 2 ? bad : 1.0});
  }
  for (const auto method : {rectify::Method::kPaint, rectify::Method::kBucket}) {
    const Built a(lost, config_for(s, method));
    const Built b(infinite, config_for(s, method));
    ASSERT_EQ(a.status, Status::kOk);
    ASSERT_EQ(b.status, Status::kOk);
    for (int y = 0; y < a.scene.missing.height_px; ++y) {
      for (int x = 0; x < a.scene.missing.width_px; ++x) {
        ASSERT_EQ(a.scene.missing(x, y), b.scene.missing(x, y));
        ASSERT_EQ(a.scene.filled_mm(x, y), b.scene.filled_mm(x, y));
      }
    }
  }
}

TEST(SceneInput, NumbersThatMakeNoSenseAreRefused) {
  const Surroundings s;
  const Scan scan = scan_of(Box{}, s);
  for (const double bad : {0.0, -1.0, std::nan("")}) {
    SceneConfig config = config_for(s);
    config.noise_mm = bad;
    EXPECT_EQ(Built(scan, config).status, Status::kInvalidArgument) << "noise " << bad;
    config = config_for(s);
    config.pitch_mm = bad;
    EXPECT_EQ(Built(scan, config).status, Status::kInvalidArgument) << "pitch " << bad;
  }
}

// A field of needles: every fifth cell and more is a contour, which no part is.
TEST(SceneInput, MoreEdgesThanAnyContourHasAreTooMany) {
  Scan scan(100, 80);
  for (int r = 0; r < 80; ++r) {
    for (int c = 0; c < 100; ++c) scan.set(c, r, {1.0 * c, 1.0 * r, (c / 3) % 2 == 0 ? 9.0 : 0.0});
  }
  SceneConfig config;
  const Built built(scan, config);
  EXPECT_EQ(built.status, Status::kTooLarge);
}

}  // namespace
}  // namespace flatpose::scene
