#pragma once
// A config around the example's part and scan, served; and what the library finds there itself.

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "flatpose/geometry/robot_convention.hpp"
#include "flatpose/locate/locator.hpp"
#include "port/linux/clock/steady_clock.hpp"
#include "port/linux/daemon/config.hpp"
#include "port/linux/daemon/job_set.hpp"
#include "port/linux/files/scan.hpp"
#include "tests/port/linux/daemon/running_daemon.hpp"
#include "tests/port/linux/files/temporary_folder.hpp"

namespace flatpose::daemon {

using result_map::Field;

inline const std::string kScan = FLATPOSE_EXAMPLE "/scan.pcd";
inline const std::string kTeach = FLATPOSE_EXAMPLE "/teach.pcd";

class Served : public testing::Test {
 protected:
  std::string write_config(const std::string& more_of_source, const std::string& more_of_job = {},
                           const std::string& more = {}) const {
    return folder_.write(
        "f.toml",
        "[modbus]\nbind = \"127.0.0.1\"\nport = 0\n"
        "[search]\nscan_width_px = 400\nscan_height_px = 333\ncell_count = 600_000\n"
        "[source]\n" +
            more_of_source + "\n[[part]]\nname = \"pad\"\nfile = \"" +
            FLATPOSE_EXAMPLE "/pad.fpt\"\n[[job]]\nparts = [\"pad\"]\n" + more_of_job + "\n" +
            more);
  }
  std::string dry_run(const std::string& more_of_job = {}, const std::string& more = {}) const {
    return write_config("allow_simulated = true\nreplay = \"" + kScan + "\"", more_of_job, more);
  }
  /// What the library finds there by the same config.
  static std::unique_ptr<locate::LocateResult> located(const std::string& config_path,
                                                       const std::string& scan_path) {
    const Config config = load_config(config_path);
    const JobSet jobs = load_jobs(config);
    const port::Scan scan = port::read_scan(scan_path);
    std::vector<std::byte> memory(locate::Locator::required_bytes(config.search.limits));
    locate::Locator locator;
    auto result = std::make_unique<locate::LocateResult>();
    locate::LocateConfig search = config.jobs.at(0).locate;
    search.deadline_us = 0;
    EXPECT_EQ(locator.init(config.search.limits, memory), Status::kOk);
    EXPECT_EQ(locator.locate(*jobs.parts.at(0).model, scan.view(),
                             frames_of_scan(scan.up == port::Up::kPlusZ), search,
                             port::SteadyClock(), *result),
              Status::kOk);
    return result;
  }
  static void expect_pose(const Plc::Block& block, const Pose& pose, Convention convention) {
    const auto numbers = rotation_numbers(pose.rotation, convention).value;
    const double per_rad = is_euler(convention) ? 180.0 / M_PI / 0.001 : 1e6;
    EXPECT_EQ(block[Field::kPositionX], std::floor(pose.position_mm.x / 0.001 + 0.5));
    EXPECT_EQ(block[Field::kPositionY], std::floor(pose.position_mm.y / 0.001 + 0.5));
    EXPECT_EQ(block[Field::kPositionZ], std::floor(pose.position_mm.z / 0.001 + 0.5));
    EXPECT_NEAR(static_cast<double>(block[Field::kRotation1]), numbers[0] * per_rad, 0.501);
    EXPECT_NEAR(static_cast<double>(block[Field::kRotation2]), numbers[1] * per_rad, 0.501);
    EXPECT_NEAR(static_cast<double>(block[Field::kRotation3]), numbers[2] * per_rad, 0.501);
    EXPECT_NEAR(static_cast<double>(block[Field::kRotation4]), numbers[3] * per_rad, 0.501);
  }

  port::TemporaryFolder folder_;
};

}  // namespace flatpose::daemon
