// flatpose align SCAN --verify WORK.json

#include "port/linux/files/work_file.hpp"
#include "tests/port/linux/tool/workbench.hpp"

namespace flatpose::tool {
namespace {

class Verify : public Workbench {
 protected:
  Verify() {
    simulate("single", 1, "a.pcd");
    EXPECT_EQ(run({"align", path("a.pcd"), "-o", path("work.json")}).code, 0);
  }
  /// The alignment as it would have been, had the plane lain so much lower then.
  void lower(double by_mm) const {
    port::WorkFile work = port::read_work_file(path("work.json"));
    work.work_T_scan.position_mm.z += by_mm;
    port::write_work_file(path("lower.json"), work);
  }
};

TEST_F(Verify, HoldsInTheScanThatItIsOfAndInAnother) {
  const Ran same = run({"align", path("a.pcd"), "--verify", path("work.json")});
  EXPECT_EQ(same.code, 0) << same.err;
  EXPECT_NE(same.out.find("holds"), std::string::npos) << same.out;
  simulate("single", 2, "b.pcd");
  EXPECT_EQ(run({"align", path("b.pcd"), "--verify", path("work.json")}).code, 0);
}

TEST_F(Verify, TellsByHowMuchItMoved) {
  lower(3.25);
  const Ran moved = run({"align", path("a.pcd"), "--verify", path("lower.json")});
  EXPECT_EQ(moved.code, 1);
  EXPECT_NE(moved.out.find("does not hold"), std::string::npos) << moved.out;
  EXPECT_NE(moved.out.find("moved +3.25"), std::string::npos) << moved.out;
  const Words allowed{"align", path("a.pcd"), "--verify", path("lower.json"), "--max-shift", "3.3"};
  EXPECT_EQ(run(allowed).code, 0);
}

TEST_F(Verify, RefusesWhatMakesNoSense) {
  const std::string scan = path("a.pcd"), work = path("work.json");
  const bool is_plus = port::read_work_file(work).up == port::Up::kPlusZ;
  const std::string other_up = is_plus ? "-z" : "+z";
  expect_refused(run({"align", scan, "--verify", work, "-o", path("x")}), 2, "SCAN alone");
  expect_refused(run({"align", "--verify", work}), 2, "SCAN alone");
  expect_refused(run({"align", scan, "--verify", path("none")}), 2, "none");
  expect_refused(run({"align", scan, "--verify", work, "--up", other_up}), 2, "--up");
  expect_refused(run({"align", scan, "--verify", work, "--max-shift", "-1"}), 2, "--max-shift");
}

}  // namespace
}  // namespace flatpose::tool
