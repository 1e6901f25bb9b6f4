// What the TPDOs tell, against the snapshot that they are made from.

#include "flatpose/can/report.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>
#include <string>

#include "flatpose/can/frame.hpp"

namespace flatpose::can {
namespace {

using Field = ReportField;

job::Snapshot seen(const Vec3& position_mm, const std::array<double, 4>& rotation,
                   Convention convention = Convention::kKukaAbc) {
  job::Snapshot s;
  s.done_number = 9;
  s.result_is_readers = true;
  s.answer = job::Answer::kOk;
  s.bits = job::kDone | job::kValid;
  s.convention = convention;
  s.match.index = 1;
  s.match.part = 2;
  s.match.position_mm = position_mm;
  s.match.rotation = rotation;
  s.match.score = 0.9;
  s.match.visible = 1.0;
  return s;
}

// A field out of the bytes, by the drawing in the header alone.
std::int32_t in_bytes(const Report& report, int tpdo, std::size_t at, std::size_t bytes) {
  const auto data = tpdo_bytes(report, tpdo);
  std::uint32_t raw = 0;
  for (std::size_t i = 0; i < bytes; ++i) raw += static_cast<std::uint32_t>(data[at + i]) << 8 * i;
  return bytes == 3 && raw >= 0x800000 ? static_cast<std::int32_t>(raw) - 0x1000000
                                       : static_cast<std::int32_t>(raw);
}

TEST(CanReport, IsThePoseRoundedToItsScale) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-8388.6, 8388.6);
  std::uniform_real_distribution<double> turn(-6.3, 6.3);
  for (int i = 0; i < 2000; ++i) {
    const auto convention = static_cast<Convention>(i % kConventionCount);
    if (convention == Convention::kAbbQuaternion) continue;
    const Vec3 p{place(random), place(random), place(random)};
    const std::array<double, 4> r{turn(random), turn(random), turn(random), 0};
    const Report report = report_of(seen(p, r, convention), {});
    const double scale = is_euler(convention) ? 0.001 : 1e-6;
    const double unit = is_euler(convention) ? 180.0 / 3.14159265358979323846 : 1.0;
    EXPECT_NEAR(in_bytes(report, 1, 1, 3) * 0.001, p.x, 0.0005001);
    EXPECT_NEAR(in_bytes(report, 1, 4, 3) * 0.001, p.y, 0.0005001);
    EXPECT_NEAR(in_bytes(report, 2, 1, 3) * 0.001, p.z, 0.0005001);
    EXPECT_NEAR(in_bytes(report, 2, 4, 3) * scale, r[0] * unit, 0.50001 * scale);
    EXPECT_NEAR(in_bytes(report, 3, 1, 3) * scale, r[1] * unit, 0.50001 * scale);
    EXPECT_NEAR(in_bytes(report, 3, 4, 3) * scale, r[2] * unit, 0.50001 * scale);
  }
}

TEST(CanReport, SaysWhatDoesNotFitAndNeverWraps) {
  const double inf = std::numeric_limits<double>::infinity();
  for (const double far : {8388.608, -8388.608, 8388.6076, -9000.0, 16777.216, -16777.216, 1e9,
                           -1e9, 1e300, inf, -inf, std::nan("")}) {
    for (int axis = 0; axis < 6; ++axis) {
      Vec3 p{1, 2, 3};
      std::array<double, 4> r{0.1, 0.2, 0.3, 0};
      if (axis < 3) {
        (axis == 0 ? p.x : axis == 1 ? p.y : p.z) = far;
      } else {
        r[static_cast<std::size_t>(axis - 3)] = far;
      }
      const Report report = report_of(seen(p, r), {});
      EXPECT_EQ(report[Field::kStatus], static_cast<int>(job::Answer::kOutOfRange)) << far << axis;
      EXPECT_FALSE(report[Field::kBits] & job::kValid);
      EXPECT_EQ(report[Field::kDoneNumber], 9);
      for (const Field field : {Field::kPositionX, Field::kPositionY, Field::kPositionZ,
                                Field::kRotation1, Field::kRotation2, Field::kRotation3})
        EXPECT_EQ(report[field], kNoneInt24);
      EXPECT_EQ(report[Field::kScore], kNoneUint8);
    }
  }
  const Report edge = report_of(seen({8388.607, -8388.607, 0}, {}), {});
  EXPECT_EQ(in_bytes(edge, 1, 1, 3), 0x7fffff);
  EXPECT_EQ(in_bytes(edge, 1, 4, 3), -0x7fffff);
}

