#include "port/linux/files/work_file.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "port/linux/files/atomic_file.hpp"
#include "tests/port/linux/files/made_files.hpp"
#include "tests/port/linux/files/temporary_folder.hpp"

namespace flatpose::port {
namespace {

WorkFile some_work() {
  return {{rotation_from_vector({3.0, 0.1, -0.2}), {1.0 / 3.0, -1e-7, 299.25}},
          Up::kMinusZ,
          WorkQuality{0.0123, 0.75, 123456}};
}

TEST(WorkFile, ReadsBackWhatIsWritten) {
  const TemporaryFolder folder;
  const std::string path = folder.path("work.json");
  const WorkFile work = some_work();
  write_work_file(path, work);
  const WorkFile back = read_work_file(path);
  EXPECT_EQ(back.work_T_scan.rotation.m, work.work_T_scan.rotation.m);
  EXPECT_EQ(back.work_T_scan.position_mm, work.work_T_scan.position_mm);
  EXPECT_EQ(back.up, Up::kMinusZ);
  ASSERT_TRUE(back.quality);
  EXPECT_EQ(back.quality->plane_rms_mm, 0.0123);
  EXPECT_EQ(back.quality->inlier_share, 0.75);
  EXPECT_EQ(back.quality->inlier_count, 123456);
}

TEST(WorkFile, ReadsAFileWrittenByHand) {
  const TemporaryFolder folder;
  const WorkFile work =
      read_work_file(folder.write("w", R"({"format": "flatpose-work", "version": 1,
      "up": "+z", "work_T_scan": {"position_mm": [0, 0, -5], "rotation": [1,0,0, 0,1,0, 0,0,1]}})"));
  EXPECT_EQ(work.up, Up::kPlusZ);
  EXPECT_EQ(work.work_T_scan.position_mm, (Vec3{0, 0, -5}));
  EXPECT_FALSE(work.quality);
}

TEST(WorkFile, RefusesToWriteWhatCannotBeRead) {
  const TemporaryFolder folder;
  WorkFile work = some_work();
  work.work_T_scan.position_mm.x = std::numeric_limits<double>::quiet_NaN();
  expect_input_error([&] { write_work_file(folder.path("w"), work); }, {"finite rigid pose"});
  work = some_work();
  work.work_T_scan.rotation.m[0] *= 2;
  expect_input_error([&] { write_work_file(folder.path("w"), work); }, {"finite rigid pose"});
  work = some_work();
  work.quality->plane_rms_mm = std::numeric_limits<double>::infinity();
  expect_input_error([&] { write_work_file(folder.path("w"), work); }, {"quality"});
  EXPECT_EQ(folder.file_count(), 0u);
}

TEST(WorkFile, NamesWhatIsWrong) {
  const TemporaryFolder folder;
  const std::string good = R"({"format": "flatpose-work", "version": 1, "up": "+z", "work_T_scan":
      {"position_mm": [0, 0, -5], "rotation": [1,0,0, 0,1,0, 0,0,1]},
      "quality": {"plane_rms_mm": 0.1, "inlier_share": 0.5, "inlier_count": 9}})";
  const auto refused = [&](std::string_view from, std::string_view to,
                           std::initializer_list<std::string_view> parts) {
    const std::string path = folder.write("w.json", replaced(good, from, to));
    expect_input_error([&] { (void)read_work_file(path); }, parts);
  };
  refused("flatpose-work", "other", {"is no work file", "flatpose align"});
  refused("\"flatpose-work\"", "1", {"is no work file"});
  refused("1, \"up\"", "2, \"up\"", {"version 2 is not the known 1", "newer flatpose"});
  refused("+z", "z", {"up is neither"});
  refused("\"up\": \"+z\",", "", {"has no \"up\""});
  refused("-5]", "-5, 0]", {"position_mm is not a list of 3"});
  refused("-5]", "\"-5\"]", {"position_mm[2] is not a number"});
  refused("-5]", "2e6]", {"position_mm[2] lies beyond"});
  refused("-5]", "1e999]", {"correct the file"});
  refused("[1,0,0,", "[-1,0,0,", {"rotation is no rotation", "determinant"});
  refused("[1,0,0,", "[1.00001,0,0,", {"rotation is no rotation"});
  refused("[1,0,0,", "[1,0.00001,0,", {"rotation is no rotation"});
  refused("[1,0,0,", "[1e200,0,0,", {"rotation is no rotation"});
  refused("[1,0,0,", "[0,0,", {"rotation is not a list of 9"});
  refused("0.1", "-0.1", {"plane_rms_mm is below 0"});
  refused("0.5", "1.5", {"inlier_share is not 0 to 1"});
  refused(": 9", ": -9", {"inlier_count is not a whole number"});
  refused(": 9", ": 18446744073709551615", {"inlier_count is too large"});
  for (std::size_t size = 0; size < good.size(); ++size) {
    const std::string path = folder.write("w.json", good.substr(0, size));
    expect_input_error([&] { (void)read_work_file(path); }, {"w.json"});
  }
}

}  // namespace
}  // namespace flatpose::port
