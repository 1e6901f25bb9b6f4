#include "flatpose/result_map/table.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>
#include <utility>

namespace flatpose::result_map {
namespace {

const Entry* named(const std::string& name) {
  for (const Entry& entry : entries()) {
    if (entry.block == 0 && entry.name == name) return &entry;
  }
  return nullptr;
}

// What scripts and PLC programs rely on.
TEST(RegisterMap, NamesAndScalesThatStay) {
  for (const char* name : {"command_number", "command_session", "command", "job"}) {
    ASSERT_NE(named(name), nullptr) << name;
    EXPECT_EQ(named(name)->table, Table::kHolding) << name;
  }
  for (const char* name :
       {"session_id", "accepted_number", "refused_number", "refused_status", "scanned_number",
        "done_number", "status", "match_count", "match_index"}) {
    ASSERT_NE(named(name), nullptr) << name;
    EXPECT_EQ(named(name)->table, Table::kInput) << name;
    EXPECT_EQ(named(name)->words(), 1) << name;
  }
  for (const char* name : {"position_x", "position_y", "position_z", "rotation_1", "rotation_2",
                           "rotation_3", "rotation_4"}) {
    ASSERT_NE(named(name), nullptr) << name;
    EXPECT_EQ(named(name)->type, Type::kInt32) << name;
    EXPECT_EQ(named(name)->scale, 0.001) << name;
    EXPECT_EQ(named(std::string(name) + "_f")->type, Type::kFloat32) << name;
    EXPECT_EQ(named(std::string(name) + "_f")->scale, 1.0) << name;
  }
  EXPECT_EQ(named("status")->type, Type::kInt16);
  EXPECT_EQ(named("score_f")->type, Type::kFloat32);
}

TEST(RegisterMap, EveryNameAndEveryCanObjectIsThereOnce) {
  std::set<std::pair<int, std::string>> names;
  std::set<std::pair<int, int>> objects;
  for (const Entry& entry : entries()) {
    EXPECT_TRUE(names.insert({entry.block, entry.name}).second) << entry.name;
    EXPECT_TRUE(objects.insert({entry.can_index, entry.can_subindex}).second) << entry.name;
    EXPECT_GE(entry.can_index, 0x2000);  // the makers' own range
    EXPECT_LT(entry.can_index, 0x6000);
    EXPECT_GE(entry.can_subindex, 1);
    EXPECT_GT(entry.scale, 0.0);
  }
}

TEST(RegisterMap, RegistersBelongToTheirEntriesAndGapsToNone) {
  std::map<int, const Entry*> owner;
  for (const Entry& entry : entries()) {
    for (int word = 0; word < entry.words(); ++word) {
      EXPECT_TRUE(owner.emplace(entry.address + word, &entry).second) << entry.name;
    }
  }
  for (int address = -3; address < kRegisterCount + 3; ++address) {
    const auto found = owner.find(address);
    EXPECT_EQ(entry_at(address), found == owner.end() ? nullptr : found->second) << address;
  }
  for (const int address : {0, 1, 6}) EXPECT_TRUE(is_writable(address));
  for (const int address : {-1, 7, 10, 101, 359, 400}) EXPECT_FALSE(is_writable(address));
}

TEST(RegisterMap, AResultIsOneReadWithItsNumberAtBothEnds) {
  EXPECT_LE(kResultWords, 125);
  EXPECT_STREQ(entry_at(kResultAddress)->name, "map_version");
  EXPECT_STREQ(entry_at(kResultAddress + 1)->name, "done_number");
  EXPECT_STREQ(entry_at(kResultAddress + kResultWords - 1)->name, "done_number_end");
  EXPECT_EQ(entry_at(kResultAddress + kResultWords), nullptr);
  for (int block = 0; block < kFurtherBlocks; ++block) {
    const int start = kFurtherAddress + block * kFurtherWords;
    EXPECT_STREQ(entry_at(start)->name, "number");
    EXPECT_STREQ(entry_at(start + kFurtherWords - 1)->name, "number_tail");
    EXPECT_EQ(entry_at(start)->block, block + 1);
  }
}

// A PLC that was written for map version 1 reads 93 registers from 100, and finds all as it was.
TEST(RegisterMap, OfVersionOneKeepsItsPlaces) {
  EXPECT_STREQ(entry_at(192)->name, "done_number_tail");
  EXPECT_STREQ(entry_at(190)->name, "sigma_turn_z_f");
  EXPECT_STREQ(entry_at(142)->name, "position_x");
  EXPECT_STREQ(entry_at(200)->name, "number");
  EXPECT_STREQ(entry_at(359)->name, "number_tail");
  EXPECT_EQ(entry_at(192)->can_subindex, 62);
  EXPECT_EQ(entry_at(359)->can_index, 0x2027);
  EXPECT_EQ(entry_at(359)->can_subindex, 13);
}

TEST(RegisterMap, FindsAFieldsFirstEntry) {
  EXPECT_EQ(find(Field::kPositionX), named("position_x"));
  EXPECT_EQ(find(Field::kCommandNumber)->address, 0);
}

}  // namespace
}  // namespace flatpose::result_map
