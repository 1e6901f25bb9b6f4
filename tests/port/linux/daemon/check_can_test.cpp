// What --check says of the CAN interface that a config names.

#include <gtest/gtest.h>

#include <string>

#include "port/linux/daemon/check.hpp"
#include "port/linux/files/input_error.hpp"

namespace flatpose::daemon {
namespace {

constexpr port::CanInterface kGood{
    .index = 3, .is_up = true, .carries_fd = false, .bit_rate_per_s = 250'000};

std::string said_of(const port::CanInterface& interface, const std::string& lines = {}) {
  const Config config = parse_config("f.toml", "[can]\n" + lines);
  std::string looked_at;
  const std::string text = check_report("f.toml", config, "/nowhere", [&](const std::string& name) {
    looked_at = name;
    return interface;
  });
  EXPECT_EQ(looked_at, config.can.interface);
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
  const std::string said = said_of(interface, lines);
  EXPECT_NE(said.find(what), std::string::npos) << said;
  EXPECT_NE(said.find("does not start"), std::string::npos) << said;
  const std::string started = start_says(interface, lines);
  const std::size_t first = said.find('\n');
  const std::size_t second = said.find('\n', first + 1);
  EXPECT_EQ(started, "PLACE: " + said.substr(5, first - 5) + "; " +
                         said.substr(first + 3, second - first - 3));
}

TEST(CheckCan, OfAGoodInterfaceNamesIt) {
  EXPECT_EQ(said_of(kGood), "can: can0 at 250 kbit/s\n");
  EXPECT_EQ(said_of(kGood, "bit_rate = 250_000\n"), "can: can0 at 250 kbit/s\n");
  EXPECT_EQ(start_says(kGood), "");
}

TEST(CheckCan, WhatKeepsTheDaemonFromStartingIsSaidInTheSameWords) {
  port::CanInterface none = kGood;
  none.has_kernel_can = false;
  expect_no_start(none, "", "this kernel has no CAN\n  load its module: modprobe can_raw\n");
  none = kGood;
  none.index = 0;
  expect_no_start(none, "interface = \"can5\"\n", "there is no CAN interface can5\n  see ip link");
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
