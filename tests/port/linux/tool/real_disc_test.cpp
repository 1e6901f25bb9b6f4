// The plate of a real sensor through the tool; the reference was measured from the clouds.

#include <cmath>
#include <filesystem>

#include "flatpose/core/maths.hpp"
#include "tests/port/linux/tool/workbench.hpp"

namespace flatpose::tool {
namespace {

class RealDisc : public Workbench {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("FLATPOSE_REAL_DATA");
    data_ = folder != nullptr ? folder : FLATPOSE_REAL_DATA_DEFAULT;
    if (std::filesystem::is_directory(data_)) return;
    if (std::getenv("CI") != nullptr) FAIL() << data_ << " is missing";
    GTEST_SKIP() << data_ << " is missing";
  }
  std::string data_;
};

TEST_F(RealDisc, TurnsAsTheReferenceSays) {
  std::ifstream file(data_ + "/sick_disc/reference_pose.json");
  const json reference = json::parse(file);
  const json& tolerance = reference.at("tolerance");
  Pose match_T_teach;
  for (std::size_t i = 0; i < 9; ++i)
    match_T_teach.rotation.m[i] = reference.at("T_match_from_teach").at("R")[i / 3][i % 3];
  const json& t = reference.at("T_match_from_teach").at("t_mm");
  match_T_teach.position_mm = {t[0], t[1], t[2]};

  const Ran taught =
      run({"teach", data_ + "/sick_disc/disc_teach.pcd", "--region", "circle:-4,77.2,66",
           "--origin", "-4.009,77.207", "-o", path("disc.fpt"), "--json"});
  ASSERT_EQ(taught.code, 0) << taught.err;
  const Ran located =
      run({"locate", path("disc.fpt"), data_ + "/sick_disc/disc_match.pcd", "--json"});
  ASSERT_EQ(located.code, 0) << located.err;
  const json found = json::parse(located.out);
  EXPECT_EQ(found.at("up"), "-z");
  const Pose expected = match_T_teach * pose_of(json::parse(taught.out).at("taught_pose"));
  const Pose pose = pose_of(found.at("matches")[0]);
  const Vec3 off_mm = pose.position_mm - expected.position_mm;
  EXPECT_LT(std::hypot(off_mm.x, off_mm.y), tolerance.at("in_plane_mm").get<double>());
  EXPECT_LT(std::fabs(off_mm.z), tolerance.at("z_mm").get<double>());
  const Rotation off = expected.rotation.inverse() * pose.rotation;
  EXPECT_LT(std::fabs(std::atan2(off.m[3], off.m[0])) * kDegPerRad,
            tolerance.at("yaw_deg").get<double>());
  EXPECT_LT(arc_cosine(off.m[8]) * kDegPerRad, tolerance.at("tilt_deg").get<double>());
}

}  // namespace
}  // namespace flatpose::tool
