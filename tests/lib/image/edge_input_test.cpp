#include <limits>

#include "tests/lib/image/edge_fixture.hpp"

namespace flatpose::image {
namespace {

TEST(EdgeMap, MapsSmallerThanTheWindowsGiveNoEdges) {
  for (int h = 1; h <= 8; ++h) {
    for (int w = 1; w <= 8; ++w) {
      EdgeConfig config;
      config.crease_low_rad = config.crease_high_rad = 0.2F;
      const Edges edges = edges_of(random_image(w, h, static_cast<unsigned>(9 * w + h)), config);
      for (const EdgePoint& e : edges.points) {
        EXPECT_TRUE(e.column > 0 && e.row > 0 && e.column < w - 1 && e.row < h - 1);
      }
    }
  }
}

TEST(EdgeMap, AMapWithNothingInItHasNoEdges) {
  EXPECT_TRUE(edges_of(Image<float>(30, 20, kMissing)).points.empty());
}

TEST(EdgeMap, WildHeightsAreReadSafely) {
  Image<float> z = random_image(40, 40, 1);
  const float wild[] = {std::numeric_limits<float>::max(),
                        -std::numeric_limits<float>::max(),
                        std::numeric_limits<float>::infinity(),
                        kMissing,
                        1e-40F,
                        1e20F,
                        -1e38F};
  for (int i = 0; i < 200; ++i) z((i * 17) % 40, (i * 7 + i / 40) % 40) = wild[i % 7];
  EdgeConfig config;
  config.crease_low_rad = config.crease_high_rad = 0.2F;
  (void)edges_of(z, config);  // filled first
  Image<std::uint8_t> missing(40, 40);
  Image<std::uint8_t> kinds(40, 40);
  std::vector<EdgePoint> out(1600);
  Arena measuring = Arena::measuring();
  reserve_edge_scratch(measuring, 40, 40);
  std::vector<std::byte> memory(measuring.required_bytes());
  Arena arena{std::span(memory)};
  EXPECT_TRUE(detect_edges(z.view(), missing.view(), 1.0, config, arena, kinds.view(), out));
}

class EdgeInput : public ::testing::Test {
 protected:
  EdgeInput()
      : z_(Image<float>::of(30, 20, [](int x, int) { return x < 15 ? 9.0F : 0.0F; })),
        missing_(30, 20),
        kinds_(30, 20),
        out_(600) {
    Arena measuring = Arena::measuring();
    reserve_edge_scratch(measuring, 30, 20);
    memory_.resize(measuring.required_bytes());
  }
  Status run(const EdgeConfig& config = {}, double cell_mm = 1.0) {
    Arena arena{std::span(memory_)};
    const Result<int> count =
        detect_edges(z_.view(), missing_.view(), cell_mm, config, arena, kinds_.view(), out_);
    return count.status();
  }
  Image<float> z_;
  Image<std::uint8_t> missing_;
  Image<std::uint8_t> kinds_;
  std::vector<EdgePoint> out_;
  std::vector<std::byte> memory_;
};

TEST_F(EdgeInput, TooLittleScratchIsReportedAtEverySize) {
  EXPECT_EQ(run(), Status::kOk);
  const std::vector<std::byte> enough = memory_;
  for (std::size_t size = 0; size + 2 * Arena::kAlignmentBytes < enough.size(); size += 61) {
    memory_.assign(size, std::byte{0});
    EXPECT_EQ(run(), Status::kOutOfMemory) << size;
  }
}

TEST_F(EdgeInput, TooManyEdgesAreReportedAndTheFirstKept) {
  out_.resize(18);
  EXPECT_EQ(run(), Status::kOk);
  out_.assign(17, EdgePoint{});
  EXPECT_EQ(run(), Status::kTooLarge);
  EXPECT_EQ(out_[16].row, 17);
  EXPECT_EQ(kinds_(14, 18), 1);
}

TEST_F(EdgeInput, FieldsOutsideTheirRangesAreRefused) {
  const auto refused = [&](EdgeConfig config) { return run(config) == Status::kInvalidArgument; };
  EXPECT_TRUE(refused({0.0F, 3.0F, 0.0F, 0.0F}));
  EXPECT_TRUE(refused({3.0F, 2.0F, 0.0F, 0.0F}));
  EXPECT_TRUE(refused({NAN, 3.0F, 0.0F, 0.0F}));
  EXPECT_TRUE(refused({2.0F, NAN, 0.0F, 0.0F}));
  EXPECT_TRUE(refused({2.0F, INFINITY, 0.0F, 0.0F}));
  EXPECT_TRUE(refused({2.0F, 3.0F, 0.0F, 0.3F}));
  EXPECT_TRUE(refused({2.0F, 3.0F, 0.3F, 0.2F}));
  EXPECT_TRUE(refused({2.0F, 3.0F, 0.3F, 1.6F}));
  EXPECT_TRUE(refused({2.0F, 3.0F, NAN, NAN}));
  EXPECT_EQ(run({}, 0.0), Status::kInvalidArgument);
  EXPECT_EQ(run({}, NAN), Status::kInvalidArgument);
  missing_ = Image<std::uint8_t>(29, 20);
  EXPECT_EQ(run(), Status::kShapeMismatch);
}

TEST_F(EdgeInput, SidesBeyondSixteenBitsAreRefused) {
  z_ = Image<float>(32768, 1);
  missing_ = Image<std::uint8_t>(32768, 1);
  kinds_ = Image<std::uint8_t>(32768, 1);
  EXPECT_EQ(run(), Status::kTooLarge);
}

}  // namespace
}  // namespace flatpose::image
