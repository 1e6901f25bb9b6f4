#include "port/linux/daemon/section.hpp"

#include <gtest/gtest.h>

#include "port/linux/daemon/spelling.hpp"
#include "tests/port/linux/files/temporary_folder.hpp"

namespace flatpose::daemon {
namespace {

Section of(const std::string& text) { return Section::of_text("/etc/flatpose/f.toml", text); }

TEST(Section, ResolvesPathsFromItsOwnFolder) {
  Section file = of("a = \"parts/pad.fpt\"\nb = \"/data/pad.fpt\"\nc = \"\"\nd = 5\n");
  EXPECT_EQ(file.file("a"), "/etc/flatpose/parts/pad.fpt");
  EXPECT_EQ(file.file("b"), "/data/pad.fpt");
  EXPECT_EQ(file.file("none"), std::nullopt);
  port::expect_input_error([&] { (void)file.file("c"); }, {"f.toml:3: "});
  port::expect_input_error([&] { (void)file.file("d"); }, {"f.toml:4: ", "quotes"});
  EXPECT_EQ(Section::of_text("f.toml", "a = \"pad.fpt\"").file("a"), "pad.fpt");
}

TEST(Section, ReadsNumbersWholeOrNot) {
  Section file = of("a = 1\nb = 0.25\nc = nan\nd = inf\ne = true\nf = -0.5\n");
  EXPECT_EQ(file.number("a", 0.0, 1.0), 1.0);
  EXPECT_EQ(file.number("b", 0.0, 1.0), 0.25);
  EXPECT_EQ(file.number("none", 0.0, 1.0), std::nullopt);
  for (const std::string key : {"c", "d", "e", "f"})
    port::expect_input_error([&] { (void)file.number(key, 0.0, 1.0); }, {"between 0 and 1"});
}

TEST(Section, ReadsListsOfSections) {
  Section file = of("[[job]]\nname = \"a\"\n[[job]]\nname = \"b\"\nnane = 1\n");
  std::vector<Section> jobs = file.sections("job");
  ASSERT_EQ(jobs.size(), 2U);
  EXPECT_EQ(jobs[0].text("name"), "a");
  EXPECT_EQ(jobs[1].text("name"), "b");
  EXPECT_NO_THROW(jobs[0].finish());
  EXPECT_NO_THROW(file.finish());
  port::expect_input_error([&] { jobs[1].finish(); },
                           {"f.toml:5: unknown key 'nane' in [[job]]; did you mean 'name'?"});
  port::expect_input_error([&] { jobs[1].fail("name", "no such part", "teach it"); },
                           {"f.toml:4: no such part; teach it"});
  port::expect_input_error([&] { jobs[1].fail("part", "no part", "name one"); }, {"f.toml:3: "});
  EXPECT_TRUE(of("").sections("job").empty());
  port::expect_input_error([&] { (void)of("[job]\n").sections("job"); }, {"f.toml:1: ", "[[job]]"});
  port::expect_input_error([&] { (void)of("job = [1]\n").sections("job"); }, {"[[job]]"});
}

TEST(Section, ThatIsNotThereIsEmpty) {
  Section none = of("").section("search");
  EXPECT_EQ(none.whole("threads", {1, 2}), std::nullopt);
  EXPECT_EQ(none.flag("x"), std::nullopt);
  EXPECT_TRUE(none.wholes("y", {}, 3).empty());
  EXPECT_NO_THROW(none.finish());
  port::expect_input_error([&] { (void)of("x = [1, 2, 3]\n").wholes("x", {}, 2); }, {"2 at most"});
}

TEST(NearestWord, IsTheOneThatMayBeMeant) {
  const std::vector<std::string> known{"priority", "cpus", "lock_memory"};
  EXPECT_EQ(nearest_word("priority", known), "priority");
  EXPECT_EQ(nearest_word("piority", known), "priority");
  EXPECT_EQ(nearest_word("prioirty", known), "priority");
  EXPECT_EQ(nearest_word("cpu", known), "cpus");
  EXPECT_EQ(nearest_word("lockmemory", known), "lock_memory");
  EXPECT_EQ(nearest_word("frame", known), "");
  EXPECT_EQ(nearest_word("", known), "");
  EXPECT_EQ(nearest_word("x", {}), "");
  EXPECT_EQ(nearest_word(std::string(100'000, 'x'), known), "");
}

}  // namespace
}  // namespace flatpose::daemon
