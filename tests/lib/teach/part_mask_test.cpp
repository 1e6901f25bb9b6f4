// Which cells are the part, on scans drawn by hand.

#include "flatpose/teach/part_mask.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "tests/lib/locate/made_bin.hpp"

namespace flatpose::teach {
namespace {

using test::MadeScan;
using test::MadeScene;

constexpr int kWidth_px = 150;
constexpr int kHeight_px = 120;

struct Masked {
  Status status = Status::kNoPart;
  std::vector<std::byte> memory;
  PartMask mask;
  [[nodiscard]] bool at(int x, int y) const { return mask.is_part(x, y) != 0; }
};

Masked masked(const MadeScene& made, const Region& region = {}) {
  Masked out;
  Arena measuring = Arena::measuring();
  (void)take_part_mask(measuring, made.scene.map.grid);
  reserve_mask_scratch(measuring, made.scene.map.grid);
  out.memory.resize(measuring.required_bytes());
  Arena arena{std::span(out.memory)};
  out.mask = take_part_mask(arena, made.scene.map.grid);
  out.status = find_part(made.scene, frames_of_scan(true), region, arena, out.mask);
  return out;
}

Masked masked(const test::HeightOf& height_of, const Region& region = {}) {
  const MadeScene made(MadeScan(kWidth_px, kHeight_px, 1.0, height_of, 0.02));
  return masked(made, region);
}

Region box(double x0, double y0, double x1, double y1) {
  Region region;
  region.kind = Region::Kind::kBox;
  region.vertex_count = 2;
  region.vertex_x_mm[0] = x0;
  region.vertex_y_mm[0] = y0;
  region.vertex_x_mm[1] = x1;
  region.vertex_y_mm[1] = y1;
  return region;
}

bool inside(double x, double y, double x0, double y0, double x1, double y1) {
  return x >= x0 && x <= x1 && y >= y0 && y <= y1;
}

using Shape = std::function<bool(double, double)>;

bool is_near_border(const Shape& shape, int x, int y) {
  constexpr int kMargin_px = 3;
  for (int dy = -kMargin_px; dy <= kMargin_px; ++dy) {
    for (int dx = -kMargin_px; dx <= kMargin_px; ++dx) {
      if (shape(x + dx, y + dy) != shape(x, y)) return true;
    }
  }
  return false;
}

/// Every cell three cells away from the part's outline, and from edges on it, is on the right side.
void expect_mask(
    const Masked& m, const Shape& is_part,
    const Shape& has_edge_on_it = [](double, double) { return false; }) {
  ASSERT_EQ(m.status, Status::kOk) << to_string(m.status);
  int wrong_count = 0;
  int count = 0;
  for (int y = 0; y < kHeight_px; ++y) {
    for (int x = 0; x < kWidth_px; ++x) {
      count += m.at(x, y) ? 1 : 0;
      if (is_near_border(is_part, x, y) || is_near_border(has_edge_on_it, x, y)) continue;
      if (m.at(x, y) != is_part(x, y)) ++wrong_count;
    }
  }
  EXPECT_EQ(wrong_count, 0);
  EXPECT_EQ(count, m.mask.cell_count);
}

bool plate(double x, double y) { return inside(x, y, 40, 35, 110, 85); }

TEST(PartMask, TakesTheLonePartOnAFloor) {
  const Masked m = masked([](double x, double y) { return plate(x, y) ? 8.0 : 0.0; });
  expect_mask(m, plate);
  EXPECT_FALSE(m.mask.lies_below);
  int contour_count = 0;
  for (int y = 0; y < kHeight_px; ++y)
    for (int x = 0; x < kWidth_px; ++x) contour_count += m.mask.is_contour(x, y) != 0 ? 1 : 0;
  EXPECT_NEAR(contour_count, 2 * (70 + 50), 40);
}

TEST(PartMask, TakesThePartInALooseRegion) {
  const auto scene = [](double x, double y) {
    if (inside(x, y, 5, 5, 30, 100)) return 12.0;  // another part outside of the region
    return plate(x, y) ? 8.0 : 0.0;
  };
  expect_mask(masked(scene, box(34, 28, 118, 92)), plate);
}

TEST(PartMask, ARegionWithinALargerSurfaceIsItselfThePart) {
  const Region region = box(60, 50, 90, 70);
  expect_mask(masked([](double x, double y) { return plate(x, y) ? 8.0 : 0.0; }, region),
              [](double x, double y) { return inside(x, y, 60, 50, 90, 70); });
}

bool in_hole(double x, double y) {
  return (x - 75) * (x - 75) + (y - 60) * (y - 60) <= 12.0 * 12.0;
}

TEST(PartMask, AHoleThatShowsTheFloorIsNotThePart) {
  expect_mask(masked([](double x, double y) { return plate(x, y) && !in_hole(x, y) ? 8.0 : 0.0; }),
              [](double x, double y) { return plate(x, y) && !in_hole(x, y); });
}

TEST(PartMask, AHoleHalfInShadowIsNotThePart) {
  expect_mask(masked([](double x, double y) {
                if (in_hole(x, y)) return y > 58.0 ? test::kLost : 0.0;
                return plate(x, y) ? 8.0 : 0.0;
              }),
              [](double x, double y) { return plate(x, y) && !in_hole(x, y); });
}

TEST(PartMask, ARecessBelongsToThePart) {
  const auto scene = [](double x, double y) {
    if (in_hole(x, y)) return 5.0;
    return plate(x, y) ? 8.0 : 0.0;
  };
  expect_mask(masked(scene), plate, in_hole);
  expect_mask(masked(scene, box(30, 25, 120, 95)), plate, in_hole);
}

TEST(PartMask, WhatStandsOnThePartBelongsToIt) {
  const auto scene = [](double x, double y) {
    if (in_hole(x, y)) return 11.0;
    return plate(x, y) ? 8.0 : 0.0;
  };
  expect_mask(masked(scene), plate, in_hole);
  expect_mask(masked(scene, box(30, 25, 120, 95)), plate, in_hole);
}

bool left(double x, double y) { return inside(x, y, 20, 30, 60, 80); }
bool right(double x, double y) { return inside(x, y, 85, 30, 125, 80); }

TEST(PartMask, TwoPartsNeedARegion) {
  const auto scene = [](double x, double y) { return left(x, y) || right(x, y) ? 8.0 : 0.0; };
  EXPECT_EQ(masked(scene).status, Status::kSeveralParts);
  expect_mask(masked(scene, box(14, 24, 66, 86)), left);
  expect_mask(masked(scene, box(79, 24, 131, 86)), right);
}

TEST(PartMask, ACrumbIsNoSecondPart) {
  expect_mask(masked([](double x, double y) {
                return left(x, y) || inside(x, y, 100, 50, 110, 60) ? 8.0 : 0.0;
              }),
              left);
}

TEST(PartMask, NothingIsNoPart) {
  EXPECT_EQ(masked([](double, double) { return 0.0; }).status, Status::kNoPart);
  EXPECT_EQ(masked([](double x, double) { return 0.1 * x; }).status, Status::kNoPart);
}

TEST(PartMask, ARegionOutsideOfTheScanHoldsNone) {
  EXPECT_EQ(
      masked([](double x, double y) { return plate(x, y) ? 8.0 : 0.0; }, box(500, 500, 600, 600))
          .status,
      Status::kNoPart);
}

TEST(PartMask, TellsAPartThatLiesBelowItsSurroundings) {
  const Masked m =
      masked([](double x, double y) { return plate(x, y) ? -8.0 : 0.0; }, box(30, 25, 120, 95));
  if (m.status == Status::kOk) {
    EXPECT_TRUE(m.mask.lies_below);
  }
  EXPECT_TRUE(m.status == Status::kOk || m.status == Status::kNoPart);
  RecordProperty("below", to_string(m.status));
}

TEST(PartMask, ReportsTooLittleMemory) {
  const MadeScene made(MadeScan(kWidth_px, kHeight_px, 1.0,
                                [](double x, double y) { return plate(x, y) ? 8.0 : 0.0; }));
  Masked m = masked(made);
  std::vector<std::byte> little(m.memory.size() / 3);
  Arena arena{std::span(little)};
  EXPECT_EQ(find_part(made.scene, frames_of_scan(true), {}, arena, m.mask), Status::kOutOfMemory);
}

/// Labels as a user would paint them: a brush of three pixels along the contour.
std::vector<std::uint8_t> painted(const std::function<bool(double, double)>& is_part) {
  std::vector<std::uint8_t> labels(kWidth_px * kHeight_px, 0);
  for (int y = 0; y < kHeight_px; ++y) {
    for (int x = 0; x < kWidth_px; ++x) {
      bool border = false;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) border |= is_part(x + dx, y + dy) != is_part(x, y);
      Label label = is_part(x, y) ? Label::kSurface : Label::kNone;
      if (border) label = Label::kEdge;
      labels[static_cast<std::size_t>(y * kWidth_px + x)] = static_cast<std::uint8_t>(label);
    }
  }
  return labels;
}

TEST(PartMask, LabelsSayWhatIsThePart) {
  const MadeScene made(MadeScan(kWidth_px, kHeight_px, 1.0, [](double x, double y) {
    return left(x, y) || right(x, y) ? 8.0 : 0.0;
  }));
  Masked m = masked(made);
  const std::vector<std::uint8_t> labels = painted(right);
  const ImageView<const std::uint8_t> view{labels.data(), kWidth_px, kHeight_px, kWidth_px};
  m.status = mask_from_labels(made.scene, view, m.mask);
  expect_mask(m, right);
  for (int y = 0; y < kHeight_px; ++y)
    for (int x = 0; x < 70; ++x) EXPECT_EQ(m.mask.is_contour(x, y), 0);
}

TEST(PartMask, LabelsWithoutSurfaceOrContourAreRefused) {
  const MadeScene made(MadeScan(kWidth_px, kHeight_px, 1.0,
                                [](double x, double y) { return plate(x, y) ? 8.0 : 0.0; }));
  Masked m = masked(made);
  std::vector<std::uint8_t> labels(kWidth_px * kHeight_px, 0);
  const ImageView<const std::uint8_t> view{labels.data(), kWidth_px, kHeight_px, kWidth_px};
  EXPECT_EQ(mask_from_labels(made.scene, view, m.mask), Status::kNoPart);
  labels = painted(plate);
  for (std::uint8_t& label : labels) label = label == 1 ? 0 : label;
  const ImageView<const std::uint8_t> no_edges{labels.data(), kWidth_px, kHeight_px, kWidth_px};
  EXPECT_EQ(mask_from_labels(made.scene, no_edges, m.mask), Status::kNoContour);
}

}  // namespace
}  // namespace flatpose::teach
