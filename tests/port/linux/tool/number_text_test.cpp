#include "port/linux/tool/number_text.hpp"

#include <gtest/gtest.h>

#include "tests/port/linux/files/temporary_folder.hpp"

namespace flatpose::tool {
namespace {

TEST(NumberText, AllOfTheTextMustBeTheNumber) {
  EXPECT_EQ(parse_number("--x", "-2.5e1", -100.0, 100.0), -25.0);
  EXPECT_EQ(parse_whole("--n", "-7", -10, 10), -7);
  EXPECT_EQ(parse_seed("--seed", "18446744073709551615"), UINT64_MAX);
  for (const char* text : {"", " 1", "1 ", "1x", "nan", "inf", "-inf", "1e999", "0x1", "1,5", "--"})
    port::expect_input_error([&] { (void)parse_number("--x", text, -1e300, 1e300); }, {"--x"});
  for (const char* text : {"", "1.0", "1e3", "99999999999999999999", "one"})
    port::expect_input_error([&] { (void)parse_whole("--n", text, 0, 1000); }, {"--n"});
  for (const char* text : {"-1", "18446744073709551616", "1.5"})
    port::expect_input_error([&] { (void)parse_seed("--seed", text); }, {"--seed"});
}

TEST(NumberText, BoundsBelongToTheRange) {
  EXPECT_EQ(parse_number("--x", "1", 0.0, 1.0), 1.0);
  EXPECT_EQ(parse_whole("--n", "64", 1, 64), 64);
  port::expect_input_error([] { (void)parse_number("--x", "1.0001", 0.0, 1.0); },
                           {"out of range", "0 to 1"});
  port::expect_input_error([] { (void)parse_whole("--n", "65", 1, 64); }, {"1 to 64"});
}

TEST(NumberText, ListsHaveTheirCount) {
  EXPECT_EQ(parse_numbers("--origin", "-4,77.5", 2, "X,Y"), (std::vector<double>{-4.0, 77.5}));
  port::expect_input_error([] { (void)parse_numbers("--origin", "1,2,3", 2, "X,Y"); }, {"X,Y"});
  port::expect_input_error([] { (void)parse_numbers("--origin", "1", 2, "X,Y"); }, {"X,Y"});
}

TEST(NumberText, FormattedTextIsNotCut) {
  EXPECT_EQ(formatted("%s-%d", std::string(500, 'a').c_str(), 7).size(), 502U);
  EXPECT_EQ(formatted("%s", ""), "");
}

}  // namespace
}  // namespace flatpose::tool
