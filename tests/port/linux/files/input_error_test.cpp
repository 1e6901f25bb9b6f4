#include "port/linux/files/input_error.hpp"

#include <gtest/gtest.h>

#include "tests/port/linux/files/temporary_folder.hpp"

namespace flatpose::port {
namespace {

TEST(Printable, EscapesWhatBreaksALineOrATerminal) {
  EXPECT_EQ(printable("a\nb\t\x1b[31m\x7f", 100), "a\\x0ab\\x09\\x1b[31m\\x7f");
  EXPECT_EQ(printable(std::string("a\0b", 3), 100), "a\\x00b");
  EXPECT_EQ(printable("\xc2\x85", 100), "\\xc2\\x85");           // next line, C1
  EXPECT_EQ(printable("\xe2\x80\xa8", 100), "\\xe2\\x80\\xa8");  // line separator
  EXPECT_EQ(printable("\xe2\x80\xae", 100), "\\xe2\\x80\\xae");  // right-to-left override
}

TEST(Printable, KeepsUtf8AndEscapesBrokenUtf8) {
  EXPECT_EQ(printable("Bremsbeläge €𝄞", 100), "Bremsbeläge €𝄞");
  EXPECT_EQ(printable("\xff", 100), "\\xff");
  EXPECT_EQ(printable("\xc3", 100), "\\xc3");
  EXPECT_EQ(printable("\xc0\xaf", 100), "\\xc0\\xaf");           // overlong
  EXPECT_EQ(printable("\xed\xa0\x80", 100), "\\xed\\xa0\\x80");  // surrogate
  EXPECT_EQ(printable("\xf4\x90\x80\x80", 100), "\\xf4\\x90\\x80\\x80");
}

TEST(Printable, LosesTheMiddleOfWhatIsTooLong) {
  EXPECT_EQ(printable("abcdefghij", 10), "abcdefghij");
  EXPECT_EQ(printable("abcdefghijk", 10), "abc...ijk");
  EXPECT_EQ(printable(std::string(50, '\n'), 20), "\\x0a\\x0a...\\x0a\\x0a");
  EXPECT_LE(printable(std::string(10'000'000, 'x'), 100).size(), 100u);
}

TEST(Printable, IsBoundedAndCleanForRandomBytes) {
  std::uint64_t state = 7;
  for (int i = 0; i < 2000; ++i) {
    std::string text;
    for (int k = 0; k < i % 97; ++k) {
      state = state * 6364136223846793005u + 1442695040888963407u;
      text += static_cast<char>(state >> 56);
    }
    const std::string line = printable(text, 40);
    EXPECT_LE(line.size(), 40u);
    for (const char c : line) EXPECT_GE(static_cast<unsigned char>(c), 0x20);
    EXPECT_EQ(printable(line, 40), line);
  }
}

TEST(InputError, IsOneLineOfWhatWhyRemedy) {
  const InputError error("a\nb.pcd", "cut off", "copy it again");
  EXPECT_STREQ(error.what(), "a\\x0ab.pcd: cut off; copy it again");
  const std::string endless(100'000, 'p');
  expect_one_line(InputError(endless, endless, endless).line());
}

}  // namespace
}  // namespace flatpose::port
