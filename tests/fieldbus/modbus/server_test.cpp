#include "flatpose/modbus/server.hpp"

#include "tests/fieldbus/modbus/line.hpp"

namespace flatpose::modbus {
namespace {

using job::Bit;

constexpr int kDoneAt = 101, kStatusAt = 102, kBitsAt = 103, kAcceptedAt = 104, kRefusedAt = 105;

TEST(ModbusServer, TriggersPollsAndReads) {
  Line line;
  EXPECT_EQ(line.write_number(7), (Bytes{6, 0, 0, 0, 7}));
  EXPECT_EQ(line.order.kind, job::Order::Kind::kStart);
  EXPECT_EQ(line.read_register(kAcceptedAt), 7);
  EXPECT_EQ(line.read_register(kDoneAt), 0);
  line.finish(line.found());
  const Bytes block = line.ask({4, 0, 100, 0, 93});
  ASSERT_EQ(block.size(), 2U + 2 * 93);
  const auto word = [&](int address) {
    const std::size_t i = static_cast<std::size_t>(2 + 2 * (address - 100));
    return block[i] * 256 + block[i + 1];
  };
  EXPECT_EQ(word(kDoneAt), 7);
  EXPECT_EQ(word(kStatusAt), 0);
  EXPECT_EQ(word(192), 7);
  EXPECT_EQ(word(142) * 65536 + word(143), 10000);  // 10 mm
  EXPECT_EQ(word(kBitsAt) & job::kValid, job::kValid);
}

TEST(ModbusServer, FunctionsThreeAndFourReadAlike) {
  Line line;
  line.write_number(7);
  line.finish(line.found(9));
  for (int address = 0; address < 360; address += 90) {
    const auto low = static_cast<std::uint8_t>(address),
               high = static_cast<std::uint8_t>(address >> 8);
    Bytes three = line.ask({3, high, low, 0, 90});
    const Bytes four = line.ask({4, high, low, 0, 90});
    three[0] = 4;
    EXPECT_EQ(three, four);
  }
}

// All of a write first, then the trigger: the number stands before its arguments.
TEST(ModbusServer, ArgumentsOfTheSameRequestCount) {
  Line line;
  EXPECT_EQ(line.ask({16, 0, 0, 0, 4, 8, 0, 9, 1, 65, 0, 3, 0, 7}), (Bytes{16, 0, 0, 0, 4}));
  EXPECT_EQ(line.order.command, job::Command::kCapture);
  EXPECT_EQ(line.order.job, 7);
  EXPECT_EQ(line.order.number, 9);
}

TEST(ModbusServer, FunctionTwentyThreeReadsWhatItsOwnWriteDid) {
  Line line;
  line.write_number(1);
  line.finish(line.found());
  const Bytes told = line.ask({23, 0, 101, 0, 5, 0, 0, 0, 1, 2, 0, 2});
  EXPECT_EQ(Bytes(told.begin(), told.begin() + 2), (Bytes{23, 10}));
  EXPECT_EQ(told[2] * 256 + told[3], 0);  // done_number
  EXPECT_EQ(told[7] & (job::kValid | job::kDone), 0);
  EXPECT_EQ(told[7] & job::kBusy, job::kBusy);
  EXPECT_EQ(told[8] * 256 + told[9], 2);  // accepted_number
}

TEST(ModbusServer, MaskWriteGoesThroughTheMachine) {
  Line line;
  line.write_number(0x0f);
  line.finish(line.found());
  EXPECT_EQ(line.ask({22, 0, 0, 0, 0x0a, 0, 0x30}), (Bytes{22, 0, 0, 0, 0x0a, 0, 0x30}));
  EXPECT_EQ(line.order.number, 0x3a);  // 0x0f & 0x0a | 0x30 & ~0x0a
}

TEST(ModbusServer, OthersReadAllAndAreRefusedWrites) {
  Line line;
  line.write_number(7);
  const std::vector<Bytes> writes{{6, 0, 0, 0, 9},        {16, 0, 2, 0, 1, 2, 0, 3},
                                  {22, 0, 3, 0, 0, 0, 7}, {23, 0, 100, 0, 1, 0, 0, 0, 1, 2, 0, 9},
                                  {5, 0, 0, 0, 0},        {15, 0, 0, 0, 1, 1, 0}};
  const Bytes before = line.ask({3, 0, 0, 0, 7});
  for (const Bytes& write : writes) {
    EXPECT_EQ(line.ask(write, job::kBob), (Bytes{static_cast<std::uint8_t>(write[0] | 0x80), 6}));
  }
  EXPECT_EQ(line.ask({3, 0, 0, 0, 7}, job::kBob), before);
  EXPECT_EQ(line.read_register(kAcceptedAt, job::kBob), 7);
}

TEST(ModbusServer, ARefusedNumberIsNoException) {
  Line line;
  EXPECT_EQ(line.ask({16, 0, 0, 0, 2, 4, 0, 9, 0, 1}), (Bytes{16, 0, 0, 0, 2}));  // old session
  EXPECT_EQ(line.read_register(kRefusedAt), 9);
  EXPECT_EQ(line.read_register(106), static_cast<int>(job::Refusal::kStaleSession));
}

TEST(ModbusServer, BitsAreCoilsAndDiscreteInputs) {
  Line line({.handshake = job::Handshake::kBits});
  EXPECT_EQ(line.ask({15, 0, 0, 0, 2, 1, 0}), (Bytes{15, 0, 0, 0, 2}));
  EXPECT_EQ(line.ask({2, 0, 0, 0, 8}), (Bytes{2, 1, job::kReady}));
  EXPECT_EQ(line.ask({5, 0, 0, 0xff, 0}), (Bytes{5, 0, 0, 0xff, 0}));
  EXPECT_EQ(line.ask({1, 0, 0, 0, 2}), (Bytes{1, 1, 1}));
  EXPECT_EQ(line.ask({2, 0, 0, 0, 8}), (Bytes{2, 1, job::kAck | job::kBusy}));
  EXPECT_EQ(line.read_register(6), 1);
  EXPECT_EQ(line.write_number(4), (Bytes{0x86, 3}));  // never both ways at once
}

TEST(ModbusServer, TriggerBitsAreRefusedWithNumbers) {
  Line line;
  EXPECT_EQ(line.ask({5, 0, 0, 0xff, 0}), (Bytes{0x85, 3}));
  EXPECT_EQ(line.ask({6, 0, 6, 0, 1}), (Bytes{0x86, 3}));
  EXPECT_EQ(line.ask({5, 0, 0, 0, 0}), (Bytes{5, 0, 0, 0, 0}));
}

TEST(ModbusServer, ServesItsUnitsOnly) {
  Line line;
  for (int unit = 0; unit < 256; ++unit) {
    const Bytes told = line.ask({3, 0, 10, 0, 1}, job::kAda, static_cast<std::uint8_t>(unit));
    const bool is_served = unit == 0 || unit == 1 || unit == 255;
    EXPECT_EQ(told, is_served ? (Bytes{3, 2, 0x12, 0x34}) : (Bytes{0x83, 0x0b})) << unit;
  }
}

TEST(ModbusServer, SaysWhoItIs) {
  Line line;
  EXPECT_EQ(line.ask({17})[1], 3 + 8 + 5);
  EXPECT_EQ(line.ask({43, 14, 4, 2}),
            (Bytes{43, 14, 4, 0x82, 0, 0, 1, 2, 5, '1', '.', '2', '.', '3'}));
  EXPECT_EQ(line.ask({43, 14, 4, 9}), (Bytes{0x80 | 43, 2}));
  EXPECT_EQ(line.executor.count, 0);
}

TEST(ModbusServer, AnExecutorThatFailsIsADeviceFailureAndNothingWasApplied) {
  Line line;
  line.executor.fails = true;
  EXPECT_EQ(line.write_number(7), (Bytes{0x86, 4}));
  EXPECT_EQ(line.ask({3, 0, 0, 0, 1}), (Bytes{0x83, 4}));
  line.executor.fails = false;
  EXPECT_EQ(line.read_register(kAcceptedAt), 0);
  EXPECT_EQ(line.read_register(0), 0);
}

TEST(ModbusServer, ReadsRenewTheLease) {
  Line line;
  line.write_number(7);
  for (int i = 0; i < 4; ++i) {
    line.now_us += 4 * job::kSecond_us;
    line.ask({4, 0, 100, 0, 93});
  }
  EXPECT_EQ(line.write_number(9, job::kBob), (Bytes{0x86, 6}));
}

TEST(ModbusServer, TwoProgramsBehindOneAddressBothWriteWhenTheyPoll) {
  Line line;
  for (std::uint8_t number = 1; number < 20; ++number) {
    line.connection = 1 + number % 2;
    line.read_register(kDoneAt);
    EXPECT_EQ(line.write_number(number), (Bytes{6, 0, 0, 0, number}));
    line.finish(line.found());
  }
  // One that does not is told once; the second was the last that wrote.
  line.connection = 1;
  EXPECT_EQ(line.write_number(52), (Bytes{0x86, 6}));
  EXPECT_EQ(line.write_number(52), (Bytes{6, 0, 0, 0, 52}));
}

TEST(ModbusServer, WordOrderIsAsSet) {
  Line line;
  line.settings.format.order = result_map::WordOrder::kCdab;
  Server other(line.machine, line.executor, line.settings);
  std::array<std::uint8_t, kAduBytesMax> response{};
  const Bytes pdu{4, 0, 11, 0, 2};
  ASSERT_EQ(other.serve(line.now_us, {job::kAda, 1}, {1, 1, pdu}, response).bytes, 13U);
  EXPECT_EQ(Bytes(response.begin() + 9, response.begin() + 13), (Bytes{0x56, 0x78, 0x12, 0x34}));
}

}  // namespace
}  // namespace flatpose::modbus
