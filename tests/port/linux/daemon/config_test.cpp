#include "port/linux/daemon/config.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/port/linux/files/temporary_folder.hpp"

namespace flatpose::daemon {
namespace {

constexpr const char* kPath = "dir/f.toml";

void expect_refused(const std::string& text, std::initializer_list<std::string_view> parts) {
  SCOPED_TRACE(text);
  port::expect_input_error([&] { (void)parse_config(kPath, text); }, parts);
}

TEST(Config, IsAllUsualWhenEmpty) {
  const Config config = parse_config(kPath, "");
  EXPECT_EQ(config.search.thread_count, 1);
  EXPECT_EQ(config.search.limits.scan_width_px, 1536);
  EXPECT_EQ(config.search.limits.scan_height_px, 1280);
  EXPECT_EQ(config.search.limits.cell_count, 4'000'000);
  EXPECT_EQ(config.search.max_scan_bytes, 268'435'456);
  EXPECT_TRUE(config.realtime.cpus.empty());
  EXPECT_EQ(config.realtime.priority, 0);
  EXPECT_FALSE(config.realtime.lock_memory);
  EXPECT_FALSE(config.realtime.cpu_latency_us);
  EXPECT_FALSE(config.realtime.timer_slack_ns);
}

TEST(Config, HoldsWhatIsGiven) {
  const Config config = parse_config(kPath,
                                     "[realtime]\ncpus = [3, 2]\npriority = 80\n"
                                     "lock_memory = true\ncpu_latency_us = 0\n"
                                     "timer_slack_ns = 500\n"
                                     "[search]\nthreads = 2\nscan_width_px = 640\n"
                                     "scan_height_px = 480\ncell_count = 500_000\n"
                                     "max_scan_bytes = 0x1000000\n");
  EXPECT_EQ(config.search.thread_count, 2);
  EXPECT_EQ(config.search.limits.scan_width_px, 640);
  EXPECT_EQ(config.search.limits.scan_height_px, 480);
  EXPECT_EQ(config.search.limits.cell_count, 500'000);
  EXPECT_EQ(config.search.max_scan_bytes, 0x1000000);
  EXPECT_EQ(config.realtime.cpus, (std::vector<int>{3, 2}));
  EXPECT_EQ(config.realtime.priority, 80);
  EXPECT_TRUE(config.realtime.lock_memory);
  EXPECT_EQ(config.realtime.cpu_latency_us, 0);
  EXPECT_EQ(config.realtime.timer_slack_ns, 500);
}

TEST(Config, HasACanNodeWhenItsSectionIsThere) {
  EXPECT_FALSE(parse_config(kPath, "").can.is_on);
  const Config usual = parse_config(kPath, "[can]\n");
  EXPECT_TRUE(usual.can.is_on);
  EXPECT_EQ(usual.can.interface, "can0");
  EXPECT_EQ(usual.can.node.node, 10);
  EXPECT_EQ(usual.can.node.master, 127);
  EXPECT_EQ(usual.can.bit_rate_per_s, 0U);
  const Config given = parse_config(kPath,
                                    "[can]\ninterface = \"vcan1\"\nnode = 1\nmaster = 2\n"
                                    "heartbeat_ms = 3\nmaster_silence_ms = 4\n"
                                    "bit_rate = 125_000\nserial = 5\n");
  EXPECT_EQ(given.can.interface, "vcan1");
  EXPECT_EQ(given.can.node.node, 1);
  EXPECT_EQ(given.can.node.master, 2);
  EXPECT_EQ(given.can.node.heartbeat_ms, 3);
  EXPECT_EQ(given.can.node.master_silence_ms, 4);
  EXPECT_EQ(given.can.bit_rate_per_s, 125'000U);
  EXPECT_EQ(given.can.node.serial, 5U);
  EXPECT_FALSE(usual.can.node.fd_frame);
  EXPECT_TRUE(usual.can.node.fd_bit_rate_switch);
  EXPECT_EQ(can::fd_report_id(usual.can.node), 0x50a);
  const Config fd = parse_config(kPath,
                                 "[can]\nnode = 3\nfd_frame = true\nfd_bit_rate_switch = false\n"
                                 "fd_frame_id = 0x6a1\nbit_rate = 500_000\n");
  EXPECT_TRUE(fd.can.node.fd_frame);
  EXPECT_FALSE(fd.can.node.fd_bit_rate_switch);
  EXPECT_EQ(can::fd_report_id(fd.can.node), 0x6a1);
  EXPECT_TRUE(fd.can.need().fd);
  EXPECT_EQ(fd.can.need().bit_rate_per_s, 500'000U);
  expect_refused("[can]\nfd_frame_id = 0x18a\n", {"dir/f.toml:2: ", "0x680 to 0x6DF"});
  expect_refused("[can]\nfd_frame_id = 0x701\n", {"dir/f.toml:2: ", "'fd_frame_id' is 0x701"});
  expect_refused("[can]\nfd_frame_id = 0\n", {"dir/f.toml:2: ", "'fd_frame_id' is 0"});
  expect_refused("[can]\ninterface = \"\"\n", {"dir/f.toml:2: ", "'interface' is \"\""});
  expect_refused("[can]\ninterface = \"a-name-too-long0\"\n", {"dir/f.toml:2: ", "1 to 15"});
  expect_refused("[can]\nfd_frame = 1\n", {"dir/f.toml:2: "});
  expect_refused("[can]\nnode = 128\n", {"dir/f.toml:2: ", "1 and 127"});
  expect_refused("[can]\nnode = 5\nmaster = 5\n", {"dir/f.toml:3: ", "the same"});
  expect_refused("[can]\nheartbeat_ms = 65536\n", {"dir/f.toml:2: "});
  expect_refused("[modbus]\nhandshake = \"bits\"\n[can]\n", {"dir/f.toml:3: ", "handshake"});
  expect_refused("[can]\nnod = 5\n", {"dir/f.toml:2: ", "node"});
}

TEST(Config, NamesFileLineAndRemedy) {
  expect_refused("[realtime]\n\npriority = 100\n",
                 {"dir/f.toml:3: 'priority' is 100; give a number between 0 and 99"});
  expect_refused("[search]\nthreads = 0\n", {"dir/f.toml:2: "});
  expect_refused("[search]\nthreads = 1.5\n", {"dir/f.toml:2: ", "not a whole number"});
  expect_refused("[search]\nscan_width_px = \"640\"\n", {"dir/f.toml:2: "});
  expect_refused("[search]\ncell_count = 99999999999\n", {"dir/f.toml:2: "});
  expect_refused("[realtime]\nlock_memory = 1\n", {"dir/f.toml:2: ", "true nor false"});
  expect_refused("[realtime]\ncpus = 2\n", {"dir/f.toml:2: ", "not a list", "cpus = [1, 2]"});
  expect_refused("[realtime]\ncpus = [\n 2,\n \"x\"]\n", {"dir/f.toml:4: "});
  expect_refused("[realtime]\ncpus = [-1]\n", {"dir/f.toml:2: "});
  expect_refused("[realtime]\ncpu_latency_us = -1\n", {"dir/f.toml:2: "});
  expect_refused("search = 5\n", {"dir/f.toml:1: 'search' is not a section; write [search]"});
  expect_refused("# one\n# two\n[search\n", {"dir/f.toml:3: "});
  expect_refused("[search]\nthreads = 1\nthreads = 2\n", {"dir/f.toml:3: "});
}

TEST(Config, RefusesUnknownKeysWithWhatMayBeMeant) {
  expect_refused("[realtime]\nprioritty = 80\n",
                 {"dir/f.toml:2: unknown key 'prioritty' in [realtime]; did you mean 'priority'?"});
  expect_refused("\n[realtme]\npriority = 80\n", {"dir/f.toml:2: ", "did you mean 'realtime'?"});
  expect_refused("[search]\nthread = 2\n", {"did you mean 'threads'?"});
  expect_refused("[search]\ncolour = 2\n", {"unknown key 'colour'", "known: threads, scan_width"});
}

TEST(Config, GivesEachThreadACpu) {
  expect_refused("[search]\nthreads = 3\n[realtime]\ncpus = [1, 2]\n",
                 {"dir/f.toml:4: ", "3 threads"});
  expect_refused("[realtime]\ncpus = [2, 2]\n", {"dir/f.toml:2: ", "twice"});
  EXPECT_EQ(parse_config(kPath, "[realtime]\ncpus = [1, 2]\n").realtime.cpus.size(), 2U);
}

TEST(Config, OfAnyBytesIsReadOrRefusedInOneLine) {
  const std::string good = "[search]\nthreads = 2\n[realtime]\ncpus = [3, 2]\nlock_memory = true\n";
  std::mt19937 random(11);
  int refused = 0;
  for (int i = 0; i < 3000; ++i) {
    std::string text = good;
    for (int change = static_cast<int>(random() % 4); change >= 0; --change) {
      const std::size_t place = random() % text.size();
      if (random() % 3 == 0)
        text.erase(place, 1 + random() % 5);
      else
        text[place] = static_cast<char>(random() % 256);
      if (text.empty()) text = "=";
    }
    try {
      const Config config = parse_config(kPath, text);
      EXPECT_GE(config.search.thread_count, 1);
    } catch (const port::InputError& error) {
      ++refused;
      EXPECT_EQ(error.line().rfind("dir/f.toml:", 0), 0U) << error.line();
      port::expect_one_line(error.line());
    }
  }
  EXPECT_GT(refused, 1000);
}

TEST(Config, ThatCannotBeReadSaysSo) {
  const port::TemporaryFolder folder;
  port::expect_input_error([&] { (void)load_config(folder.path("none.toml")); }, {"none.toml"});
  port::expect_input_error([&] { (void)load_config(folder.path()); }, {folder.path()});
  const std::string big = folder.write("big.toml", std::string(2 << 20, '#'));
  port::expect_input_error([&] { (void)load_config(big); }, {"big.toml"});
}

TEST(Config, HoldsRecords) {
  const Config config = parse_config(
      kPath,
      "[records]\nfolder = \"r\"\nlast = 5\nfailed = 0\nsaved = 7\nmax_mb = 3\npicture = false\n");
  EXPECT_EQ(config.records.folder, "dir/r");
  EXPECT_EQ(config.records.limits.last_count, 5);
  EXPECT_EQ(config.records.limits.failed_count, 0);
  EXPECT_EQ(config.records.limits.saved_count, 7);
  EXPECT_EQ(config.records.limits.bytes_max, 3 << 20);
  EXPECT_FALSE(config.records.draws);
  EXPECT_TRUE(parse_config(kPath, "").records.folder.empty());
  expect_refused("[records]\nlast = 5\n", {"dir/f.toml:1: ", "folder"});
  expect_refused("[records]\nfolder = \"r\"\nmax_mb = 0\n", {"dir/f.toml:3: "});
}

TEST(Config, StartsAreCountedAsSaidElseByTheUnitElseBesideTheRecords) {
  RecordsConfig records;
  EXPECT_EQ(state_file_of(records, nullptr), "");
  EXPECT_EQ(state_file_of(records, "/var/lib/flatpose:/var/lib/other"),
            "/var/lib/flatpose/state.json");
  records.folder = "/r";
  EXPECT_EQ(state_file_of(records, nullptr), "/r/state.json");
  EXPECT_EQ(state_file_of(records, ""), "/r/state.json");
  EXPECT_EQ(state_file_of(records, "/var/lib/flatpose"), "/var/lib/flatpose/state.json");
  records.state_file = "/s.json";
  EXPECT_EQ(state_file_of(records, "/var/lib/flatpose"), "/s.json");
}

TEST(Config, HoldsBusSourceAndJobs) {
  const Config config = parse_config(
      kPath,
      "[modbus]\nbind = \"127.0.0.1\"\nport = 1502\nunit = 9\nallow = "
      "[\"192.0.2.0/24\"]\nword_order = \"BADC\"\n"
      "no_pose_int32 = -1\nhandshake = \"bits\"\nlease_ms = 700\n"
      "[source]\nreplay = \"s.pcd\"\nup = \"+z\"\n"
      "[[part]]\nname = \"a\"\nfile = \"a.fpt\"\n[[part]]\nname = \"b\"\nfile = \"/b.fpt\"\n"
      "[[job]]\nparts = [\"b\", \"a\"]\nnumber = 5\nframe = \"work\"\nwork = \"w.json\"\n"
      "convention = \"zyz\"\nmax_matches = 32\nmax_age_ms = 300\nanswer_by_ms = 1000\n"
      "region = \"circle:1,2,3\"\norder = \"height\"\nlimit_y_mm = [-1, 2.5]\n"
      "[[job]]\nparts = [\"a\"]\n");
  EXPECT_TRUE(config.modbus.is_on);
  EXPECT_EQ(config.modbus.bind, "127.0.0.1");
  EXPECT_EQ(config.modbus.port, 1502);
  EXPECT_EQ(config.modbus.unit, 9);
  EXPECT_TRUE(config.modbus.allowed.admits(0xc0000263));
  EXPECT_FALSE(config.modbus.allowed.admits(0xc0000363));
  EXPECT_EQ(config.modbus.format.order, result_map::WordOrder::kBadc);
  EXPECT_EQ(config.modbus.format.none_int32, 0xffffffffU);
  EXPECT_EQ(config.modbus.handshake, job::Handshake::kBits);
  EXPECT_EQ(config.lease_us, 700'000);
  EXPECT_EQ(config.source.replay, "dir/s.pcd");
  EXPECT_EQ(config.source.up, port::Up::kPlusZ);
  EXPECT_FALSE(config.source.allow_simulated);
  EXPECT_EQ(config.parts.at(0).file, "dir/a.fpt");
  EXPECT_EQ(config.parts.at(1).file, "/b.fpt");
  const JobConfig& job = config.jobs.at(0);
  EXPECT_EQ(job.parts, (std::vector<int>{1, 0}));
  EXPECT_EQ(job.rule.job, 5);
  EXPECT_EQ(job.rule.frame, job::FrameName::kWork);
  EXPECT_EQ(job.work_file, "dir/w.json");
  EXPECT_EQ(job.rule.convention, Convention::kZyz);
  EXPECT_EQ(job.rule.max_age_us, 300'000);
  EXPECT_EQ(job.rule.answer_by_us, 1'000'000);
  EXPECT_EQ(job.locate.deadline_us, 900'000);
  EXPECT_EQ(job.locate.max_matches, 32);
  EXPECT_EQ(job.locate.order, locate::Order::kHeight);
  EXPECT_EQ(job.locate.region.kind, Region::Kind::kCircle);
  EXPECT_EQ(job.report.limits.least_mm.y, -1.0);
  EXPECT_EQ(job.report.limits.greatest_mm.y, 2.5);
  EXPECT_EQ(config.jobs.at(1).rule.job, 1);
  EXPECT_FALSE(parse_config(kPath, "").modbus.is_on);
}

TEST(Config, HasOneLeaseWhicheverBusItIsWrittenAt) {
  EXPECT_FALSE(parse_config(kPath, "[modbus]\n[can]\n").lease_us);
  EXPECT_EQ(parse_config(kPath, "[can]\nlease_ms = 700\n").lease_us, 700'000);
  EXPECT_EQ(parse_config(kPath, "[modbus]\nlease_ms = 800\n[can]\n").lease_us, 800'000);
  EXPECT_EQ(parse_config(kPath, "[can]\nlease_ms = 900\n[modbus]\nlease_ms = 900\n").lease_us,
            900'000);
  expect_refused("[modbus]\nlease_ms = 700\n[can]\nlease_ms = 701\n",
                 {"dir/f.toml:4: ", "'lease_ms' is 701 here and 700", "write it once"});
  expect_refused("[can]\nlease_ms = 99\n", {"dir/f.toml:2: ", "100 and 3600000"});
}

TEST(Config, RefusesJobsThatCannotBeRun) {
  const std::string part = "[[part]]\nname = \"a\"\nfile = \"a.fpt\"\n";
  expect_refused("[[job]]\nnumber = 1\n", {"dir/f.toml:1: ", "needs 'parts'"});
  expect_refused("[[job]]\nparts = [\"a\"]\n", {"dir/f.toml:2: ", "no part \"a\"", "[[part]]"});
  expect_refused(part + "[[job]]\nparts = [\"a\"]\n[[job]]\nparts = [\"a\"]\n", {"two jobs"});
  expect_refused(part + part, {"dir/f.toml:5: ", "two parts"});
  expect_refused("[[part]]\nname = \"a\"\n", {"needs a file"});
  const std::string job = part + "[[job]]\nparts = [\"a\"]\n";
  expect_refused(job + "number = 0\n", {"dir/f.toml:6: "});
  expect_refused(job + "frame = \"work\"\n", {"dir/f.toml:6: ", "flatpose align"});
  expect_refused(job + "frame = \"robt\"\n", {"dir/f.toml:6: ", "scan, work, robot"});
  expect_refused(job + "alignment = \"r.json\"\n", {"dir/f.toml:6: ", "frame = \"robot\""});
  expect_refused(job + "height_mm = [2, 1]\n", {"dir/f.toml:6: ", "runs backwards"});
  expect_refused(job + "exclusions = \"circle:0,0,1\"\n", {"dir/f.toml:6: ", "not a list"});
  expect_refused(job + "exclusions = [\"circle:0\"]\n",
                 {"dir/f.toml:6: exclusions", "circle:X,Y,R"});
  expect_refused(job + "region = \"circle:1\"\n", {"dir/f.toml:6: region", "circle:X,Y,R"});
  expect_refused(job + "limit_z_mm = [2, 1]\n", {"dir/f.toml:6: ", "runs backwards"});
  expect_refused(job + "limit_z_mm = [2]\n", {"dir/f.toml:6: ", "give 2"});
  expect_refused(job + "max_matches = 33\n", {"dir/f.toml:6: "});
  expect_refused("[modbus]\nword_order = \"abcd\"\n", {"dir/f.toml:2: ", "ABCD, CDAB"});
  expect_refused("[modbus]\nport = 65536\n", {"dir/f.toml:2: "});
  expect_refused("[modbus]\nallow = [\"192.0.2.1/24\"]\n",
                 {"dir/f.toml:2: ", "192.0.2.1/24", "192.0.2.0/24"});
  expect_refused("[source]\nup = \"z\"\n", {"dir/f.toml:2: ", "+z, -z"});
}

TEST(Config, HoldsPicksByTheirPriority) {
  const Config config = parse_config(
      kPath,
      "[[part]]\nname = \"a\"\nfile = \"a.fpt\"\n"
      "[[part.pick]]\nposition_mm = [1, 2, 3]\n"
      "[[part.pick]]\nrotation = [90, 0, 180]\ntool = 7\npriority = 5\n"
      "[[part.pick]]\nrotation = [0, 0, 1, 0]\nconvention = \"abb_quaternion\"\npriority = 5\n"
      "[[part]]\nname = \"b\"\nfile = \"b.fpt\"\n"
      "[[job]]\nparts = [\"a\"]\n[[job]]\nnumber = 2\nparts = [\"b\"]\n"
      "[[job]]\nnumber = 3\nparts = [\"b\", \"a\"]\npose = \"object\"\n");
  const std::vector<PickPose>& picks = config.parts.at(0).picks;
  ASSERT_EQ(picks.size(), 3U);
  EXPECT_EQ(picks[0].index, 2);
  EXPECT_EQ(picks[0].tool, 7);
  EXPECT_NEAR(picks[0].object_T_pick.rotation.m[3], 1.0, 1e-12);  // x along y
  EXPECT_NEAR(picks[0].object_T_pick.rotation.m[8], -1.0, 1e-12);
  EXPECT_EQ(picks[1].index, 3);  // of equals the one that stands first
  EXPECT_NEAR(picks[1].object_T_pick.rotation.m[8], -1.0, 1e-12);
  EXPECT_NEAR(picks[1].object_T_pick.rotation.m[0], -1.0, 1e-12);
  EXPECT_EQ(picks[2].index, 1);
  EXPECT_EQ(picks[2].tool, 1);
  EXPECT_EQ(picks[2].object_T_pick.position_mm.z, 3.0);
  EXPECT_EQ(picks[2].object_T_pick.rotation.m, usual_pick().object_T_pick.rotation.m);
  EXPECT_TRUE(config.parts.at(1).picks.empty());
  EXPECT_EQ(config.jobs.at(0).report.kind, PoseKind::kPick);
  EXPECT_EQ(config.jobs.at(1).report.kind, PoseKind::kObject);
  EXPECT_EQ(config.jobs.at(2).report.kind, PoseKind::kObject);
}

TEST(Config, RefusesPicksThatCannotBe) {
  const std::string part = "[[part]]\nname = \"a\"\nfile = \"a.fpt\"\n[[part.pick]]\n";
  expect_refused(part + "position_mm = [1, 2]\n", {"dir/f.toml:5: ", "give 3"});
  expect_refused(part + "rotation = [1, 2, 3, 4]\n", {"dir/f.toml:5: ", "give 3 at most"});
  expect_refused(part + "rotation = [1, 2, 3]\nconvention = \"abb_quaternion\"\n",
                 {"dir/f.toml:5: "});
  expect_refused(part + "rotation = [1, 1, 0, 0]\nconvention = \"abb_quaternion\"\n",
                 {"dir/f.toml:5: ", "length 1"});
  expect_refused(part + "rotation = [1, 2, inf]\n", {"dir/f.toml:5: "});
  expect_refused(part + "tool = 0\n", {"dir/f.toml:5: ", "between 1 and 65534"});
  expect_refused(part + "tol = 1\n", {"dir/f.toml:5: ", "in [[pick]]", "did you mean 'tool'"});
  expect_refused("[[pick]]\ntool = 1\n", {"dir/f.toml:1: "});
}

TEST(Config, HoldsWhatAJobPrefers) {
  const std::string job = "[[part]]\nname = \"a\"\nfile = \"a.fpt\"\n[[job]]\nparts = [\"a\"]\n";
  const Config plain = parse_config(kPath, job);
  EXPECT_FALSE(plain.jobs.at(0).rule.has_reference);
  EXPECT_FALSE(plain.jobs.at(0).report.preferred_angle_rad);
  const Config degrees =
      parse_config(kPath, job + "preferred_angle_deg = -90\nreference_rotation = [0, 0, 180]\n");
  EXPECT_TRUE(degrees.jobs.at(0).rule.has_reference);
  EXPECT_NEAR(degrees.jobs.at(0).rule.reference[2], 3.14159265, 1e-8);
  EXPECT_NEAR(degrees.jobs.at(0).report.preferred_angle_rad.value_or(0), -1.57079633, 1e-8);
  const Config vector = parse_config(
      kPath, job + "convention = \"ur_rotation_vector\"\nreference_rotation = [3.1, 0, 0]\n");
  EXPECT_EQ(vector.jobs.at(0).rule.reference[0], 3.1);
  const Config quaternion = parse_config(
      kPath, job + "convention = \"abb_quaternion\"\nreference_rotation = [0, 1, 0, 0]\n");
  EXPECT_EQ(quaternion.jobs.at(0).rule.reference[1], 1.0);
  expect_refused(job + "reference_rotation = [0, 180]\n", {"dir/f.toml:6: ", "give 3"});
  expect_refused(job + "reference_rotation = [0, 0, 1000]\n", {"dir/f.toml:6: "});
  expect_refused(job + "preferred_angle_deg = \"x\"\n", {"dir/f.toml:6: "});
}

TEST(Config, HasOneSourceOfScans) {
  const Config watch = parse_config(kPath, "[source]\nwatch = \"scans\"\n");
  EXPECT_EQ(watch.source.watch, "dir/scans");
  EXPECT_EQ(watch.source.place, "dir/f.toml:2");
  const Config driver = parse_config(kPath, "[source]\ndriver = \"/run/c.sock\"\n");
  EXPECT_EQ(driver.source.driver, "/run/c.sock");
  EXPECT_TRUE(driver.source.is_any());
  EXPECT_FALSE(parse_config(kPath, "").source.is_any());
  expect_refused("[source]\nwatch = \"a\"\ndriver = \"b\"\n",
                 {"dir/f.toml:3: a second source of scans; keep one of replay, watch, driver"});
  expect_refused("[source]\ndriver = \"\"\n", {"dir/f.toml:2: 'driver' is no path"});
  // The memory that a driver is handed counts.
  EXPECT_EQ(held_bytes(driver) - held_bytes(watch), 16 * 1536 * 1280);
}

TEST(Config, OfTheExampleIsTheUsualOne) {
  const Config example = load_config(FLATPOSE_SOURCE_DIR "/port/linux/examples/flatposed.toml");
  const Config usual = parse_config(kPath, "");
  EXPECT_EQ(example.search.thread_count, usual.search.thread_count);
  EXPECT_EQ(held_bytes(example), held_bytes(usual));
  EXPECT_EQ(example.search.max_scan_bytes, usual.search.max_scan_bytes);
  EXPECT_TRUE(example.realtime.cpus.empty());
}

}  // namespace
}  // namespace flatpose::daemon
