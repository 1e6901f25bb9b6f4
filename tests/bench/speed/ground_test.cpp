#include "bench/speed/ground.hpp"

#include <gtest/gtest.h>

#include "bench/scenes/lesson.hpp"
#include "bench/speed/block_sums.hpp"
#include "bench/speed/whole_sums.hpp"
#include "port/linux/cpu/vector_path.hpp"

namespace flatpose::bench {
namespace {

const model::Template& pad() {
  static const Taught taught = teach_part("pad", {}, std::array<std::uint64_t, 1>{9001});
  return taught.part;
}

GroundConfig small() {
  GroundConfig config;
  config.places_per_side = 100;
  config.angle_count = 20;
  config.point_count = 12;
  return config;
}

TEST(Ground, HoldsEveryHypothesisOnceWhenTheGateIsOpen) {
  const auto ground = make_ground(small(), pad());
  EXPECT_EQ(ground->angle_count(), 20);
  EXPECT_EQ(ground->hypothesis_count(), 100 * 100 * 20);
  EXPECT_EQ(ground->evaluation_count(), 100.0 * 100 * 20 * 12);
  GroundConfig gated = small();
  gated.is_gated = true;
  const auto planar = make_ground(gated, pad());
  EXPECT_LT(planar->hypothesis_count(), ground->hypothesis_count());
  EXPECT_GT(planar->hypothesis_count(), 0);
  const ThesisGround thesis = make_thesis_ground(*planar);
  const auto left_out =
      std::count(thesis.images.tilt.begin(), thesis.images.tilt.end(), thesis::kNoHypothesis);
  EXPECT_EQ(100 * 100 - left_out, planar->places.place_count);
}

TEST(Ground, RepeatsItsSceneBeyondTheField) {
  GroundConfig config = small();
  config.places_per_side = 300;
  config.angle_count = 1;
  const auto repeated = make_ground(config, pad());
  EXPECT_EQ(repeated->hypothesis_count(), 300 * 300);
  for (const int x : {0, 17, 59}) {
    EXPECT_EQ(repeated->images.height_unit(x, 40), repeated->images.height_unit(x + 240, 40));
    EXPECT_EQ(repeated->images.edge_cost(3, x, 40), repeated->images.edge_cost(3, x + 240, 280));
  }
}

TEST(BlockSums, AreTheSameOnEveryPathWithAndWithoutEarlyTermination) {
  const auto ground = make_ground(small(), pad());
  BlockSums sums(*ground);
  sums.run(search::search_block_for(VectorPath::kPortable));
  const std::uint64_t digest = sums.digest();
  for (int i = 0; i <= static_cast<int>(port::best_vector_path()); ++i) {
    const auto path = static_cast<VectorPath>(i);
    sums.run(search::search_block_for(path));
    EXPECT_EQ(sums.digest(), digest) << i;
    const search::SearchBlock whole = whole_sums_for(path);
    ASSERT_NE(whole, nullptr) << "the block loop has no form without early termination any more";
    sums.run(whole);
    EXPECT_EQ(sums.digest(), digest) << i;
  }
}

TEST(BlockSums, LoadWhatTheirPointsTake) {
  GroundConfig config = small();
  config.is_level = true;  // one tilt, so that every block is loaded once
  const auto ground = make_ground(config, pad());
  const BlockSums sums(*ground);
  // 100 places are a block of 64, then 36 in three vectors of 16, or two of 32, or one of 64;
  // six contour points of two loads each, six of the surface.
  EXPECT_EQ(sums.loaded_bytes(16), 100.0 * (64 + 48) * 20 * 18);
  EXPECT_EQ(sums.loaded_bytes(32), 100.0 * 128 * 20 * 18);
  EXPECT_EQ(sums.loaded_bytes(64), 100.0 * 128 * 20 * 18);
}

}  // namespace
}  // namespace flatpose::bench
