// [[job]]: what a master may ask for.

#include <algorithm>

#include "flatpose/core/maths.hpp"
#include "flatpose/job/order.hpp"
#include "port/linux/daemon/config.hpp"
#include "port/linux/daemon/rotation_setting.hpp"
#include "port/linux/daemon/section.hpp"
#include "port/linux/files/input_error.hpp"
#include "port/linux/records/record.hpp"
#include "port/linux/tool/region_text.hpp"
#include "port/linux/tool/work_plane.hpp"

namespace flatpose::daemon {
namespace {

constexpr std::size_t kPartsPerJobMax = port::kPartsPerSearchMax;
constexpr Range kJobs{1, 65535};
constexpr Range kTimes_ms{1, 3'600'000};
constexpr Range kAges_ms{0, 3'600'000};
constexpr Range kMatches{1, job::kMatchesPerScanMax};
constexpr double kTiltMax_deg = 68.0;
constexpr double kReachMax_mm = 1.0e6;
constexpr std::int64_t kUsPerMs = 1000;

// In the order of the enumerations.
const std::vector<std::string> kFrames{"scan", "work", "robot"};
const std::vector<std::string> kOrders{"score", "height", "visible"};
const std::vector<std::string> kPoses{"object", "pick"};

// Two numbers, the lesser first; nothing there: as they are.
void read_range(Section& section, const std::string& key, double& least, double& greatest) {
  const auto pair = section.numbers(key, -kReachMax_mm, kReachMax_mm, 2);
  if (pair.empty()) return;
  if (pair[0] > pair[1]) section.fail(key, "'" + key + "' runs backwards", "give the least first");
  least = pair[0];
  greatest = pair[1];
}

void read_parts_of(Section& section, const Config& config, JobConfig& job) {
  for (const std::string& name : section.texts("parts", kPartsPerJobMax)) {
    const auto found = std::find_if(config.parts.begin(), config.parts.end(),
                                    [&](const PartConfig& part) { return part.name == name; });
    if (found == config.parts.end())
      section.fail("parts", "there is no part \"" + port::printable(name, 60) + "\"",
                   "add a [[part]] with this name");
    job.parts.push_back(static_cast<int>(found - config.parts.begin()));
  }
  if (job.parts.empty()) section.fail("parts", "a job needs 'parts'", "write parts = [\"NAME\"]");
}

void read_rule(Section& section, job::JobRule& rule) {
  rule.job = static_cast<std::uint16_t>(section.whole("number", kJobs).value_or(1));
  rule.frame = static_cast<job::FrameName>(section.choice("frame", kFrames).value_or(0));
  rule.convention =
      static_cast<Convention>(section.choice("convention", convention_words()).value_or(0));
  if (const auto reference =
          read_rotation_numbers(section, "reference_rotation", rule.convention)) {
    rule.has_reference = true;
    rule.reference = *reference;
  }
  rule.max_age_us = section.whole("max_age_ms", kAges_ms).value_or(0) * kUsPerMs;
  rule.answer_by_us = section.whole("answer_by_ms", kTimes_ms).value_or(10'000) * kUsPerMs;
}

void read_search_of(Section& section, JobConfig& job) {
  locate::LocateConfig& locate = job.locate;
  const std::int64_t usual_ms =
      std::max<std::int64_t>(job.rule.answer_by_us / kUsPerMs * 9 / 10, 1);
  locate.deadline_us = section.whole("deadline_ms", kTimes_ms).value_or(usual_ms) * kUsPerMs;
  locate.max_matches = static_cast<int>(section.whole("max_matches", kMatches).value_or(1));
  locate.min_score = section.number("min_score", 0.0, 1.0).value_or(locate.min_score);
  locate.min_visible = section.number("min_visible", 0.0, 1.0).value_or(locate.min_visible);
  if (const auto tilt_deg = section.number("max_tilt_deg", 0.0, kTiltMax_deg))
    locate.max_tilt_rad = *tilt_deg * kRadPerDeg;
  locate.order = static_cast<locate::Order>(section.choice("order", kOrders).value_or(0));
  read_range(section, "height_mm", locate.height_min_mm, locate.height_max_mm);
  for (const std::string& text : section.texts("exclusions", locate::kExclusionCountMax))
    job.exclusions.push_back(
        tool::parse_region(section.place_of("exclusions") + ": exclusions", text));
  const auto region = section.text("region");
  if (region) locate.region = tool::parse_region(section.place_of("region") + ": region", *region);
}

void read_limits(Section& section, PoseLimits& limits) {
  read_range(section, "limit_x_mm", limits.least_mm.x, limits.greatest_mm.x);
  read_range(section, "limit_y_mm", limits.least_mm.y, limits.greatest_mm.y);
  read_range(section, "limit_z_mm", limits.least_mm.z, limits.greatest_mm.z);
  if (const auto tilt_deg = section.number("limit_tilt_deg", 0.0, 90.0))
    limits.tilt_rad = *tilt_deg * kRadPerDeg;
}

void read_report(Section& section, const Config& config, JobConfig& job) {
  read_limits(section, job.report.limits);
  if (const auto angle_deg = section.number("preferred_angle_deg", -360.0, 360.0))
    job.report.preferred_angle_rad = *angle_deg * kRadPerDeg;
  const bool has_picks = std::any_of(job.parts.begin(), job.parts.end(), [&](int part) {
    return !config.parts[static_cast<std::size_t>(part)].picks.empty();
  });
  const bool is_usually_pick = has_picks || job.rule.frame == job::FrameName::kRobot;
  job.report.kind =
      static_cast<PoseKind>(section.choice("pose", kPoses).value_or(is_usually_pick ? 1 : 0));
}

}  // namespace

void read_job(Section section, Config& config) {
  JobConfig job;
  read_rule(section, job.rule);
  read_parts_of(section, config, job);
  read_search_of(section, job);
  read_report(section, config, job);
  job.work_file = section.file("work").value_or("");
  job.robot_file = section.file("alignment").value_or("");
  job.verify_shift_mm = section.number("verify_shift_mm", 0.0, 1000.0).value_or(tool::kShiftMax_mm);
  job.verify_tilt_rad =
      section.number("verify_tilt_deg", 0.0, 90.0).value_or(tool::kTiltMax_deg) * kRadPerDeg;
  const bool needs_work = job.rule.frame == job::FrameName::kWork;
  section.finish();
  if (needs_work && job.work_file.empty())
    section.fail("frame", "frame \"work\" needs the work plane",
                 "write work = \"WORK.json\", as flatpose align wrote it");
  if (!job.robot_file.empty() && job.rule.frame != job::FrameName::kRobot)
    section.fail("alignment", "'alignment' is of frame \"robot\" alone",
                 "write frame = \"robot\", or take it out");
  for (const JobConfig& other : config.jobs)
    if (other.rule.job == job.rule.job)
      section.fail("number", "there are two jobs of this number", "give each its own");
  if (config.jobs.size() == job::kJobCountMax)
    section.fail("number", "there are more than 64 jobs", "take some out");
  config.jobs.push_back(std::move(job));
}

}  // namespace flatpose::daemon
