#include "flatpose/modbus/identity.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

namespace flatpose::modbus {
namespace {

using Bytes = std::vector<std::uint8_t>;
const Identity kIdentity{.revision = "1.2.3", .vendor_url = "https://example.org"};

struct Told {
  Exception exception;
  Bytes pdu;
};
Told told(const Bytes& request, const Identity& identity = kIdentity) {
  std::array<std::uint8_t, 253> pdu{};
  std::size_t bytes = 0;
  const Exception exception = read_identification(identity, request, pdu, bytes);
  return {exception, Bytes(pdu.begin(), pdu.begin() + static_cast<std::ptrdiff_t>(bytes))};
}

/// The objects of a response: id and text, one after the other.
std::vector<std::pair<int, std::string>> objects_in(const Bytes& pdu) {
  std::vector<std::pair<int, std::string>> objects;
  std::size_t at = 7;
  for (int i = 0; i < pdu[6]; ++i) {
    const std::size_t bytes = pdu[at + 1];
    objects.push_back(
        {pdu[at], std::string(pdu.begin() + static_cast<std::ptrdiff_t>(at + 2),
                              pdu.begin() + static_cast<std::ptrdiff_t>(at + 2 + bytes))});
    at += 2 + bytes;
  }
  EXPECT_EQ(at, pdu.size());
  return objects;
}

TEST(Identity, ServerIdHasIdRunAndText) {
  std::array<std::uint8_t, 253> pdu{};
  const std::size_t bytes = report_server_id(kIdentity, pdu);
  EXPECT_EQ(bytes, 2U + pdu[1]);
  EXPECT_EQ(pdu[0], 17);
  EXPECT_EQ(pdu[3], 0xff);
  EXPECT_EQ(std::string(pdu.begin() + 4, pdu.begin() + static_cast<std::ptrdiff_t>(bytes)),
            "flatpose 1.2.3");
}

TEST(Identity, StreamsBasicAndRegularObjects) {
  const Bytes basic = told({43, 14, 1, 0}).pdu;
  EXPECT_EQ(Bytes(basic.begin(), basic.begin() + 7), (Bytes{43, 14, 1, 0x82, 0, 0, 3}));
  const auto objects = objects_in(basic);
  EXPECT_EQ(objects[0], (std::pair<int, std::string>{0, "flatpose"}));
  EXPECT_EQ(objects[2], (std::pair<int, std::string>{2, "1.2.3"}));
  EXPECT_EQ(objects_in(told({43, 14, 2, 0}).pdu).size(), 7U);
  EXPECT_EQ(objects_in(told({43, 14, 3, 0}).pdu).size(), 7U);  // all there is
  EXPECT_EQ(objects_in(told({43, 14, 2, 5}).pdu).size(), 2U);
  EXPECT_EQ(objects_in(told({43, 14, 1, 5}).pdu).size(), 3U);  // not basic: from the first
}

TEST(Identity, GivesSingleObjects) {
  const auto objects = objects_in(told({43, 14, 4, 3}).pdu);
  ASSERT_EQ(objects.size(), 1U);
  EXPECT_EQ(objects[0], (std::pair<int, std::string>{3, "https://example.org"}));
  EXPECT_EQ(told({43, 14, 4, 7}).exception, Exception::kIllegalAddress);
}

TEST(Identity, RefusesWhatItDoesNotKnow) {
  EXPECT_EQ(told({43}).exception, Exception::kIllegalValue);
  EXPECT_EQ(told({43, 13, 1, 0}).exception, Exception::kIllegalFunction);
  EXPECT_EQ(told({43, 14, 0, 0}).exception, Exception::kIllegalValue);
  EXPECT_EQ(told({43, 14, 5, 0}).exception, Exception::kIllegalValue);
  EXPECT_EQ(told({43, 14, 1}).exception, Exception::kIllegalValue);
  EXPECT_EQ(told({43, 14, 1, 0, 0}).exception, Exception::kIllegalValue);
}

TEST(Identity, LongTextsAreCutSoThatAllFit) {
  const std::string text(200, 'x');
  const char* t = text.c_str();
  const Told all = told({43, 14, 2, 0}, {t, t, t, t, t, t, t});
  EXPECT_LE(all.pdu.size(), 253U);
  for (const auto& [id, object] : objects_in(all.pdu)) EXPECT_EQ(object, std::string(30, 'x'));
}

}  // namespace
}  // namespace flatpose::modbus
