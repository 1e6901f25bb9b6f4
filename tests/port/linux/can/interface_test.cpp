// What is said of an interface that is not what the config asks for, and what mends it.

#include "port/linux/can/interface.hpp"

#include <gtest/gtest.h>

#include "port/linux/can/link_kind.hpp"
#include "port/linux/files/input_error.hpp"

namespace flatpose::port {
namespace {

constexpr CanInterface kReal{.index = 3, .is_up = true, .bit_rate_per_s = 250'000};
constexpr CanInterface kVirtual{.index = 4, .is_up = true, .is_virtual = true};

CanInterface with_fd(CanInterface interface) {
  interface.carries_fd = true;
  return interface;
}

TEST(CanInterface, OfWhatTheConfigAsksForIsFine) {
  EXPECT_FALSE(problem_of("can0", kReal, {}));
  EXPECT_FALSE(problem_of("can0", kReal, {.bit_rate_per_s = 250'000}));
  EXPECT_FALSE(problem_of("can0", with_fd(kReal), {.bit_rate_per_s = 250'000, .fd = true}));
  EXPECT_FALSE(problem_of("vcan0", kVirtual, {.bit_rate_per_s = 500'000}))
      << "a virtual one has no rate";
  EXPECT_FALSE(problem_of("vcan0", with_fd(kVirtual), {.fd = true}));
  EXPECT_NO_THROW(check_can("f.toml:3", "can0", kReal, {}));
}

TEST(CanInterface, ThatIsNotThereOrOfAnotherRateIsNamedWithItsRemedy) {
  const auto none = problem_of("can7", {.has_kernel_can = false}, {});
  ASSERT_TRUE(none);
  EXPECT_EQ(none->what, "this kernel has no CAN");
  EXPECT_EQ(none->remedy, "load its module: modprobe can_raw");
  const auto absent = problem_of("can7", {}, {});
  ASSERT_TRUE(absent);
  EXPECT_EQ(absent->what, "there is no CAN interface can7");
  const auto rate = problem_of("can0", kReal, {.bit_rate_per_s = 500'000});
  ASSERT_TRUE(rate);
  EXPECT_EQ(rate->what, "can0 runs at 250 kbit/s, not 500 kbit/s");
  EXPECT_EQ(rate->remedy,
            "ip link set can0 down; ip link set can0 up type can bitrate 500000 restart-ms 100");
  EXPECT_THROW(check_can("f.toml:3", "can0", kReal, {.bit_rate_per_s = 500'000}), InputError);
}

TEST(CanInterface, ThatIsClassicIsRefusedForFdFramesWithTheCommandThatMakesItFd) {
  const auto real = problem_of("can0", kReal, {.fd = true});
  ASSERT_TRUE(real);
  EXPECT_NE(real->what.find("can0 is classic"), std::string::npos);
  EXPECT_EQ(real->remedy,
            "ip link set can0 down; ip link set can0 up type can bitrate 250000 dbitrate 2000000 "
            "fd on restart-ms 100");
  const auto virtual_one = problem_of("vcan0", kVirtual, {.fd = true});
  ASSERT_TRUE(virtual_one);
  EXPECT_EQ(virtual_one->remedy,
            "ip link set vcan0 down; ip link set vcan0 mtu 72; ip link set vcan0 up");
}

TEST(CanInterface, OfAnotherKindIsNoneWhateverIsAskedOfIt) {
  CanInterface ethernet{.index = 2, .is_can = false, .is_up = true};
  const auto problem = problem_of("eth0", ethernet, {});
  ASSERT_TRUE(problem);
  EXPECT_EQ(problem->what, "eth0 is no CAN interface");
  const CanInterface loopback = look_at_can_link("lo");
  if (loopback.index == 0) GTEST_SKIP() << "this machine has no lo";
  EXPECT_FALSE(loopback.is_can);
  EXPECT_EQ(link_kind_of(loopback.index), "") << "there long before links had kinds";
  EXPECT_EQ(link_kind_of(0), "");
}

TEST(CanInterface, ThatTellsNoBitRateLeavesADoubtWhereOneIsAskedFor) {
  EXPECT_EQ(doubt_of("vcan0", kVirtual, {.bit_rate_per_s = 250'000}),
            "vcan0 tells no bit rate: nothing checks that it is 250 kbit/s");
  EXPECT_FALSE(doubt_of("vcan0", kVirtual, {}));
  EXPECT_FALSE(doubt_of("can0", kReal, {.bit_rate_per_s = 250'000}));
}

TEST(CanInterface, NamesAreThoseThatTheKernelLetsBe) {
  for (const char* const name : {"can0", "a", "fifteen-letters", "can.1"})
    EXPECT_TRUE(is_interface_name(name)) << name;
  for (const char* const name :
       {"", ".", "..", "sixteen-letters-", "can 0", "can\n0", "a/b", "a:1"})
    EXPECT_FALSE(is_interface_name(name)) << name;
}

TEST(CanInterface, ThatIsDownIsBroughtUpByItsCommand) {
  CanInterface down = kReal;
  down.is_up = false;
  EXPECT_FALSE(problem_of("can0", down, {})) << "the node waits for it";
  EXPECT_EQ(to_text("can0", down), "can0 at 250 kbit/s, which is down");
  EXPECT_EQ(command_for("can0", down, {}),
            "ip link set can0 up type can bitrate 250000 restart-ms 100");
  down.bit_rate_per_s.reset();
  EXPECT_EQ(command_for("can0", down, {.fd = true}),
            "ip link set can0 up type can bitrate 250000 dbitrate 2000000 fd on restart-ms 100")
      << "not set up yet";
  EXPECT_EQ(command_for("can0", down, {.bit_rate_per_s = 125'000}),
            "ip link set can0 up type can bitrate 125000 restart-ms 100");
  CanInterface off = kVirtual;
  off.is_up = false;
  EXPECT_EQ(command_for("vcan0", off, {}), "ip link set vcan0 up");
}

TEST(CanInterface, NamesAreShownPrintableAndNotBeyondTheirLength) {
  const auto odd = problem_of("can\n0", {}, {});
  ASSERT_TRUE(odd);
  EXPECT_EQ(odd->what.find('\n'), std::string::npos);
  EXPECT_EQ(look_at_can("a-name-longer-than-any-interface").index, 0);
}

}  // namespace
}  // namespace flatpose::port
