#include "port/linux/records/record_name.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>

namespace flatpose::port {
namespace {

using Kind = RecordName::Kind;

const RecordName kRecord{42, "20260131T235959Z", 21, Kind::kFailed, "no_match"};
const RecordName kSaved{43, "20260131T235959Z", 65535, Kind::kSaved, ""};

TEST(RecordName, IsReadAsItWasWritten) {
  EXPECT_EQ(kRecord.text(), "record-0000000042-20260131T235959Z-n00021-failed-no_match");
  EXPECT_EQ(kSaved.text(), "saved-0000000043-20260131T235959Z-n65535");
  for (const Kind kind : {Kind::kFound, Kind::kFailed, Kind::kDone, Kind::kSaved}) {
    RecordName name = kRecord;
    name.kind = kind;
    if (kind == Kind::kSaved) name.status.clear();
    const auto read = RecordName::parse(name.text());
    ASSERT_TRUE(read) << name.text();
    EXPECT_EQ(read->sequence, 42U);
    EXPECT_EQ(read->number, 21);
    EXPECT_EQ(read->kind, kind);
    EXPECT_EQ(read->text(), name.text());
  }
}

TEST(RecordName, SortsByTimeUpToTenDigitsWhateverTheClockSays) {
  RecordName before = kRecord;
  RecordName after = kRecord;
  for (const std::uint64_t sequence : {9ULL, 10ULL, 999'999'999ULL, 4'999'999'999ULL}) {
    before.sequence = sequence;
    after.sequence = sequence + 1;
    after.time = "19700101T000000Z";
    EXPECT_LT(before.text(), after.text());
  }
}

TEST(RecordName, OfAStrangerIsNone) {
  for (const char* const stem :
       {"", "-", "record", "scan", "record-1-20260131T235959Z-n00021-failed-no_match",
        "record-0000000042-20260131T235959Z-n21-failed-no_match",
        "record-0000000042-20260131T235959Z-n00021-lost-no_match",
        "record-0000000042-20260131T235959Z-n00021-failed",
        "record-0000000042-20260131T235959Z-n99999-failed-no_match",
        "record-0000000042-20260131T235959Z--failed-no_match", "saved-0000000043-x-",
        "saved-0000000043-20260131T235959Z-n65535-copy",
        "record-0000000042-20260131T235959Z-n00021-failed-no_match (1)x-"})
    EXPECT_FALSE(RecordName::parse(stem)) << stem;
  EXPECT_FALSE(RecordName::parse(std::string(100'000, '-')));
}

TEST(RecordName, OneLetterChangedIsAnotherNameOrNone) {
  std::mt19937 random(5);
  for (int i = 0; i < 20'000; ++i) {
    std::string stem = kRecord.text();
    stem[random() % stem.size()] = static_cast<char>(random() % 256);
    const auto read = RecordName::parse(stem);
    if (read) {
      EXPECT_EQ(read->text(), stem);
    }
  }
}

TEST(UtcText, IsTheTimeInGreenwich) {
  EXPECT_EQ(utc_text(0), "19700101T000000Z");
  EXPECT_EQ(utc_text(1'769'903'999'999'999), "20260131T235959Z");
}

}  // namespace
}  // namespace flatpose::port
