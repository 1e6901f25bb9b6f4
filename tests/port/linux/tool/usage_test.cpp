#include "tests/port/linux/tool/workbench.hpp"

namespace flatpose::tool {
namespace {

TEST(Usage, WrongCommandLinesAreOneLineAndExitCodeTwo) {
  const Words lines[] = {
      {},
      {"bogus"},
      {"--bogus"},
      {"locate"},
      {"locate", "a.fpt"},
      {"locate", "a.fpt", "b.pcd", "c.pcd"},
      {"locate", "a.fpt", "b.pcd", "--bogus"},
      {"locate", "--bogus"},
      {"locate", "a.fpt", "b.pcd", "--json", "--max-matches"},
      {"locate", "a.fpt", "b.pcd", "--max-matches", "0"},
      {"locate", "a.fpt", "b.pcd", "--max-matches", "65"},
      {"locate", "a.fpt", "b.pcd", "--max-matches", "2.5"},
      {"locate", "a.fpt", "b.pcd", "--min-score", "1.1"},
      {"locate", "a.fpt", "b.pcd", "--min-score", "-0.1"},
      {"locate", "a.fpt", "b.pcd", "--min-visible", "nan"},
      {"locate", "a.fpt", "b.pcd", "--max-tilt", "90"},
      {"locate", "a.fpt", "b.pcd", "--max-tilt", "inf"},
      {"locate", "a.fpt", "b.pcd", "--order", "best"},
      {"locate", "a.fpt", "b.pcd", "--up", "up"},
      {"locate", "a.fpt", "b.pcd", "--region", "circle:0,0,-1"},
      {"locate", "a.fpt", "b.pcd", "--resolution", "0"},
      {"locate", "a.fpt", "b.pcd", "--threads", "0"},
      {"locate", "a.fpt", "b.pcd", "--deadline-ms", "soon"},
      {"locate", "a.fpt", "b.pcd", "--max-points", "-4"},
      {"locate", "a.fpt", "b.pcd", "--min-score", "0.5", "--min-score", "0.6"},
      {"teach"},
      {"teach", "a.pcd"},
      {"teach", "-o", "a.fpt"},
      {"teach", "a.pcd", "-o", "a.fpt", "--symmetry", "0"},
      {"teach", "a.pcd", "-o", "a.fpt", "--symmetry", "65"},
      {"teach", "a.pcd", "-o", "a.fpt", "--symmetry", "half"},
      {"teach", "a.pcd", "-o", "a.fpt", "--origin", "1"},
      {"teach", "a.pcd", "-o", "a.fpt", "--origin", "1,nan"},
      {"teach", "a.pcd", "-o", "a.fpt", "--x-axis", "0,0"},
      {"test", "a.fpt"},
      {"align", "a.pcd"},
      {"info"},
      {"info", "a", "b"},
      {"simulate", "single", "-o", "a.pcd"},
      {"simulate", "single", "--seed", "-1", "-o", "a.pcd"},
      {"simulate", "single", "--seed", "1", "-o", "a.pcd", "--cols", "1"},
      {"simulate", "single", "--seed", "1", "-o", "a.pcd", "--lost", "2"},
  };
  for (const Words& words : lines) {
    SCOPED_TRACE(testing::PrintToString(words));
    expect_refused(run(words), 2);
  }
}

// CLI11 would take each of these for "not given".
TEST(Usage, EmptyIsNotTheSameAsNotGiven) {
  const Words located{"locate", "a.fpt", "b.pcd", "--json"};
  for (const Words& more : {Words{"--work", ""}, Words{"--work="}, Words{"--overlay="},
                            Words{"--overlay=", "--threads", "1"}, Words{"--region", ""}, Words{""},
                            Words{"--", ""}, Words{"--json="}}) {
    SCOPED_TRACE(testing::PrintToString(more));
    Words words = located;
    words.insert(words.end(), more.begin(), more.end());
    expect_refused(run(words), 2, "empty; give a value or leave it out");
  }
  expect_refused(run({"teach", "a.pcd", "-o", ""}), 2, "flatpose: -o: ");
  expect_refused(run({"teach", "a.pcd", "-o", "a.fpt", "--name="}), 2, "flatpose: --name: ");
  expect_refused(run({"teach", "a.pcd", "-o", "a.fpt", "--mask", ""}), 2, "flatpose: --mask: ");
  expect_refused(run({""}), 2, "an argument is empty");
  // After a lone -- it is the name of a file, if an odd one.
  expect_refused(run({"info", "--", "--odd="}), 2, "flatpose: --odd=: cannot read it");
}

TEST(Usage, OptionsThatDoNotGoTogether) {
  const Words taught{"teach", "a.pcd", "-o", "a.fpt"};
  const auto with = [&](const Words& more) {
    Words words = taught;
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  };
  expect_refused(with({"--mask", "m.png", "--region", "circle:0,0,9"}), 2, "--region");
  expect_refused(with({"--region", "circle:0,0,9", "--mask", "m.png"}), 2, "--mask");
  expect_refused(with({"--symmetry-center", "1,2"}), 2, "--symmetry");
  // Alone, or with its like, each is understood: what is missing then is the scan.
  for (const Words& more :
       {Words{"--mask", "m.png"}, Words{"--region", "circle:0,0,9"},
        Words{"--symmetry-center", "1,2", "--symmetry", "2"}, Words{"--symmetry", "2"}})
    expect_refused(with(more), 2, "a.pcd: cannot read it");
}

TEST(Usage, StrayWordsAreNamed) {
  expect_refused(run({"bogus"}), 2, "unknown command \"bogus\"");
  expect_refused(run({"locate", "--bogus"}), 2, "unknown option \"--bogus\"");
  expect_refused(run({"info", "a", "b"}), 2, "unknown argument \"b\"");
  expect_refused(run({"info", "a", "--x\n\033[31m"}), 2, "\\x0a\\x1b[31m");
}

TEST(Usage, HelpIsPrintedAndNoError) {
  for (const Words& words : {Words{"--help"}, Words{"locate", "--help"}, Words{"--version"}}) {
    const Ran ran = run(words);
    EXPECT_EQ(ran.code, 0);
    EXPECT_NE(ran.out.find("flatpose"), std::string::npos);
    EXPECT_EQ(ran.err, "");
  }
  EXPECT_NE(run({"locate", "--help"}).out.find("--overlay"), std::string::npos);
}

TEST(Usage, UnknownSceneOrPartListsTheKnown) {
  const port::TemporaryFolder folder;
  const std::string scan = folder.path("a.pcd");
  expect_refused(run({"simulate", "chaos", "--seed", "1", "-o", scan}), 2, "single");
  expect_refused(run({"simulate", "single", "--part", "egg", "--seed", "1", "-o", scan}), 2, "pad");
  EXPECT_EQ(folder.file_count(), 0U);
}

TEST(Usage, BrokenStdoutIsAnError) {
  const port::TemporaryFolder folder;
  std::ostringstream out;
  std::ostringstream err;
  out.setstate(std::ios::badbit);
  EXPECT_EQ(run_tool(Words{"--help"}, out, err, daemon::read_served_map), 2);
  EXPECT_EQ(err.str().rfind("flatpose: stdout: ", 0), 0U);
}

}  // namespace
}  // namespace flatpose::tool
