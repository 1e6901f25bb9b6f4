#pragma once
// One request in, one response out, with the job machine between: what a write holds is applied
// whole, then the machine runs, then the response is made. So no response leaves before
// accepted_number is set and VALID is dropped, and function 23 reads what its own write did.
//
// Executing a request on registers is the port's (libmodbus): an Executor gets requests that
// were understood, and a bank of registers of its own. Function 23 reaches it as 16 and 3.

#include <array>
#include <cstdint>
#include <span>

#include "flatpose/job/machine.hpp"
#include "flatpose/modbus/adu.hpp"
#include "flatpose/modbus/identity.hpp"
#include "flatpose/modbus/request.hpp"
#include "flatpose/result_map/registers.hpp"
#include "flatpose/result_map/table.hpp"

namespace flatpose::modbus {

/// All that functions 1 to 6, 15, 16 and 22 can reach; a byte a bit, as libmodbus has them.
/// Functions 3 and 4 read the same registers.
struct Bank {
  std::array<std::uint16_t, result_map::kRegisterCount> registers{};
  std::array<std::uint8_t, job::kControlBitCount> coils{};
  std::array<std::uint8_t, job::kBitCount> discrete_inputs{};
};

class Executor {
 public:
  /// Does what the request says, on the bank, and writes the response's PDU. The request is valid
  /// and its function one of 1 to 6, 15, 16, 22.  Returns the response's size; 0: it could not.
  [[nodiscard]] virtual std::size_t execute(std::span<const std::uint8_t> request, Bank& bank,
                                            std::span<std::uint8_t> response) noexcept = 0;

 protected:
  ~Executor() = default;
};

struct Settings {
  result_map::WireFormat format{};
  Identity identity{};
  std::uint8_t own_unit = 1;  ///< Served beside 0 and 255.
};

struct Served {
  std::size_t bytes = 0;  ///< Of the response: never 0.
  Exception exception = Exception::kNone;
  job::Outputs outputs;  ///< For the search; next_us is when the machine wants to be called.
};

class Server {
 public:
  /// Refers to both, which must outlive it.
  Server(job::Machine& machine, Executor& executor, const Settings& settings) noexcept
      : machine_(machine), executor_(executor), settings_(settings) {}

  /// Answers one request.  Cost: some microseconds.  Memory: none.  Thread: the machine's.
  /// Fails: never; what is wrong with the request is an exception in the response.
  [[nodiscard]] Served serve(std::int64_t now_us, const job::Master& master, const Adu& adu,
                             std::span<std::uint8_t, kAduBytesMax> response) noexcept;

 private:
  using Pdu = std::array<std::uint8_t, kPduBytesMax>;

  [[nodiscard]] bool is_served(std::uint8_t unit) const noexcept {
    return unit == 0 || unit == 255 || unit == settings_.own_unit;
  }
  [[nodiscard]] Exception answer(const job::Master& master, const Request& request,
                                 Served& served) noexcept;
  [[nodiscard]] Exception write(const job::Master& master, const Request& request,
                                Served& served) noexcept;
  [[nodiscard]] Exception read(const job::Master& master, const Range& range,
                               std::span<const std::uint8_t> pdu) noexcept;
  [[nodiscard]] Exception read_and_write(const job::Master& master, const Request& request,
                                         Served& served) noexcept;
  [[nodiscard]] Exception execute(std::span<const std::uint8_t> pdu) noexcept;

  job::Machine& machine_;
  Executor& executor_;
  Settings settings_;
  std::int64_t now_us_ = 0;
  Bank bank_;
  Pdu pdu_{};  ///< The response being made.
  std::size_t pdu_bytes_ = 0;
};

}  // namespace flatpose::modbus
