// What teaching refuses, what it warns of, and the memory it needs.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "flatpose/teach/assess.hpp"
#include "flatpose/teach/teacher.hpp"
#include "tests/lib/locate/made_bin.hpp"
#include "tests/lib/locate/simulated.hpp"

namespace flatpose::teach {
namespace {

using test::MadeScan;
using test::Taught;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

MadeScan lone() { return test::bin_scan({{test::pose_at(70, 60, 10, 0.5)}}); }

TeachScan seen(const MadeScan& scan) { return {scan.view(), frames_of_scan(true)}; }

TEST(TeachBounds, RefusesScansThatHoldNoPart) {
  EXPECT_EQ(test::taught({seen(test::bin_scan({}))}).status, Status::kNoPart);
  EXPECT_EQ(test::taught(
                {seen(test::bin_scan({{test::pose_at(35, 40, 10)}, {test::pose_at(110, 70, 10)}}))})
                .status,
            Status::kSeveralParts);
  const MadeScan nothing(150, 120, 1.0, [](double, double) { return test::kLost; });
  EXPECT_EQ(test::taught({seen(nothing)}).status, Status::kTooFewPoints);
}

TEST(TeachBounds, RefusesBadInput) {
  EXPECT_EQ(test::taught({}).status, Status::kInvalidArgument);
  MadeScan infinite = lone();
  infinite.at(3, 3)[2] = kInfinity;
  EXPECT_EQ(test::taught({seen(infinite)}).status, Status::kNotFinite);
  const MadeScan good = lone();
  EXPECT_EQ(test::taught({seen(good), seen(infinite)}).status, Status::kNotFinite);
}

TEST(TeachBounds, RefusesBadConfigs) {
  const MadeScan scan = lone();
  const std::vector<void (*)(TeachConfig&)> bad{
      [](TeachConfig& c) { c.symmetry_order = -1; },
      [](TeachConfig& c) { c.symmetry_order = 65; },
      [](TeachConfig& c) {
        c.origin = {true, kNan, 0.0};
      },
      [](TeachConfig& c) {
        c.x_axis = {true, 1.0, kNan};
      },
      [](TeachConfig& c) {
        c.x_axis = {true, 0.0, 0.0};
      },
      [](TeachConfig& c) {
        c.symmetry_center = {true, kNan, 0.0};
      },
      [](TeachConfig& c) { c.cell_mm = -1.0; },
      [](TeachConfig& c) { c.cell_mm = kNan; },
      [](TeachConfig& c) { c.name.back() = 'x'; },
      [](TeachConfig& c) { c.region.kind = Region::Kind::kCircle; },
      [](TeachConfig& c) {
        c.label_origin_px = {true, 150.0, 5.0};
      },
      [](TeachConfig& c) {
        c.label_origin_px = {true, kNan, 5.0};
      },
      [](TeachConfig& c) {
        c.label_origin_px = {true, 1e300, 5.0};
      },
      [](TeachConfig& c) { c.up = 0; },
  };
  for (std::size_t i = 0; i < bad.size(); ++i) {
    TeachConfig config;
    bad[i](config);
    EXPECT_EQ(test::taught({seen(scan)}, config).status, Status::kInvalidArgument) << i;
  }
}

TEST(TeachBounds, RefusesLabelsOfAnotherSize) {
  const MadeScan scan = lone();
  const std::vector<std::uint8_t> labels(150 * 120, 2);
  TeachConfig config;
  config.labels = {labels.data(), 149, 120, 150};
  EXPECT_EQ(test::taught({seen(scan)}, config).status, Status::kShapeMismatch);
  config.labels = {labels.data(), 150, 119, 150};
  EXPECT_EQ(test::taught({seen(scan)}, config).status, Status::kShapeMismatch);
}

TEST(TeachBounds, RefusesScansBeyondTheLimits) {
  const MadeScan scan = lone();
  EXPECT_EQ(test::taught({seen(scan)}, {}, {149, 120, 100'000}).status, Status::kTooLarge);
  EXPECT_EQ(test::taught({seen(scan)}, {}, {150, 119, 100'000}).status, Status::kTooLarge);
  EXPECT_EQ(test::taught({seen(scan)}, {}, {150, 120, 150 * 110}).status, Status::kTooLarge);
}

TEST(TeachBounds, OneByteLessIsRefused) {
  const locate::Limits limits{150, 120, 20'000};
  std::vector<std::byte> memory(Teacher::required_bytes(limits));
  Teacher teacher;
  EXPECT_EQ(teacher.init(limits, std::span(memory).first(memory.size() - 1)), Status::kOutOfMemory);
  EXPECT_EQ(teacher.init(limits, memory), Status::kOk);
}

TEST(TeachBounds, BadLimitsAreRefused) {
  std::vector<std::byte> memory(100'000'000);
  for (const locate::Limits& limits :
       {locate::Limits{0, 10, 10}, locate::Limits{10, 10, 0}, locate::Limits{10, 10, -5}}) {
    Teacher teacher;
    EXPECT_EQ(teacher.init(limits, memory), Status::kInvalidArgument);
  }
}

TEST(TeachBounds, MemorySufficesToTheByte) {
  // Fields that take every cell of the limits, in memory as badly aligned as can be.
  const struct { int width_px, height_px; } shapes[] = {{90, 60}, {150, 120}, {61, 300}, {300, 61}};
  for (const auto& shape : shapes) {
    const Pose middle = test::pose_at(0.5 * shape.width_px, 0.5 * shape.height_px, 10.0,
                                      shape.width_px < shape.height_px ? 0.5 * kPi : 0.0);
    const MadeScan scan(
        shape.width_px, shape.height_px, 1.0,
        [&](double x, double y) { return test::bin_height({{middle}}, x, y); }, 0.05);
    const locate::Limits limits{shape.width_px, shape.height_px,
                                (shape.width_px + 1) * (shape.height_px + 1)};
    const std::size_t required = Teacher::required_bytes(limits);
    const auto memory = std::make_unique<std::byte[]>(required + 1);
    Teacher teacher;
    ASSERT_EQ(teacher.init(limits, std::span(memory.get() + 1, required)), Status::kOk);
    const TeachScan scans[] = {seen(scan)};
    model::Template part;
    TeachReport report;
    EXPECT_EQ(teacher.teach(scans, {}, part, report), Status::kOk)
        << shape.width_px << " " << shape.height_px;
  }
}

TEST(TeachBounds, LabelsTeachAsTheRegionDoes) {
  const std::vector<test::Block> blocks{{test::pose_at(40, 40, 10, 0.2)},
                                        {test::pose_at(105, 75, 10, 1.0)}};
  const MadeScan scan = test::bin_scan(blocks);
  std::vector<std::uint8_t> labels(150 * 120, 0);
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 150; ++x) {
      std::uint8_t& label = labels[static_cast<std::size_t>(y * 150 + x)];
      if (test::on_rectangle(blocks[1].scan_T_object, 53.0, 33.0, x, y)) label = 1;
      if (test::on_rectangle(blocks[1].scan_T_object, 47.0, 27.0, x, y)) label = 2;
    }
  }
  TeachConfig config;
  config.labels = {labels.data(), 150, 120, 150};
  config.label_origin_px = {true, 100.0, 70.0};
  const Taught t = test::taught({seen(scan)}, config);
  ASSERT_EQ(t.status, Status::kOk) << to_string(t.status);
  EXPECT_NEAR(t.part.scan_T_object.position_mm.x, 100.0, 1e-3);
  EXPECT_NEAR(t.part.scan_T_object.position_mm.y, 70.0, 1e-3);
  EXPECT_NEAR(t.part.scan_T_object.position_mm.z, 10.0, 0.1);
  for (const model::ContourPoint& c : t.part.contour_points()) {
    const Vec3 p = t.part.scan_T_object * Vec3{c.x_mm, c.y_mm, c.z_mm};
    EXPECT_TRUE(test::on_rectangle(blocks[1].scan_T_object, 55.0, 35.0, p.x, p.y));
  }
}

std::uint32_t weakness_of(const MadeScan& scan, const TeachConfig& config = {}) {
  const Taught t = test::taught({seen(scan)}, config);
  EXPECT_EQ(t.status, Status::kOk) << to_string(t.status);
  return t.part.weakness;
}

TEST(Weakness, NamesASymmetryThatIsNotDeclared) {
  TeachConfig config;
  const Taught t = test::taught({seen(lone())}, config);
  ASSERT_EQ(t.status, Status::kOk);
  EXPECT_NE(t.part.weakness & model::kWeakSymmetryLikely, 0U);
  EXPECT_EQ(t.part.symmetry_likely, 2);
  config.symmetry_order = 2;
  EXPECT_EQ(weakness_of(lone(), config) & model::kWeakSymmetryLikely, 0U);
}

TEST(Weakness, NamesATurnThatNothingHolds) {
  const MadeScan disc(
      150, 120, 1.0,
      [](double x, double y) {
        return (x - 70.2) * (x - 70.2) + (y - 60.7) * (y - 60.7) <= 30.0 * 30.0 ? 10.0 : 0.0;
      },
      0.05);
  EXPECT_NE(weakness_of(disc) & model::kWeakDirectionLoose, 0U);
  TeachConfig config;
  config.symmetry_order = model::kFullSymmetry;
  EXPECT_EQ(weakness_of(disc, config) & model::kWeakDirectionLoose, 0U);
}

TEST(Weakness, NamesADirectionThatNothingHolds) {
  // A strip that leaves the field at both ends.
  const MadeScan strip(
      150, 120, 1.0, [](double, double y) { return y > 45.0 && y < 75.0 ? 10.0 : 0.0; }, 0.05);
  TeachConfig config;
  config.region.kind = Region::Kind::kBox;
  config.region.vertex_count = 2;
  config.region.vertex_x_mm[0] = 30.0;
  config.region.vertex_y_mm[0] = 35.0;
  config.region.vertex_x_mm[1] = 120.0;
  config.region.vertex_y_mm[1] = 85.0;
  const Taught t = test::taught({seen(strip)}, config);
  if (t.status == Status::kOk) {
    EXPECT_NE(t.part.weakness & model::kWeakDirectionLoose, 0U);
  }
  EXPECT_TRUE(t.status == Status::kOk || t.status == Status::kNoPart) << to_string(t.status);
}

TEST(Weakness, NamesAPartOfFewCells) {
  const MadeScan small = test::bin_scan({{test::pose_at(75, 60, 10, 0.4), 14.0, 10.0}});
  const Taught t = test::taught({seen(small)});
  if (t.status == Status::kOk) {
    EXPECT_NE(t.part.weakness & model::kWeakSmall, 0U);
  }
  EXPECT_TRUE(t.status == Status::kOk || t.status == Status::kTooFewPoints ||
              t.status == Status::kNoContour)
      << to_string(t.status);
}

// The rest on templates, where each is reached by itself.

model::Template sound_part() {
  model::Template part = test::rectangle_part(60.0, 30.0, 10.0);
  part.symmetry.order = 2;
  return part;
}

TEST(Weakness, SoundPartHasNone) {
  model::Template part = sound_part();
  find_weakness(part);
  EXPECT_EQ(part.weakness, 0U);
}

TEST(Weakness, BitsAreReachedOneByOne) {
  const struct {
    std::uint32_t bit;
    void (*spoil)(model::Template&);
  } cases[] = {
      {model::kWeakSymmetryLikely, [](model::Template& p) { p.symmetry.order = 1; }},
      {model::kWeakStepNearNoise, [](model::Template& p) { p.noise_mm = 5.0; }},
      {model::kWeakSmall, [](model::Template& p) { p.area_mm2 = 100.0; }},
      {model::kWeakDirectionLoose,
       [](model::Template& p) {
         for (model::ContourPoint& c : p.contour) {
           c.ny = c.y_mm > 0.0F ? 1.0F : -1.0F;
           c.nx = 0.0F;
         }
       }},
  };
  for (const auto& c : cases) {
    model::Template part = sound_part();
    c.spoil(part);
    find_weakness(part);
    EXPECT_NE(part.weakness & c.bit, 0U) << c.bit;
  }
}

locate::LocateResult scores(const Pose& self, const std::vector<double>& at_other_places,
                            double self_score, double rival_score = 0.0) {
  locate::LocateResult result;
  locate::Match match;
  match.face_T_object = self;
  match.score = self_score;
  result.matches[result.match_count++] = match;
  for (const double score : at_other_places) {
    match.face_T_object.position_mm.x += 100.0;
    match.score = score;
    result.matches[result.match_count++] = match;
  }
  result.rival_score = rival_score;
  return result;
}

TEST(Threshold, LiesInTheGapBelowThePartAndItsLike) {
  const Pose self = test::pose_at(10, 20, 30);
  model::Template part = sound_part();
  set_threshold(scores(self, {0.95, 0.55, 0.5}, 0.97), self, part);
  EXPECT_EQ(part.self_score, 0.97);
  EXPECT_EQ(part.rival_score, 0.55);
  EXPECT_GT(part.score_threshold, 0.55);
  EXPECT_LT(part.score_threshold, 0.95);
  EXPECT_EQ(part.weakness & model::kWeakMarginThin, 0U);
}

TEST(Threshold, AWideMarginIsNotThin) {
  const Pose self = test::pose_at(10, 20, 30);
  model::Template part = sound_part();
  set_threshold(scores(self, {0.3}, 0.95), self, part);
  EXPECT_EQ(part.weakness & model::kWeakMarginThin, 0U);
  set_threshold(scores(self, {}, 0.95), self, part);
  EXPECT_EQ(part.weakness & model::kWeakMarginThin, 0U);
}

// Scores of its like, of what resembles it only, and of nothing else in the scan.
TEST(Threshold, LetsThroughWhatIsOfTheLikeAndNothingFartherOff) {
  const Pose self = test::pose_at(10, 20, 30);
  model::Template part = sound_part();
  set_threshold(scores(self, {0.90, 0.78}, 1.0), self, part);  // steps of 0.10 and 0.12 are alike
  EXPECT_EQ(part.rival_score, 0.0);
  EXPECT_EQ(part.weakness & model::kWeakMarginThin, 0U);
  set_threshold(scores(self, {0.90, 0.76}, 1.0), self, part);  // one of 0.14 is not
  EXPECT_EQ(part.rival_score, 0.76);
  EXPECT_GT(part.score_threshold, 0.76);
  EXPECT_LT(part.score_threshold, 0.90);
  EXPECT_NE(part.weakness & model::kWeakMarginThin, 0U);
}

TEST(Threshold, StaysWithinBoundsWhateverWasFound) {
  const Pose self = test::pose_at(10, 20, 30);
  for (const double own : {0.0, 0.4, 0.7, 0.9, 1.0}) {
    for (const double other : {0.0, 0.4, 0.7, 0.9, 1.0}) {
      for (const double rival : {0.0, 0.6, 1.0}) {
        model::Template part = sound_part();
        set_threshold(scores(self, {other}, own, rival), self, part);
        EXPECT_GE(part.score_threshold, 0.5);
        EXPECT_GE(part.score_threshold, 0.83 * own);
        EXPECT_LE(part.score_threshold, 0.88);
      }
    }
  }
}

}  // namespace
}  // namespace flatpose::teach
