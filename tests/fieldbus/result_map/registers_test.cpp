#include "flatpose/result_map/registers.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "flatpose/core/maths.hpp"
#include "flatpose/result_map/table.hpp"

namespace flatpose::result_map {
namespace {

job::ShownMatch a_match(int index) {
  const double i = index;
  return {static_cast<std::uint16_t>(index),
          static_cast<std::uint16_t>(20 + index),
          {100.5 + i, -200.25 - i, 0.0015 * i},
          {0.5 * kRadPerDeg * i, -90.0 * kRadPerDeg, 179.9999 * kRadPerDeg, 0.0},
          0.9 - 0.01 * i,
          0.75,
          {0.0123, 0.5, 0.25},
          {0.1 * kRadPerDeg, 0.2 * kRadPerDeg, std::numeric_limits<double>::quiet_NaN()},
          static_cast<std::uint16_t>(40 + index),
          static_cast<std::uint16_t>(60 + index)};
}

job::Snapshot full_snapshot() {
  job::Snapshot s;
  s.image = {65535, 2, 3, 4, 5, 6, 7};
  s.bits = 0x5a;
  s.answer = job::Answer::kFaceUnsure;
  s.done_number = 65535;
  s.accepted_number = 12;
  s.refused_number = 13;
  s.refused_status = job::Refusal::kBadJob;
  s.scanned_number = 14;
  s.cancelled_number = 15;
  s.last_number = 16;
  s.session_id = 17;
  s.boot_count = 18;
  s.heartbeat = 19;
  s.uptime_s = 4000000000U;
  s.owner_address = 0xc0000201;
  s.reader_is_owner = true;
  s.result_is_readers = true;
  s.answer_by_ms = 70000;
  s.frame = job::FrameName::kRobot;
  s.convention = Convention::kFanucWpr;
  s.job = 21;
  s.has_scan = true;
  s.scan_number = 0xffffffff;
  s.age_ms = 1234567;
  s.sensor_us = 22;
  s.cycle_us = 23;
  s.part_hash = 0xdeadbeef;
  s.alignment_hash = 0xffffffff;
  s.match_count = 24;
  s.matches_left = 25;
  s.match = a_match(1);
  for (int i = 0; i < job::kFurtherCount; ++i) s.further[i] = a_match(2 + i);
  return s;
}

std::vector<std::uint16_t> all_registers(const job::Snapshot& s, const WireFormat& format = {}) {
  std::vector<std::uint16_t> registers(kRegisterCount);
  read_registers(s, format, 0, registers);
  return registers;
}

// A PLC's way back, in no order but ABCD's and by nothing but the table's words.
double decoded(const Entry& entry, const std::vector<std::uint16_t>& registers) {
  const std::uint16_t first = registers[entry.address];
  if (entry.type == Type::kUint16) return first * entry.scale;
  if (entry.type == Type::kInt16) return static_cast<std::int16_t>(first) * entry.scale;
  const std::uint32_t bits =
      static_cast<std::uint32_t>(first) * 65536U + registers[entry.address + 1];
  if (entry.type == Type::kUint32) return bits * entry.scale;
  if (entry.type == Type::kInt32) return static_cast<std::int32_t>(bits) * entry.scale;
  float value = 0;
  std::memcpy(&value, &bits, sizeof value);
  return static_cast<double>(value);
}

TEST(Registers, TellEveryFieldOfASnapshot) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::map<std::string, double> expected{{"command_number", 65535},
                                               {"command_session", 2},
                                               {"command", 3},
                                               {"job", 4},
                                               {"pick_number", 5},
                                               {"pick_outcome", 6},
                                               {"control", 7},
                                               {"test_uint16", 0x1234},
                                               {"test_uint32", 0x12345678},
                                               {"test_float32", 123456.0},
                                               {"map_version", 2},
                                               {"done_number", 65535},
                                               {"status", 3},
                                               {"bits", 0x5a},
                                               {"accepted_number", 12},
                                               {"refused_number", 13},
                                               {"refused_status", 4},
                                               {"scanned_number", 14},
                                               {"cancelled_number", 15},
                                               {"last_number", 16},
                                               {"session_id", 17},
                                               {"boot_count", 18},
                                               {"heartbeat", 19},
                                               {"reader_is_owner", 1},
                                               {"owner_address", 0xc0000201},
                                               {"uptime_s", 4000000000.0},
                                               {"answer_by_ms", 70000},
                                               {"result_is_readers", 1},
                                               {"frame", 2},
                                               {"convention", 1},
                                               {"result_job", 21},
                                               {"part", 21},
                                               {"match_count", 24},
                                               {"match_index", 1},
                                               {"matches_left", 25},
                                               {"score", 0.89},
                                               {"visible", 0.75},
                                               {"scan_number", 0xffffffff},
                                               {"age_ms", 1234567},
                                               {"sensor_time_us", 22},
                                               {"cycle_time_us", 23},
                                               {"part_hash", 0xdeadbeef},
                                               {"alignment_hash", 0xffffffff},
                                               {"position_x", 101.5},
                                               {"position_y", -201.25},
                                               {"position_z", 0.002},
                                               {"rotation_1", 0.5},
                                               {"rotation_2", -90},
                                               {"rotation_3", 180.0},
                                               {"rotation_4", 0},
                                               {"sigma_x", 0.0123},
                                               {"sigma_y", 0.5},
                                               {"sigma_z", 0.25},
                                               {"sigma_turn_x", 0.1},
                                               {"sigma_turn_y", 0.2},
                                               {"sigma_turn_z", 6.5535},
                                               {"position_x_f", 101.5},
                                               {"position_y_f", -201.25},
                                               {"position_z_f", 0.0015},
                                               {"rotation_1_f", 0.5},
                                               {"rotation_2_f", -90},
                                               {"rotation_3_f", 179.9999},
                                               {"rotation_4_f", 0},
                                               {"score_f", 0.89},
                                               {"visible_f", 0.75},
                                               {"sigma_x_f", 0.0123},
                                               {"sigma_y_f", 0.5},
                                               {"sigma_z_f", 0.25},
                                               {"sigma_turn_x_f", 0.1},
                                               {"sigma_turn_y_f", 0.2},
                                               {"sigma_turn_z_f", nan},
                                               {"done_number_tail", 65535},
                                               {"tool", 41},
                                               {"pick", 61},
                                               {"done_number_end", 65535}};
  const auto registers = all_registers(full_snapshot());
  std::size_t seen = 0;
  for (const Entry& entry : entries()) {
    if (entry.block != 0) continue;
    const auto found = expected.find(entry.name);
    ASSERT_NE(found, expected.end()) << entry.name;
    const double value = decoded(entry, registers);
    if (std::isnan(found->second)) {
      EXPECT_TRUE(std::isnan(value)) << entry.name;
    } else {
      EXPECT_NEAR(value, found->second, std::fabs(found->second) * 1e-6 + 1e-12) << entry.name;
    }
    ++seen;
  }
  EXPECT_EQ(seen, expected.size());
}

TEST(Registers, TellEveryFurtherMatch) {
  const auto registers = all_registers(full_snapshot());
  for (const Entry& entry : entries()) {
    if (entry.block == 0) continue;
    const int index = entry.block + 1;
    const job::ShownMatch match = a_match(index);
    const std::map<std::string, double> expected{
        {"number", 65535},
        {"match_index", index},
        {"part", 20 + index},
        {"score", match.score},
        {"position_x", match.position_mm.x},
        {"position_y", match.position_mm.y},
        {"position_z", std::floor(match.position_mm.z * 1000 + 0.5) / 1000},
        {"rotation_1", 0.5 * index},
        {"rotation_2", -90},
        {"rotation_3", 180},
        {"rotation_4", 0},
        {"visible", 0.75},
        {"number_tail", 65535},
        {"tool_number", 65535},
        {"tool", 40 + index},
        {"pick", 60 + index}};
    EXPECT_NEAR(decoded(entry, registers), expected.at(entry.name), 1e-9)
        << entry.name << " of block " << int{entry.block};
  }
}

TEST(Registers, ConstantsComeInAllFourOrders) {
  const job::Snapshot s;
  using Words = std::vector<std::uint16_t>;
  const auto words = [&s](WordOrder order) {
    Words registers(5);
    read_registers(s, {.order = order}, 10, registers);
    return registers;
  };
  // 123456.0 is 0x47f12000.
  EXPECT_EQ(words(WordOrder::kAbcd), (Words{0x1234, 0x1234, 0x5678, 0x47f1, 0x2000}));
  EXPECT_EQ(words(WordOrder::kCdab), (Words{0x1234, 0x5678, 0x1234, 0x2000, 0x47f1}));
  EXPECT_EQ(words(WordOrder::kBadc), (Words{0x1234, 0x3412, 0x7856, 0xf147, 0x0020}));
  EXPECT_EQ(words(WordOrder::kDcba), (Words{0x1234, 0x7856, 0x3412, 0x0020, 0xf147}));
}

TEST(Registers, WithoutAPoseThereIsNoneNeverZeroNorTheLast) {
  job::Snapshot s = full_snapshot();
  s.match = {};
  s.further = {};
  const auto registers = all_registers(s);
  for (const Entry& entry : entries()) {
    if (entry.field < Field::kMatchNumber) continue;
    if (entry.field == Field::kMatchNumber || entry.field == Field::kMatchIndex) {
      EXPECT_EQ(registers[entry.address], 0);
      continue;
    }
    const std::uint16_t first = registers[entry.address];
    const std::uint16_t second = entry.words() == 2 ? registers[entry.address + 1] : 0;
    switch (entry.type) {
      case Type::kInt32: EXPECT_TRUE(first == 0x8000 && second == 0) << entry.name; break;
      case Type::kFloat32: EXPECT_TRUE(first == 0x7fc0 && second == 0) << entry.name; break;
      case Type::kInt16: EXPECT_EQ(first, 0x8000) << entry.name; break;
      default: EXPECT_EQ(first, 0xffff) << entry.name;
    }
  }
}

TEST(Registers, NoneMayBeAnotherValueAndThenNoValueIsThat) {
  job::Snapshot s = full_snapshot();
  WireFormat format{.none_int32 = 0, .none_float32 = 0xc479c000};  // -999.0
  s.match.position_mm.x = 0.0;
  EXPECT_EQ(raw_of(*find(Field::kPositionX), s, format), 1U);  // a thousandth off, but a pose
  s.match = {};
  EXPECT_EQ(raw_of(*find(Field::kPositionX), s, format), 0U);
  const auto registers = all_registers(s, format);
  EXPECT_EQ(decoded(*entry_at(162), registers), -999.0);
}

TEST(Registers, WhatIsTooLargeIsHeldAndIsNotNone) {
  job::Snapshot s = full_snapshot();
  s.match.position_mm = {1e12, -1e12, std::numeric_limits<double>::infinity()};
  s.match.sigma_mm.x = 1e9;
  s.match.score = -1e9;
  EXPECT_EQ(raw_of(*find(Field::kPositionX), s, {}), 0x7fffffffU);
  EXPECT_EQ(raw_of(*find(Field::kPositionY), s, {}), 0x80000001U);
  EXPECT_EQ(raw_of(*find(Field::kPositionZ), s, {}), 0x80000000U);  // not finite: none
  EXPECT_EQ(raw_of(*find(Field::kSigmaX), s, {}), 65534U);
  EXPECT_EQ(raw_of(*find(Field::kScore), s, {}) & 0xffff, 0x8001U);
  s.match.position_mm.x = 1e300;
  const auto registers = all_registers(s);
  EXPECT_TRUE(std::isfinite(decoded(*entry_at(162), registers)));
}

TEST(Registers, RotationsAreScaledByTheirConvention) {
  job::Snapshot s = full_snapshot();
  s.match.rotation = {0.5, -0.5, 0.25, 0.75};
  for (int i = 0; i < kConventionCount; ++i) {
    s.convention = static_cast<Convention>(i);
    const auto raw = static_cast<std::int32_t>(raw_of(*find(Field::kRotation1), s, {}));
    const bool is_angle = is_euler(s.convention);
    EXPECT_EQ(raw, is_angle ? 28648 : 500000) << to_string(s.convention);  // 28.6479 degrees
  }
  s.convention = Convention::kAbbQuaternion;
  EXPECT_EQ(raw_of(*find(Field::kRotation4), s, {}), 750000U);
}

TEST(Registers, AnyRangeIsASliceOfTheWhole) {
  const job::Snapshot s = full_snapshot();
  for (const WordOrder order : {WordOrder::kAbcd, WordOrder::kCdab}) {
    const auto whole = all_registers(s, {.order = order});
    for (int address = 0; address < kRegisterCount; ++address) {
      for (const int count : {1, 2, 3, 20, 125}) {
        if (address + count > kRegisterCount) continue;
        std::vector<std::uint16_t> part(static_cast<std::size_t>(count), 0xaaaa);
        read_registers(s, {.order = order}, address, part);
        ASSERT_TRUE(std::equal(part.begin(), part.end(), whole.begin() + address)) << address;
      }
    }
  }
}

TEST(Registers, WrittenOnesBecomeTheImage) {
  job::CommandImage image;
  const std::vector<std::uint16_t> words{11, 12, 13, 14, 15, 16, 17};
  write_registers(image, 0, words);
  EXPECT_EQ(image, (job::CommandImage{11, 12, 13, 14, 15, 16, 17}));
  write_registers(image, 2, std::vector<std::uint16_t>{99});
  EXPECT_EQ(image, (job::CommandImage{11, 12, 99, 14, 15, 16, 17}));
  job::Snapshot s;
  s.image = image;
  const auto back = all_registers(s);
  EXPECT_EQ(back[0], 11);
  EXPECT_EQ(back[2], 99);
}

TEST(Registers, TouchesKnowsItsRange) {
  EXPECT_TRUE(touches(Field::kCommandNumber, 0, 1));
  EXPECT_FALSE(touches(Field::kCommandNumber, 1, 3));
  EXPECT_TRUE(touches(Field::kControl, 3, 4));
  EXPECT_FALSE(touches(Field::kControl, 3, 3));
}

}  // namespace
}  // namespace flatpose::result_map
