// The whole result's frame, against the snapshot that it is made from.

#include "flatpose/can/fd_report.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>
#include <string>

#include "flatpose/can/frame.hpp"
#include "flatpose/result_map/registers.hpp"
#include "flatpose/result_map/table.hpp"

namespace flatpose::can {
namespace {

constexpr double kDeg = 180.0 / 3.14159265358979323846;

job::Snapshot seen(const Vec3& position_mm, const std::array<double, 4>& rotation,
                   Convention convention = Convention::kKukaAbc) {
  job::Snapshot s;
  s.done_number = 0x1234;
  s.result_is_readers = true;
  s.answer = job::Answer::kOk;
  s.bits = job::kDone | job::kValid;
  s.convention = convention;
  s.frame = job::FrameName::kRobot;
  s.session_id = 0xbeef;
  s.has_scan = true;
  s.age_ms = 0x01020304;
  s.match.index = 3;
  s.match.part = 2;
  s.match.tool = 5;
  s.match.pick = 6;
  s.match.position_mm = position_mm;
  s.match.rotation = rotation;
  s.match.score = 0.9;
  s.match.visible = 0.75;
  s.match.sigma_mm = {0.01, 0.02, 0.03};
  s.match.sigma_rad = {0.04 / kDeg, 0.05 / kDeg, std::nan("")};
  return s;
}

// A number out of the bytes, by the drawing in the header alone.
std::int64_t in_bytes(const FdBytes& bytes, std::size_t at, std::size_t count, bool is_signed) {
  std::int64_t raw = 0;
  for (std::size_t i = 0; i < count; ++i) raw += std::int64_t{bytes[at + i]} << 8 * i;
  const std::int64_t range = std::int64_t{1} << 8 * count;
  return is_signed && raw >= range / 2 ? raw - range : raw;
}
std::int64_t int32_at(const FdBytes& bytes, std::size_t at) { return in_bytes(bytes, at, 4, true); }
std::int64_t uint_at(const FdBytes& bytes, std::size_t at, std::size_t count) {
  return in_bytes(bytes, at, count, false);
}

TEST(CanFdReport, IsThePoseRoundedToItsScaleInEveryConvention) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-2e6, 2e6);
  std::uniform_real_distribution<double> turn(-6.3, 6.3);
  for (int i = 0; i < 2000; ++i) {
    const auto convention = static_cast<Convention>(i % kConventionCount);
    const Vec3 p{place(random), place(random), place(random)};
    const std::array<double, 4> r{turn(random), turn(random), turn(random), turn(random)};
    const FdBytes bytes = fd_bytes(seen(p, r, convention), {});
    EXPECT_NEAR(static_cast<double>(int32_at(bytes, 8)) * 0.001, p.x, 0.0005001);
    EXPECT_NEAR(static_cast<double>(int32_at(bytes, 12)) * 0.001, p.y, 0.0005001);
    EXPECT_NEAR(static_cast<double>(int32_at(bytes, 16)) * 0.001, p.z, 0.0005001);
    const double scale = is_euler(convention) ? 0.001 : 1e-6;
    const double unit = is_euler(convention) ? kDeg : 1.0;
    for (std::size_t k = 0; k < 4; ++k)
      EXPECT_NEAR(static_cast<double>(int32_at(bytes, 20 + 4 * k)) * scale, r[k] * unit,
                  0.50001 * scale);
    EXPECT_EQ(uint_at(bytes, 62, 1), static_cast<int>(convention));
  }
}

TEST(CanFdReport, HasAllElseInItsPlace) {
  const FdBytes bytes = fd_bytes(seen({1, 2, 3}, {}), {0x5678, job::Refusal::kBusy});
  EXPECT_EQ(uint_at(bytes, 0, 4), 0x01180000) << "sequence, status, bits, refused_status";
  EXPECT_EQ(uint_at(bytes, 4, 2), 0x5678);
  EXPECT_EQ(uint_at(bytes, 6, 2), 0x1234);
  for (int i = 0; i < 5; ++i)
    EXPECT_EQ(uint_at(bytes, static_cast<std::size_t>(36 + 2 * i), 2), 100 * (i + 1)) << i;
  EXPECT_EQ(uint_at(bytes, 46, 2), 0xffff) << "free to turn";
  EXPECT_EQ(uint_at(bytes, 48, 2), 9000);
  EXPECT_EQ(uint_at(bytes, 50, 2), 7500);
  EXPECT_EQ(uint_at(bytes, 52, 4), 0x01020304);
  EXPECT_EQ(uint_at(bytes, 56, 4), 0x03060502) << "part, tool, pick, match_index";
  EXPECT_EQ(uint_at(bytes, 60, 2), 0xbeef);
  EXPECT_EQ(uint_at(bytes, 63, 1), static_cast<int>(job::FrameName::kRobot));
}