TEST(CanReport, HasNoRoomForAQuaternion) {
  const Report report = report_of(seen({}, {1, 0, 0, 0}, Convention::kAbbQuaternion), {});
  EXPECT_EQ(report[Field::kStatus], static_cast<int>(job::Answer::kOutOfRange));
  EXPECT_FALSE(has_pose(report));
}

TEST(CanReport, HasNoRoomForPartsAndToolsFromTheTwoHundredAndFiftyFifthOn) {
  job::Snapshot s = seen({}, {});
  s.match.part = 254;
  s.match.tool = 253;
  EXPECT_EQ(report_of(s, {})[Field::kPart], 254);
  EXPECT_EQ(in_bytes(report_of(s, {}), 3, 7, 1), 253);
  s.match.part = 255;
  EXPECT_EQ(report_of(s, {})[Field::kStatus], static_cast<int>(job::Answer::kOutOfRange));
  s.match.part = 1;
  s.match.tool = 255;
  EXPECT_EQ(report_of(s, {})[Field::kStatus], static_cast<int>(job::Answer::kOutOfRange));
}

TEST(CanReport, TellsNothingOfAnothersResult) {
  job::Snapshot s = seen({1, 2, 3}, {});
  s.result_is_readers = false;
  s.bits = 0xff;
  const Report report = report_of(s, {12, job::Refusal::kNotOwner});
  EXPECT_FALSE(has_pose(report));
  EXPECT_EQ(report[Field::kDoneNumber], 0);
  EXPECT_EQ(report[Field::kStatus], static_cast<int>(job::Answer::kPending));
  EXPECT_EQ(report[Field::kBits], job::kReady | job::kBusy | job::kError | job::kSimulated);
  EXPECT_EQ(report[Field::kJudgedNumber], 12);
  EXPECT_EQ(report[Field::kRefusedStatus], 3);
}

TEST(CanReport, TheDocumentHasEveryFieldInItsPlace) {
  std::ifstream file(std::string(FLATPOSE_SOURCE_DIR) + "/docs/can.md");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  ASSERT_GT(text.size(), 1000U);
  for (int tpdo = 0; tpdo < kTpdoCount; ++tpdo) {
    int at = 0;
    for (const ReportField field : fields_of_tpdo(tpdo)) {
      const ReportLine& line = line_of(field);
      const std::string row = "| TPDO" + std::to_string(tpdo + 1) + " | " + std::to_string(at) +
                              " | `" + line.name + "` | " + std::to_string(line.bytes) + " | ";
      EXPECT_NE(text.find(row), std::string::npos) << row;
      at += line.bytes;
    }
  }
}

TEST(CanReport, EveryStatusFitsItsByte) {
  for (const job::AnswerText& text : job::answer_texts()) {
    job::Snapshot s = seen({1, 2, 3}, {});
    if (!job::may_have_pose(text.answer)) s.match = {};
    s.answer = text.answer;
    const Report report = report_of(s, {});
    EXPECT_EQ(static_cast<std::int8_t>(in_bytes(report, 0, 1, 1)), static_cast<int>(text.answer));
    EXPECT_EQ(has_pose(report), job::may_have_pose(text.answer));
  }
}

}  // namespace
}  // namespace flatpose::can
