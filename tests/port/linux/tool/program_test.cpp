// The program itself, as a shell runs it: exit codes, stdout and stderr apart.

#include <sys/wait.h>

#include "tests/port/linux/tool/workbench.hpp"

namespace flatpose::tool {
namespace {

class Program : public Workbench {
 protected:
  Ran run_program(const std::string& words, const std::string& before = {}) {
    const std::string line = before + "'" + FLATPOSE_PROGRAM + "' " + words + " >'" + path("out") +
                             "' 2>'" + path("err") + "'";
    const int status = std::system(line.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read("out"), read("err")};
  }
};

TEST_F(Program, SimulatesTeachesAndLocates) {
  const std::string scan = "'" + path("a.pcd") + "'";
  const std::string part = "'" + path("a.fpt") + "'";
  const Ran made = run_program("simulate single --seed 3 --cols 300 --rows 250 -o " + scan +
                               " --truth '" + path("a.json") + "'");
  EXPECT_EQ(made.code, 0) << made.err;
  EXPECT_EQ(run_program("teach " + scan + " -o " + part).code, 0);
  const Ran found =
      run_program("locate " + part + " " + scan + " --json --overlay '" + path("a.png") + "'");
  EXPECT_EQ(found.code, 0) << found.err;
  EXPECT_EQ(found.err, "");
  EXPECT_EQ(json::parse(found.out).at("matches").size(), 1U);
}

TEST_F(Program, FileSizeLimitIsAWriteError) {
  const std::string make = "simulate single --seed 3 --cols 200 --rows 160 -o '" + path("a.pcd");
  expect_refused(run_program(make + "'", "ulimit -f 8; "), 2, "a.pcd: cannot write it");
  EXPECT_FALSE(std::filesystem::exists(path("a.pcd")));
}

TEST_F(Program, FailsInOneLine) {
  expect_refused(run_program("locate a.fpt b.pcd --bogus"), 2, "--bogus");
  expect_refused(run_program("info '" + path("missing") + "'"), 2, "missing");
  expect_refused(run_program(""), 2);
}

}  // namespace
}  // namespace flatpose::tool
