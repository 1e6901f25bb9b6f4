#include "flatpose/job/ownership.hpp"

#include <gtest/gtest.h>

namespace flatpose::job {
namespace {

constexpr std::int64_t kLease_us = 5'000'000;

TEST(Ownership, AnyRequestOfTheOwnerRenewsTheLeaseAndNobodyElses) {
  Ownership ownership(kLease_us);
  ownership.take({1, 1}, 0);
  ownership.hear({2, 2}, 3'000'000);
  EXPECT_EQ(ownership.held_until_us(), kLease_us);
  ownership.hear({1, 7}, 4'000'000);  // on whatever connection
  EXPECT_EQ(ownership.held_until_us(), 9'000'000);
  EXPECT_EQ(ownership.holder(8'999'999), 1U);
  EXPECT_EQ(ownership.holder(9'000'000), kNobody);
  ownership.hear({1, 7}, 9'000'000);  // too late: only a write takes it again
  EXPECT_EQ(ownership.holder(9'000'000), kNobody);
}

TEST(Ownership, OthersWriteOnlyWhenTheLeaseIsOut) {
  Ownership ownership(kLease_us);
  EXPECT_TRUE(ownership.may_write({2, 1}, 0));
  ownership.take({1, 1}, 0);
  EXPECT_FALSE(ownership.may_write({2, 1}, kLease_us - 1));
  EXPECT_TRUE(ownership.may_write({2, 1}, kLease_us));
  EXPECT_FALSE(ownership.may_write({kNobody, 1}, kLease_us));
}

TEST(Ownership, ANewConnectionOfTheSameAddressTakesOverAndTheOldOnesRestIsRefused) {
  Ownership ownership(kLease_us);
  ownership.take({1, 10}, 0);
  EXPECT_TRUE(ownership.may_write({1, 11}, 1));
  ownership.take({1, 11}, 1);
  EXPECT_FALSE(ownership.may_write({1, 10}, 2));
  EXPECT_TRUE(ownership.may_write({1, 11}, 2));
  EXPECT_FALSE(ownership.may_write({1, 10}, 100 * kLease_us));  // lease or not
  EXPECT_FALSE(ownership.may_write({1, 9}, 2));
}

// Two programs behind one address may both write, if they show that they live.
TEST(Ownership, AnOldConnectionThatIsHeardAgainMayWrite) {
  Ownership ownership(kLease_us);
  ownership.take({1, 10}, 0);
  ownership.take({1, 11}, 1);
  ownership.hear({1, 10}, 2);
  EXPECT_TRUE(ownership.may_write({1, 10}, 3));
  ownership.take({1, 10}, 3);
  EXPECT_TRUE(ownership.may_write({1, 11}, 4));
  ownership.take({1, 11}, 4);
  EXPECT_FALSE(ownership.may_write({1, 10}, 5));  // heard before, not since
  ownership.hear({1, 11}, 6);                     // nor does the other's voice count
  EXPECT_FALSE(ownership.may_write({1, 10}, 7));
}

TEST(MasterBook, RemembersEachMastersNumberWhoeverWroteBetween) {
  MasterBook book;
  for (Address a = 1; a <= MasterBook::kMasterCountMax; ++a) {
    book.open(a, a).last_number = static_cast<std::uint16_t>(100 + a);
  }
  for (Address a = 1; a <= MasterBook::kMasterCountMax; ++a) {
    EXPECT_EQ(book.find(a)->last_number, 100 + a);
  }
  EXPECT_EQ(book.find(99), nullptr);
  EXPECT_EQ(book.find(kNobody), nullptr);
}

TEST(MasterBook, ForgetsTheOneThatHasNotWrittenForLongest) {
  MasterBook book;
  for (Address a = 1; a <= MasterBook::kMasterCountMax; ++a) book.open(a, a);
  book.open(1, 1000);
  book.open(500, 1001);
  EXPECT_NE(book.find(1), nullptr);
  EXPECT_EQ(book.find(2), nullptr);
  EXPECT_NE(book.find(3), nullptr);
  EXPECT_NE(book.find(500), nullptr);
}

}  // namespace
}  // namespace flatpose::job
