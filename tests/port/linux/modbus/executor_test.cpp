// libmodbus against a plain executor by the specification's words, on whatever the validator lets
// through.

#include "port/linux/modbus/executor.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/fieldbus/modbus/line.hpp"

namespace flatpose::port {
namespace {

using modbus::Bytes;

bool are_equal(const modbus::Bank& a, const modbus::Bank& b) {
  return a.registers == b.registers && a.coils == b.coils && a.discrete_inputs == b.discrete_inputs;
}

/// A PDU of one of the functions that an executor is given, often a wrong one.
Bytes some_request(std::mt19937& random) {
  constexpr std::uint8_t kFunctions[] = {1, 2, 3, 4, 5, 6, 15, 16, 22};
  const auto any = [&] { return static_cast<unsigned>(random()); };
  const auto below = [&](unsigned end) { return any() % end; };
  const auto function = kFunctions[below(9)];
  const bool is_bits = function <= 2 || function == 5 || function == 15;
  const unsigned address = below(is_bits ? 10 : 370);
  const unsigned count = 1 + below(is_bits ? 8 : 125);
  Bytes pdu{function};
  const auto word = [&](unsigned value) {
    pdu.push_back(static_cast<std::uint8_t>(value >> 8));
    pdu.push_back(static_cast<std::uint8_t>(value));
  };
  word(address);
  if (function == 5) {
    word(below(2) ? 0xff00 : 0);
  } else if (function == 6) {
    word(any());
  } else if (function == 22) {
    word(any());
    word(any());
  } else {
    word(count);
  }
  if (function == 15 || function == 16) {
    const unsigned bytes = function == 15 ? (count + 7) / 8 : 2 * count;
    pdu.push_back(static_cast<std::uint8_t>(bytes));
    for (unsigned i = 0; i < bytes; ++i) pdu.push_back(static_cast<std::uint8_t>(random()));
  }
  return pdu;
}

TEST(LibmodbusExecutor, DoesWhatTheSpecificationSays) {
  LibmodbusExecutor executor;
  modbus::PlainExecutor plain;
  std::mt19937 random(5);
  modbus::Bank ours;
  for (auto& value : ours.registers) value = static_cast<std::uint16_t>(random());
  for (auto& bit : ours.discrete_inputs) bit = random() % 2;
  modbus::Bank theirs = ours;
  int done = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Bytes pdu = some_request(random);
    modbus::Request request;
    if (modbus::understand(pdu, request) != modbus::Exception::kNone) continue;
    std::array<std::uint8_t, modbus::kPduBytesMax> a{}, b{};
    const std::size_t size = executor.execute(pdu, ours, a);
    ASSERT_EQ(size, plain.execute(pdu, theirs, b)) << "function " << int{pdu[0]};
    ASSERT_EQ(a, b) << "function " << int{pdu[0]};
    ASSERT_TRUE(are_equal(ours, theirs)) << "function " << int{pdu[0]};
    ++done;
  }
  EXPECT_GT(done, 5000);
}

TEST(LibmodbusExecutor, GivesNothingForWhatItCannotDo) {
  LibmodbusExecutor executor;
  modbus::Bank bank;
  std::array<std::uint8_t, modbus::kPduBytesMax> response{};
  EXPECT_EQ(executor.execute({}, bank, response), 0U);
  const Bytes read{3, 0, 0, 0, 5};
  EXPECT_EQ(executor.execute(read, bank, std::span(response).first(11)), 0U);
  EXPECT_EQ(executor.execute(read, bank, response), 12U);  // and what came before left nothing
}

}  // namespace
}  // namespace flatpose::port
