#include "flatpose/modbus/request.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace flatpose::modbus {
namespace {

using Bytes = std::vector<std::uint8_t>;

Exception told(const Bytes& pdu) {
  Request request;
  return understand(pdu, request);
}
constexpr auto kFine = Exception::kNone;
constexpr auto kFunction = Exception::kIllegalFunction;
constexpr auto kAddress = Exception::kIllegalAddress;
constexpr auto kValue = Exception::kIllegalValue;

Bytes words(std::uint8_t function, std::initializer_list<int> values) {
  Bytes pdu{function};
  for (const int value : values) {
    pdu.push_back(static_cast<std::uint8_t>(value >> 8));
    pdu.push_back(static_cast<std::uint8_t>(value));
  }
  return pdu;
}

TEST(Understand, ReadsWithinTheMap) {
  for (const std::uint8_t function : {std::uint8_t{3}, std::uint8_t{4}}) {
    EXPECT_EQ(told(words(function, {0, 125})), kFine);
    EXPECT_EQ(told(words(function, {259, 125})), kFine);
    EXPECT_EQ(told(words(function, {260, 125})), kAddress);
    EXPECT_EQ(told(words(function, {383, 1})), kFine);
    EXPECT_EQ(told(words(function, {384, 1})), kAddress);
    EXPECT_EQ(told(words(function, {65535, 125})), kAddress);  // no way round the end
    EXPECT_EQ(told(words(function, {0, 126})), kValue);
    EXPECT_EQ(told(words(function, {65535, 126})), kValue);  // count before address
    EXPECT_EQ(told(words(function, {0, 0})), kValue);
  }
  EXPECT_EQ(told(words(1, {0, 2})), kFine);
  EXPECT_EQ(told(words(1, {0, 3})), kAddress);
  EXPECT_EQ(told(words(1, {0, 2001})), kValue);
  EXPECT_EQ(told(words(2, {0, 8})), kFine);
  EXPECT_EQ(told(words(2, {1, 8})), kAddress);
}

TEST(Understand, WritesOnlyWhatMayBeWritten) {
  EXPECT_EQ(told(words(6, {0, 7})), kFine);
  EXPECT_EQ(told(words(6, {6, 7})), kFine);
  EXPECT_EQ(told(words(6, {7, 7})), kAddress);
  EXPECT_EQ(told(words(6, {101, 7})), kAddress);
  EXPECT_EQ(told(words(22, {0, 0xffff, 0})), kFine);
  EXPECT_EQ(told(words(22, {100, 0xffff, 0})), kAddress);
  EXPECT_EQ(told({16, 0, 0, 0, 2, 4, 0, 1, 0, 2}), kFine);
  EXPECT_EQ(told({16, 0, 6, 0, 2, 4, 0, 1, 0, 2}), kAddress);  // all or nothing
  EXPECT_EQ(told({5, 0, 0, 0xff, 0}), kFine);
  EXPECT_EQ(told({5, 0, 1, 0, 0}), kFine);
  EXPECT_EQ(told({5, 0, 1, 0, 1}), kValue);
  EXPECT_EQ(told({5, 0, 2, 0, 0}), kAddress);
  EXPECT_EQ(told({15, 0, 0, 0, 2, 1, 3}), kFine);
  EXPECT_EQ(told({15, 0, 1, 0, 2, 1, 3}), kAddress);
}

TEST(Understand, CountsBytes) {
  EXPECT_EQ(told({16, 0, 0, 0, 2, 4, 0, 1, 0}), kValue);        // one short
  EXPECT_EQ(told({16, 0, 0, 0, 2, 4, 0, 1, 0, 2, 3}), kValue);  // one long
  EXPECT_EQ(told({16, 0, 0, 0, 2, 3, 0, 1, 0}), kValue);
  EXPECT_EQ(told({16, 0, 0, 0, 0, 0}), kValue);
  EXPECT_EQ(told({15, 0, 0, 0, 2, 2, 3, 3}), kValue);
  EXPECT_EQ(told({23, 0, 100, 0, 93, 0, 0, 0, 1, 2, 0, 5}), kFine);
  EXPECT_EQ(told({23, 0, 100, 0, 126, 0, 0, 0, 1, 2, 0, 5}), kValue);
  EXPECT_EQ(told({23, 0, 100, 0, 93, 0, 0, 0, 1, 4, 0, 5}), kValue);
  EXPECT_EQ(told({23, 0, 100, 0, 93, 0, 100, 0, 1, 2, 0, 5}), kAddress);
  EXPECT_EQ(told({23, 1, 100, 0, 93, 0, 0, 0, 1, 2, 0, 5}), kAddress);
  EXPECT_EQ(told({17}), kFine);
  EXPECT_EQ(told({17, 0}), kValue);
  EXPECT_EQ(told({3, 0, 0, 0}), kValue);
  EXPECT_EQ(told({3, 0, 0, 0, 1, 0}), kValue);
}

TEST(Understand, KnowsItsFunctionsOnly) {
  EXPECT_EQ(told({}), kFunction);
  for (int function = 0; function < 256; ++function) {
    const bool is_known = (function >= 1 && function <= 6) || function == 15 || function == 16 ||
                          function == 17 || function == 22 || function == 23 || function == 43;
    EXPECT_EQ(told({static_cast<std::uint8_t>(function)}) == kFunction, !is_known) << function;
  }
}

TEST(Understand, SaysWhatIsReadAndWritten) {
  const Bytes pdu{23, 0, 100, 0, 93, 0, 1, 0, 2, 4, 0, 5, 0, 6};
  Request request;
  ASSERT_EQ(understand(pdu, request), kFine);
  EXPECT_EQ(request.read.address, 100);
  EXPECT_EQ(request.read.count, 93);
  EXPECT_EQ(request.write.address, 1);
  EXPECT_EQ(request.write.count, 2);
  EXPECT_TRUE(request.is_write());
}

}  // namespace
}  // namespace flatpose::modbus
