#include "flatpose/modbus/adu.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace flatpose::modbus {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Step = AduReader::Step;

const Bytes kRead{0x12, 0x34, 0, 0, 0, 6, 0xff, 3, 0, 100, 0, 93};
const Bytes kWrite{0x12, 0x35, 0, 0, 0, 6, 1, 6, 0, 0, 0, 7};

void feed(AduReader& reader, const Bytes& bytes) {
  ASSERT_LE(bytes.size(), reader.room().size());
  std::copy(bytes.begin(), bytes.end(), reader.room().begin());
  reader.filled(bytes.size());
}

TEST(AduReader, TakesAFrameApart) {
  AduReader reader;
  feed(reader, kRead);
  Adu adu;
  ASSERT_EQ(reader.next(adu), Step::kAdu);
  EXPECT_EQ(adu.transaction, 0x1234);
  EXPECT_EQ(adu.unit, 0xff);
  EXPECT_EQ(Bytes(adu.pdu.begin(), adu.pdu.end()), Bytes(kRead.begin() + 7, kRead.end()));
  EXPECT_EQ(reader.next(adu), Step::kNeedsMore);
  EXPECT_FALSE(reader.is_inside_frame());
}

TEST(AduReader, WaitsForBytesThatComeOneByOne) {
  AduReader reader;
  Adu adu;
  for (int round = 0; round < 100; ++round) {
    const Bytes& frame = round % 2 == 0 ? kRead : kWrite;
    for (std::size_t i = 0; i < frame.size(); ++i) {
      ASSERT_EQ(reader.next(adu), Step::kNeedsMore) << i;
      EXPECT_EQ(reader.is_inside_frame(), i > 0);
      feed(reader, {frame[i]});
    }
    ASSERT_EQ(reader.next(adu), Step::kAdu);
    EXPECT_EQ(adu.transaction, frame[0] * 256 + frame[1]);
  }
}

TEST(AduReader, GivesPipelinedFramesInOrderHoweverTheyAreCut) {
  Bytes stream;
  for (std::uint8_t i = 0; i < 40; ++i) {
    Bytes frame = i % 3 == 0 ? kWrite : kRead;
    frame[1] = i;
    stream.insert(stream.end(), frame.begin(), frame.end());
  }
  for (std::size_t piece = 1; piece <= 260; piece += 7) {
    AduReader reader;
    Adu adu;
    int seen = 0;
    for (std::size_t at = 0; at < stream.size();) {
      const std::size_t bytes = std::min({piece, stream.size() - at, reader.room().size()});
      ASSERT_GT(bytes, 0U);
      feed(reader, Bytes(stream.begin() + static_cast<std::ptrdiff_t>(at),
                         stream.begin() + static_cast<std::ptrdiff_t>(at + bytes)));
      at += bytes;
      while (reader.next(adu) == Step::kAdu) EXPECT_EQ(adu.transaction & 0xff, seen++);
    }
    EXPECT_EQ(seen, 40) << piece;
  }
}

TEST(AduReader, ClosesOnAWrongProtocolOrLengthAsSoonAsItIsSeen) {
  struct Case {
    Bytes bytes;
    Step told;
  };
  for (const Case& c :
       {Case{{0, 0, 0}, Step::kNeedsMore}, Case{{0, 0, 0, 1}, Step::kClose},
        Case{{0, 0, 1, 0}, Step::kClose}, Case{{0, 0, 0, 0, 0}, Step::kNeedsMore},
        Case{{0, 0, 0, 0, 0, 0}, Step::kClose}, Case{{0, 0, 0, 0, 0, 1}, Step::kClose},
        Case{{0, 0, 0, 0, 0, 2}, Step::kNeedsMore}, Case{{0, 0, 0, 0, 0, 254}, Step::kNeedsMore},
        Case{{0, 0, 0, 0, 0, 255}, Step::kClose}, Case{{0, 0, 0, 0, 1, 4}, Step::kClose},
        Case{{'G', 'E', 'T', ' ', '/', ' '}, Step::kClose}}) {
    AduReader reader;
    Adu adu;
    feed(reader, c.bytes);
    EXPECT_EQ(reader.next(adu), c.told);
    if (c.told != Step::kClose) continue;
    feed(reader, kRead);
    EXPECT_EQ(reader.next(adu), Step::kClose);  // for ever
  }
}

TEST(AduReader, HasRoomForTheLongestFrameAndTakesIt) {
  Bytes longest(260, 0x55);
  longest[2] = longest[3] = longest[4] = 0;
  longest[5] = 254;
  AduReader reader;
  feed(reader, longest);
  EXPECT_TRUE(reader.room().empty());
  Adu adu;
  ASSERT_EQ(reader.next(adu), Step::kAdu);
  EXPECT_EQ(adu.pdu.size(), 253U);
  EXPECT_EQ(reader.next(adu), Step::kNeedsMore);
  EXPECT_EQ(reader.room().size(), 260U);
}

TEST(Compose, IsTheInverse) {
  std::array<std::uint8_t, kAduBytesMax> out{};
  const Bytes pdu(kRead.begin() + 7, kRead.end());
  ASSERT_EQ(compose(0x1234, 0xff, pdu, out), kRead.size());
  EXPECT_TRUE(std::equal(kRead.begin(), kRead.end(), out.begin()));
  EXPECT_EQ(compose(1, 1, Bytes{}, out), 0U);
  EXPECT_EQ(compose(1, 1, Bytes(254), out), 0U);
  EXPECT_EQ(compose(1, 1, Bytes(253), out), 260U);
  EXPECT_EQ(compose(1, 1, pdu, std::span(out).first(11)), 0U);
}

}  // namespace
}  // namespace flatpose::modbus
