// Every stage that goes through rows looks at its budget as it goes: once in kRowsPerLook rows of
// each pass, whatever the other stages do.

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "flatpose/image/canny.hpp"
#include "flatpose/image/dark_pit.hpp"
#include "flatpose/image/direction_channels.hpp"
#include "flatpose/image/fill.hpp"
#include "flatpose/rectify/rectify.hpp"
#include "flatpose/rectify/survey.hpp"
#include "flatpose/scene/scene.hpp"
#include "flatpose/search/tilt_field.hpp"
#include "tests/lib/locate/made_scan.hpp"

namespace flatpose {
namespace {

constexpr int kSide_px = 640;
constexpr int kLooksPerPass = kSide_px / kRowsPerLook;

/// Counts its readings; the deadline is struck from the start, or never.
class CountingClock final : public Clock {
 public:
  [[nodiscard]] std::int64_t now_us() const noexcept override { return ++count_, time_us; }
  [[nodiscard]] int count() const noexcept { return count_; }
  std::int64_t time_us = 0;

 private:
  mutable int count_ = 0;
};

/// A floor with a block, and points and a square lost, so that every pass has something to do.
test::MadeScan made_scan() {
  return {kSide_px, kSide_px, 1.0, [](double x, double y) {
            const bool is_lost = (static_cast<int>(x) * 7 + static_cast<int>(y) * 13) % 101 == 0 ||
                                 (x > 300.0 && x < 330.0 && y > 300.0 && y < 330.0);
            if (is_lost) return test::kLost;
            return x > 100.0 && x < 500.0 && y > 100.0 && y < 500.0 ? 20.0 : 0.0;
          }};
}

/// What the stages read and write.
struct Ground {
  test::MadeScan scan = made_scan();
  std::vector<std::byte> memory = std::vector<std::byte>(200'000'000);
  Arena arena{memory};
  rectify::Grid grid;
  scene::Scene scene;
  std::span<image::EdgePoint> edge_memory;
  image::OctantImage distances;
  search::TiltField tilt;

  Ground() {
    grid.width_px = kSide_px;
    grid.height_px = kSide_px;
    scene = scene::take_scene(arena, grid, edge_memory);
    distances.cells = arena.take_image<image::OctantCell>(kSide_px, kSide_px);
    tilt = search::take_tilt_field(arena, kSide_px, kSide_px);
    EXPECT_FALSE(arena.failed());
  }

  Status paint(rectify::Method method, const Budget& budget) {
    rectify::RectifyConfig config;
    config.method = method;
    config.paint.max_gap_mm = 3.0;
    config.paint.jump_mm = 2.0;
    return rectify::rectify(scan.view(), {}, config, arena, scene.map, budget);
  }
  Status fill(const Budget& budget) {
    return image::fill_missing(scene.map.height_mm, scene.filled_mm, scene.missing, arena,
                               VectorPath::kPortable, budget);
  }
  Status lower(const Budget& budget) {
    return image::lower_dark_pits({}, arena, scene.missing, scene.filled_mm, VectorPath::kPortable,
                                  budget);
  }
  Status detect(const Budget& budget) {
    const Result<int> count =
        image::detect_edges(scene.filled_mm, scene.missing, 1.0, {}, arena, scene.edge_kind,
                            edge_memory, VectorPath::kPortable, budget);
    if (count) scene.edges = edge_memory.first(static_cast<std::size_t>(*count));
    return count.status();
  }
};

struct Stage {
  std::string name;
  int pass_count;
  std::function<Status(Ground&, const Budget&)> run;
};

/// In the order of the data: each reads what those before it have written.
std::vector<Stage> stages() {
  using rectify::Method;
  return {
      {"survey", 1,
       [](Ground& g, const Budget& b) {
         return rectify::survey(g.scan.view(), {}, g.arena, VectorPath::kPortable, b).status();
       }},
      {"bucket", 3, [](Ground& g, const Budget& b) { return g.paint(Method::kBucket, b); }},
      {"paint", 2, [](Ground& g, const Budget& b) { return g.paint(Method::kPaint, b); }},
      {"fill", 2, [](Ground& g, const Budget& b) { return g.fill(b); }},
      {"dark pits", 5, [](Ground& g, const Budget& b) { return g.lower(b); }},
      {"edges", 1, [](Ground& g, const Budget& b) { return g.detect(b); }},
      {"distances", 2,
       [](Ground& g, const Budget& b) {
         return image::edge_distances(g.scene.edges, {}, g.distances, VectorPath::kPortable, b);
       }},
      {"tilt", 1,
       [](Ground& g, const Budget& b) {
         return search::fit_tilt_field(g.scene.filled_mm, 1.0, 3, g.arena, g.tilt, 1,
                                       VectorPath::kPortable, b);
       }},
  };
}

TEST(Looks, ComeInEveryPassOfEveryStage) {
  Ground ground;
  for (const Stage& stage : stages()) {
    const CountingClock clock;
    ASSERT_EQ(stage.run(ground, Budget(clock, 1)), Status::kOk) << stage.name;
    EXPECT_GE(clock.count(), stage.pass_count * kLooksPerPass) << stage.name;
  }
}

TEST(Looks, OneThatFindsTheTimeUpEndsAStage) {
  Ground ground;
  for (const Stage& stage : stages()) {
    CountingClock late;
    late.time_us = 1;
    EXPECT_EQ(stage.run(ground, Budget(late, 1)), Status::kStopped) << stage.name;
    EXPECT_EQ(late.count(), 1) << stage.name;
    ASSERT_EQ(stage.run(ground, Budget()), Status::kOk) << stage.name;  // the next reads it
  }
}

}  // namespace
}  // namespace flatpose
