#pragma once
// A server with its machine, a line to it, and an executor of the test's own.

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "flatpose/modbus/server.hpp"
#include "tests/fieldbus/job/desk.hpp"

namespace flatpose::modbus {

using Bytes = std::vector<std::uint8_t>;

/// Plain and slow: every function by the specification's words.
class PlainExecutor final : public Executor {
 public:
  std::size_t execute(std::span<const std::uint8_t> request, Bank& bank,
                      std::span<std::uint8_t> response) noexcept override {
    ++count;
    if (fails) return 0;
    const auto word = [&](std::size_t i) { return request[i] * 256 + request[i + 1]; };
    const int address = word(1), count_or_value = word(3);
    out_.clear();
    out_.push_back(request[0]);
    switch (request[0]) {
      case 1: read_bits(bank.coils, address, count_or_value); break;
      case 2: read_bits(bank.discrete_inputs, address, count_or_value); break;
      case 3:
      case 4:
        out_.push_back(static_cast<std::uint8_t>(2 * count_or_value));
        for (int i = 0; i < count_or_value; ++i) push(bank.registers[address + i]);
        break;
      case 5:
        bank.coils[address] = count_or_value != 0;
        echo(request, 5);
        break;
      case 6:
        bank.registers[address] = static_cast<std::uint16_t>(count_or_value);
        echo(request, 5);
        break;
      case 15:
        for (int i = 0; i < count_or_value; ++i)
          bank.coils[address + i] = request[6 + i / 8] >> (i % 8) & 1;
        echo(request, 5);
        break;
      case 16:
        for (int i = 0; i < count_or_value; ++i)
          bank.registers[address + i] = static_cast<std::uint16_t>(word(6 + 2 * i));
        echo(request, 5);
        break;
      case 22: {
        std::uint16_t& target = bank.registers[address];
        target = static_cast<std::uint16_t>((target & word(3)) | (word(5) & ~word(3)));
        echo(request, 7);
        break;
      }
      default: ADD_FAILURE() << "function " << int{request[0]} << " is not an executor's";
    }
    std::copy(out_.begin(), out_.end(), response.begin());
    return out_.size();
  }

  int count = 0;
  bool fails = false;

 private:
  void push(int word) {
    out_.push_back(static_cast<std::uint8_t>(word >> 8));
    out_.push_back(static_cast<std::uint8_t>(word));
  }
  void echo(std::span<const std::uint8_t> request, int bytes) {
    out_.assign(request.begin(), request.begin() + bytes);
  }
  template <class Bits>
  void read_bits(const Bits& bits, int address, int count_of_bits) {
    Bytes packed(static_cast<std::size_t>((count_of_bits + 7) / 8));
    for (int i = 0; i < count_of_bits; ++i)
      if (bits[address + i]) packed[i / 8] |= static_cast<std::uint8_t>(1 << (i % 8));
    out_.push_back(static_cast<std::uint8_t>(packed.size()));
    out_.insert(out_.end(), packed.begin(), packed.end());
  }

  Bytes out_;
};

struct Line : job::Desk {
  explicit Line(const job::Config& config = {.session_id = 321}) : Desk(config) { live(); }

  /// A PDU to the server and its response's.
  Bytes ask(const Bytes& pdu, job::Address address = job::kAda, std::uint8_t unit = 1) {
    std::array<std::uint8_t, kAduBytesMax> response{};
    served = server.serve(now_us, {address, connection}, {++transaction, unit, pdu}, response);
    if (served.outputs.order.kind != job::Order::Kind::kNone) order = served.outputs.order;
    AduReader reader;  // the test's way back is the parser, held against bytes in adu_test
    std::copy_n(response.begin(), served.bytes, reader.room().begin());
    reader.filled(served.bytes);
    Adu adu;
    EXPECT_EQ(reader.next(adu), AduReader::Step::kAdu);
    EXPECT_EQ(adu.transaction, transaction);
    EXPECT_EQ(adu.unit, unit);
    return {adu.pdu.begin(), adu.pdu.end()};
  }
  Bytes write_number(std::uint8_t number, job::Address address = job::kAda) {
    return ask({6, 0, 0, 0, number}, address);
  }
  int read_register(int address, job::Address reader = job::kAda) {
    const Bytes response =
        ask({3, static_cast<std::uint8_t>(address >> 8), static_cast<std::uint8_t>(address), 0, 1},
            reader);
    return response.size() == 4 ? response[2] * 256 + response[3] : -1;
  }

  PlainExecutor executor;
  Settings settings{.identity = {.revision = "1.2.3"}};
  Server server{machine, executor, settings};
  Served served;
  std::uint16_t transaction = 0;
  std::uint64_t connection = 1;
};

}  // namespace flatpose::modbus
