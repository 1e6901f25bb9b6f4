#include "port/linux/files/base64.hpp"

#include <gtest/gtest.h>

#include "tests/port/linux/files/temporary_folder.hpp"

namespace flatpose::port {
namespace {

std::string decoded(std::string_view text) {
  const Base64Result result = decode_base64(text);
  EXPECT_FALSE(result.wrong_character) << text;
  return {reinterpret_cast<const char*>(result.bytes.data()), result.bytes.size()};
}

TEST(Base64, DecodesTheVectorsOfTheRfc) {
  EXPECT_EQ(decoded(""), "");
  EXPECT_EQ(decoded("Zg=="), "f");
  EXPECT_EQ(decoded("Zm8="), "fo");
  EXPECT_EQ(decoded("Zm9v"), "foo");
  EXPECT_EQ(decoded("Zm9vYg=="), "foob");
  EXPECT_EQ(decoded("Zm9vYmE="), "fooba");
  EXPECT_EQ(decoded("Zm9vYmFy"), "foobar");
  EXPECT_EQ(decoded("+/+/"), "\xfb\xff\xbf");
}

TEST(Base64, NamesTheFirstWrongCharacter) {
  EXPECT_EQ(decode_base64("Zm 9").wrong_character, 2u);
  EXPECT_EQ(decode_base64("Zm9v=m9v").wrong_character, 4u);
  EXPECT_EQ(decode_base64("Z===").wrong_character, 1u);
  EXPECT_EQ(decode_base64("Zm9").wrong_character, 3u);
  EXPECT_EQ(decode_base64("\xff\xff\xff\xff").wrong_character, 0u);
  EXPECT_EQ(decode_base64("=").wrong_character, 1u);
}

}  // namespace
}  // namespace flatpose::port
