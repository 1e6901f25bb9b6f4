// What --check says of the CAN interface that a config names.

#include <gtest/gtest.h>

#include <string>

#include "port/linux/daemon/check.hpp"
#include "port/linux/files/input_error.hpp"

namespace flatpose::daemon {
namespace {

constexpr port::CanInterface kGood{
    .index = 3, .is_up = true, .carries_fd = false, .bit_rate_per_s = 250'000};

std::string whole_report(const port::CanInterface& interface, const std::string& lines) {
  const Config config = parse_config("f.toml", "[can]\n" + lines);
  std::string looked_at;
  const std::string text = check_report("f.toml", config, "/nowhere", [&](const std::string& name) {
    looked_at = name;
    return interface;
  });
  EXPECT_EQ(looked_at, config.can.interface);
  return text;
}

/// From the line on that speaks of the interface.
std::string said_of(const port::CanInterface& interface, const std::string& lines = {}) {
  const std::string text = whole_report(interface, lines);
  const std::size_t at = text.find("\ncan: ");
  return at == std::string::npos ? std::string() : text.substr(at + 1);
}

/// The same as a start says; empty: it starts.
std::string start_says(const port::CanInterface& interface, const std::string& lines = {}) {
  const Config config = parse_config("f.toml", "[can]\n" + lines);
  try {
    port::check_can("PLACE", config.can.interface, interface, config.can.need());
  } catch (const port::InputError& error) {
    return error.line();
  }
  return {};
}

void expect_no_start(const port::CanInterface& interface, const std::string& lines,
                     const std::string& what) {
  const std::string begin = "f.toml: valid, but the daemon would not start on this machine: ";
  const std::string report = whole_report(interface, lines);
  ASSERT_EQ(report.rfind(begin, 0), 0U) << report;
  const std::string said = report.substr(begin.size());
  EXPECT_EQ(said.rfind(what, 0), 0U) << said;
  EXPECT_EQ(said.find("\ncan: "), std::string::npos) << "all is said";
  const std::string started = start_says(interface, lines);
  const std::size_t first = said.find('\n');
  const std::size_t second = said.find('\n', first + 1);
  EXPECT_EQ(started,
            "PLACE: " + said.substr(0, first) + "; " + said.substr(first + 3, second - first - 3));
}

TEST(CheckCan, OfAGoodInterfaceNamesIt) {
  EXPECT_EQ(said_of(kGood), "can: can0 at 250 kbit/s\n");
  EXPECT_EQ(said_of(kGood, "bit_rate = 250_000\n"), "can: can0 at 250 kbit/s\n");
  EXPECT_EQ(start_says(kGood), "");
  EXPECT_EQ(whole_report(kGood, "").rfind("f.toml: valid; 1 search thread", 0), 0U);
}

TEST(CheckCan, WarnsOfABitRateThatNobodyChecks) {
  port::CanInterface virtual_one = kGood;
  virtual_one.bit_rate_per_s.reset();
  EXPECT_NE(said_of(virtual_one, "bit_rate = 250_000\n").find("\nwarning: can0 tells no bit rate"),
            std::string::npos);
  EXPECT_EQ(said_of(virtual_one), "can: can0\n");
}

TEST(CheckCan, AdvisesAMasterThatMayBeSilentForLessThanAnAnswerTakes) {
  const std::string job =
      "[[part]]\nname = \"a\"\nfile = \"a.fpt\"\n"
      "[[job]]\nparts = [\"a\"]\nanswer_by_ms = 300\n"
      "[[job]]\nnumber = 2\nparts = [\"a\"]\nanswer_by_ms = 7000\n";
  const std::string said = said_of(kGood, job);
  for (const char* const part : {"\nlease: job 2 answers within 7000 ms", "silent for 5000 ms",
                                 "command_number 0", "node 127", "lease_ms = 7000 in [can]"})
    EXPECT_NE(said.find(part), std::string::npos) << part << " is not in:\n" << said;
  EXPECT_EQ(said_of(kGood, "lease_ms = 7000\n" + job).find("lease"), std::string::npos);
  EXPECT_EQ(said_of(kGood, "master_silence_ms = 500\n" + job).find("lease"), std::string::npos)
      << "its heartbeat is heard";
}

TEST(CheckCan, WhatKeepsTheDaemonFromStartingIsSaidInTheSameWords) {
  port::CanInterface none = kGood;
  none.has_kernel_can = false;
  expect_no_start(none, "", "this kernel has no CAN\n  load its module: modprobe can_raw\n");
  none = kGood;
  none.index = 0;
  expect_no_start(none, "interface = \"can5\"\n", "there is no CAN interface can5\n  see ip link");
  none = kGood;
  none.is_can = false;
  expect_no_start(none, "interface = \"lo\"\n", "lo is no CAN interface\n");
  expect_no_start(kGood, "bit_rate = 500_000\n", "can0 runs at 250 kbit/s, not 500 kbit/s\n");
  expect_no_start(kGood, "fd_frame = true\n", "can0 is classic");
}

TEST(CheckCan, AnInterfaceThatIsDownOrOffIsWaitedFor) {
  port::CanInterface down = kGood;
  down.is_up = false;
  const std::string said = said_of(down);
  EXPECT_NE(said.find("can: can0 at 250 kbit/s, which is down\n  ip link set can0 up type can "
                      "bitrate 250000 restart-ms 100\n"),
            std::string::npos)
      << said;
  EXPECT_NE(said.find("waits for the bus"), std::string::npos);
  EXPECT_EQ(start_says(down), "");
  port::CanInterface off = kGood;
  off.is_bus_off = true;
  EXPECT_NE(said_of(off).find("which is bus-off\n  ip link set can0 type can restart\n"),
            std::string::npos);
}

TEST(CheckCan, WithoutASectionLooksAtNothing) {
  const Config config = parse_config("f.toml", "");
  const std::string text =
      check_report("f.toml", config, "/nowhere", [](const std::string&) -> port::CanInterface {
        ADD_FAILURE() << "looked at";
        return {};
      });
  EXPECT_EQ(text.find("\ncan"), std::string::npos);
}

}  // namespace
}  // namespace flatpose::daemon
