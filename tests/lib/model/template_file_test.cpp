#include "flatpose/model/template_file.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <string_view>

#include "tests/lib/model/made_template.hpp"

namespace flatpose::model {
namespace {

void expect_same_head(const Template& a, const Template& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.symmetry.order, b.symmetry.order);
  EXPECT_EQ(a.symmetry.center_x_mm, b.symmetry.center_x_mm);
  EXPECT_EQ(a.symmetry.center_y_mm, b.symmetry.center_y_mm);
  EXPECT_EQ(a.cell_mm, b.cell_mm);
  EXPECT_EQ(a.pitch_mm, b.pitch_mm);
  EXPECT_EQ(a.noise_mm, b.noise_mm);
  EXPECT_EQ(a.step_mm, b.step_mm);
  EXPECT_EQ(a.area_mm2, b.area_mm2);
  EXPECT_EQ(a.radius_mm, b.radius_mm);
  EXPECT_EQ(a.score_threshold, b.score_threshold);
  EXPECT_EQ(a.self_score, b.self_score);
  EXPECT_EQ(a.rival_score, b.rival_score);
  EXPECT_EQ(a.scan_T_object.rotation.m, b.scan_T_object.rotation.m);
  EXPECT_EQ(a.scan_T_object.position_mm, b.scan_T_object.position_mm);
  EXPECT_EQ(a.up, b.up);
  EXPECT_EQ(a.frame, b.frame);
  EXPECT_EQ(a.weakness, b.weakness);
  EXPECT_EQ(a.symmetry_likely, b.symmetry_likely);
}

template <class Point>
void expect_same_points(std::span<const Point> a, std::span<const Point> b) {
  ASSERT_EQ(a.size(), b.size());
  // No padding in a point: equal bytes are equal fields, a field left out of the file is seen.
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size_bytes()), 0);
}

void expect_round_trip(const Template& part) {
  const std::vector<std::byte> bytes = bytes_of(part);
  const auto back = std::make_unique<Template>();
  ASSERT_EQ(read_template(bytes, *back), Status::kOk);
  expect_same_head(part, *back);
  expect_same_points(part.contour_points(), back->contour_points());
  expect_same_points(part.surface_points(), back->surface_points());
  expect_same_points(std::span<const Anchor>(part.anchors), std::span<const Anchor>(back->anchors));
  EXPECT_EQ(part.anchor_count, back->anchor_count);
  EXPECT_EQ(bytes_of(*back), bytes) << "what is read writes the same bytes again";
}

TEST(TemplateFile, GivesEveryFieldBack) { expect_round_trip(*made_template(5, 4, 3)); }

TEST(TemplateFile, GivesTheSmallestAndTheLargestTemplateBack) {
  expect_round_trip(*made_template(1, 3, kAnchorCountMax));
  const auto full = made_template(kContourPointCountMax, kSurfacePointCountMax, kAnchorCountMax);
  expect_round_trip(*full);
  EXPECT_LE(bytes_of(*full).size(), kTemplateFileBytesMax);
}

TEST(TemplateFile, LeavesNothingOfTheTemplateThatWasThereBefore) {
  const auto reused = made_template(40, 30, 3);
  const auto small = made_template(2, 3, 1);
  ASSERT_EQ(read_template(bytes_of(*small), *reused), Status::kOk);
  EXPECT_EQ(bytes_of(*reused), bytes_of(*small));
  EXPECT_EQ(reused->contour[2].x_mm, ContourPoint{}.x_mm);
  EXPECT_EQ(reused->anchors[1].clearance_mm, Anchor{}.clearance_mm);
}

// The format is a promise to files that exist. When this fails on purpose, raise
// kTemplateFileVersion.
TEST(TemplateFile, HasTheBytesItAlwaysHad) {
  const std::vector<std::byte> bytes = bytes_of(*made_template());
  Fnv1a64 all;
  all.add(std::span<const std::byte>(bytes));
  EXPECT_EQ(kTemplateFileVersion, 2U);
  EXPECT_EQ(bytes.size(), 554U);
  EXPECT_EQ(all.value(), 0x7661AE6D0C75F51EULL);
}

TEST(TemplateFile, IsLittleEndianFromTheFirstByte) {
  const std::vector<std::byte> bytes = bytes_of(*made_template());
  const auto at = [&](std::size_t i) { return std::to_integer<unsigned>(bytes.at(i)); };
  EXPECT_EQ(std::memcmp(bytes.data(), "FPT\n", 4), 0);
  EXPECT_EQ(at(4), kTemplateFileVersion);
  EXPECT_EQ(at(5) | at(6) | at(7), 0U);
  EXPECT_EQ(at(8) | at(9) << 8U | at(10) << 16U | at(11) << 24U, bytes.size() - kHeaderBytes);
  EXPECT_EQ(std::memcmp(bytes.data() + kHeaderBytes, "pad \xC3\xA4", 7), 0);
  // After 64 bytes of name: the order 4 in 32 bits, then 1.25 = 0x3FF4000000000000.
  const std::size_t order = kHeaderBytes + 64;
  EXPECT_EQ(at(order), 4U);
  EXPECT_EQ(at(order + 1) | at(order + 2) | at(order + 3), 0U);
  EXPECT_EQ(at(order + 4 + 7), 0x3FU);
  EXPECT_EQ(at(order + 4 + 6), 0xF4U);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(at(order + 4 + i), 0U);
}

TEST(TemplateFile, FailsInABufferOfOneByteTooFewAndFitsAnExactOne) {
  const auto part = made_template();
  const std::vector<std::byte> bytes = bytes_of(*part);
  for (std::size_t size_bytes = 0; size_bytes < bytes.size(); ++size_bytes) {
    std::vector<std::byte> buffer(size_bytes);  // ASan watches its end
    EXPECT_EQ(write_template(*part, buffer).status(), Status::kOutOfMemory) << size_bytes;
  }
  std::vector<std::byte> exact(bytes.size());
  const Result<std::size_t> written = write_template(*part, exact);
  ASSERT_TRUE(written);
  EXPECT_EQ(*written, bytes.size());
  EXPECT_EQ(exact, bytes);
}

TEST(TemplateFile, IsNotWrittenOfATemplateThatCouldNotBeReadBack) {
  auto part = made_template();
  part->cell_mm = 0.0;
  std::vector<std::byte> buffer(kTemplateFileBytesMax, std::byte{0xA5});
  EXPECT_EQ(write_template(*part, buffer).status(), Status::kInvalidArgument);
  for (const std::byte b : buffer) ASSERT_EQ(b, std::byte{0xA5}) << "nothing was written";
}

}  // namespace
}  // namespace flatpose::model