TEST(CanFdReport, HoldsWhatTheTpdosHaveNoRoomFor) {
  const job::Snapshot poses[] = {seen({8388.608, 0, 0}, {}), seen({0, 0, -2147483.647}, {}),
                                 seen({}, {0.5, 0.5, 0.5, 0.5}, Convention::kAbbQuaternion)};
  for (const job::Snapshot& s : poses) {
    EXPECT_FALSE(has_pose(report_of(s, {})));
    const FdBytes bytes = fd_bytes(s, {});
    EXPECT_EQ(bytes[1], 0);
    EXPECT_TRUE(bytes[2] & job::kValid);
    EXPECT_EQ(bytes[59], 3);
    EXPECT_EQ(int32_at(bytes, 8), std::llround(s.match.position_mm.x * 1000));
    EXPECT_EQ(int32_at(bytes, 16), std::llround(s.match.position_mm.z * 1000));
  }
  EXPECT_EQ(int32_at(fd_bytes(poses[2], {}), 32), 500'000);
}

TEST(CanFdReport, NeverWrapsWhatIsBeyondARegister) {
  const double inf = std::numeric_limits<double>::infinity();
  for (const double far : {2147483.648, 1e9, 1e300}) {
    EXPECT_EQ(int32_at(fd_bytes(seen({far, -far, 0}, {}), {}), 8), 2147483647);
    EXPECT_EQ(int32_at(fd_bytes(seen({far, -far, 0}, {}), {}), 12), -2147483647);
  }
  for (const double none : {inf, -inf, std::nan("")})
    EXPECT_EQ(int32_at(fd_bytes(seen({none, 0, 0}, {}), {}), 8), -2147483648);
}

TEST(CanFdReport, HasNoRoomForPartsToolsAndPicksFromTheTwoHundredAndFiftyFifthOn) {
  using Number = std::uint16_t job::ShownMatch::*;
  for (const Number number : {&job::ShownMatch::part, &job::ShownMatch::tool,
                              &job::ShownMatch::pick, &job::ShownMatch::index}) {
    job::Snapshot s = seen({1, 2, 3}, {});
    s.match.*number = 254;
    FdBytes bytes = fd_bytes(s, {});
    EXPECT_EQ(bytes[1], 0);
    EXPECT_EQ(int32_at(bytes, 8), 1000);
    for (const int beyond : {255, 256, 300, 65534, 65535}) {
      s.match.*number = static_cast<std::uint16_t>(beyond);
      bytes = fd_bytes(s, {});
      EXPECT_EQ(static_cast<std::int8_t>(bytes[1]), static_cast<int>(job::Answer::kOutOfRange));
      EXPECT_FALSE(bytes[2] & job::kValid);
      EXPECT_EQ(uint_at(bytes, 6, 2), 0x1234);
      EXPECT_EQ(int32_at(bytes, 8), -2147483648);
      EXPECT_EQ(uint_at(bytes, 56, 4), 0x00ffffff);
    }
  }
}

TEST(CanFdReport, TellsNothingOfAnothersResult) {
  job::Snapshot s = seen({1, 2, 3}, {0.1, 0.2, 0.3, 0.4});
  s.result_is_readers = false;
  s.bits = 0xff;
  const FdBytes bytes = fd_bytes(s, {12, job::Refusal::kNotOwner});
  job::Snapshot other = seen({4, 5, 6}, {0.5, 0.6, 0.7, 0.8}, Convention::kAbbQuaternion);
  other.result_is_readers = false;
  other.bits = 0xff;
  other.frame = job::FrameName::kWork;
  other.age_ms = 5;
  other.has_scan = false;
  other.match.part = 300;
  EXPECT_EQ(fd_bytes(other, {12, job::Refusal::kNotOwner}), bytes) << "whatever it is";
  EXPECT_EQ(bytes[1], static_cast<std::uint8_t>(job::Answer::kPending));
  EXPECT_EQ(bytes[2], job::kReady | job::kBusy | job::kError | job::kSimulated);
  EXPECT_EQ(uint_at(bytes, 6, 2), 0);
  EXPECT_EQ(int32_at(bytes, 8), -2147483648);
  EXPECT_EQ(uint_at(bytes, 52, 4), 0xffffffff);
  EXPECT_EQ(uint_at(bytes, 60, 4), 0xffffbeef) << "the session is the node's own";
}

TEST(CanFdReport, WithoutAPoseEveryNumberOfItIsNone) {
  job::Snapshot s = seen({}, {});
  s.answer = job::Answer::kNoMatch;
  s.match = {};
  const FdBytes bytes = fd_bytes(s, {});
  std::size_t at = 8;
  for (; at < 36; at += 4) EXPECT_EQ(int32_at(bytes, at), -2147483648);
  for (; at < 48; at += 2) EXPECT_EQ(uint_at(bytes, at, 2), 0xffff);
  for (; at < 52; at += 2) EXPECT_EQ(in_bytes(bytes, at, 2, true), -32768);
  EXPECT_EQ(uint_at(bytes, 52, 4), 0x01020304) << "there was a scan";
  EXPECT_EQ(uint_at(bytes, 56, 4), 0x00ffffff);
  EXPECT_EQ(uint_at(bytes, 62, 1), 0);
}

TEST(CanFdReport, StartsWithWhatTheFirstTpdoTells) {
  for (const job::AnswerText& text : job::answer_texts()) {
    job::Snapshot s = seen({1, 2, 3}, {});
    if (!job::may_have_pose(text.answer)) s.match = {};
    s.answer = text.answer;
    const auto tpdo = tpdo_bytes(report_of(s, {7, job::Refusal::kBadJob}), 0);
    const FdBytes bytes = fd_bytes(s, {7, job::Refusal::kBadJob});
    EXPECT_TRUE(std::equal(tpdo.begin(), tpdo.end(), bytes.begin())) << text.name;
  }
}

TEST(CanFdReport, GrowsOlderButNotWithoutAScanNorBeyondItsBytes) {
  FdBytes bytes = fd_bytes(seen({}, {}), {});
  grow_older(bytes, 2'999);
  EXPECT_EQ(uint_at(bytes, 52, 4), 0x01020306);
  grow_older(bytes, -5'000);
  EXPECT_EQ(uint_at(bytes, 52, 4), 0x01020306);
  grow_older(bytes, std::int64_t{1} << 60);
  EXPECT_EQ(uint_at(bytes, 52, 4), 0xfffffffe);
  job::Snapshot s = seen({}, {});
  s.has_scan = false;
  bytes = fd_bytes(s, {});
  grow_older(bytes, 1'000'000);
  EXPECT_EQ(uint_at(bytes, 52, 4), 0xffffffff);
}

// Each byte changed alone: which of them are another result.
TEST(CanFdReport, IsAnotherResultWhenAnythingOfTheResultDiffers) {
  const FdBytes bytes = fd_bytes(seen({1, 2, 3}, {}), {});
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    FdBytes other = bytes;
    other[i] ^= 0x10;
    const bool is_age = i >= 52 && i < 56;
    const bool is_machine = i == 0 || (i >= 2 && i < 6);
    EXPECT_EQ(is_same_result(bytes, other), is_age || is_machine) << i;
  }
}

TEST(CanFdReport, TheDocumentHasEveryFieldInItsPlace) {
  std::ifstream file(std::string(FLATPOSE_SOURCE_DIR) + "/docs/can.md");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  ASSERT_GT(text.size(), 1000U);
  int at = 8;
  for (const FdLine& line : fd_lines()) {
    const std::string row = "| " + std::to_string(at) + " | `" +
                            result_map::find(line.field)->name + "` | " +
                            std::to_string(line.bytes) + " | ";
    EXPECT_NE(text.find(row), std::string::npos) << row;
    at += line.bytes;
  }
  EXPECT_EQ(at, 64);
}

}  // namespace
}  // namespace flatpose::can
