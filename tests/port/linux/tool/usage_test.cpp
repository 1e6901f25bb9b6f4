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
  EXPECT_EQ(run_tool(Words{"--help"}, out, err), 2);
  EXPECT_EQ(err.str().rfind("flatpose: stdout: ", 0), 0U);
}

}  // namespace
}  // namespace flatpose::tool
