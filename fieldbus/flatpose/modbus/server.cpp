#include "flatpose/modbus/server.hpp"

#include <algorithm>
#include <cstddef>

#include "flatpose/modbus/words.hpp"

namespace flatpose::modbus {
namespace {

constexpr std::uint8_t kExceptionFlag = 0x80;

template <std::size_t kCount>
void spread_bits(std::uint16_t word, std::array<std::uint8_t, kCount>& bits) noexcept {
  for (std::size_t i = 0; i < kCount; ++i) bits[i] = static_cast<std::uint8_t>(word >> i & 1);
}

template <std::size_t kCount>
std::uint16_t gathered_bits(const std::array<std::uint8_t, kCount>& bits) noexcept {
  unsigned word = 0;
  for (std::size_t i = 0; i < kCount; ++i) word |= bits[i] != 0 ? 1U << i : 0U;
  return static_cast<std::uint16_t>(word);
}

// The bank as a write finds it: registers, and coils from the control register.
void lay_out(const job::CommandImage& image, const Range& range, Bank& bank) noexcept {
  job::Snapshot snapshot;
  snapshot.image = image;
  if (range.space == Space::kRegisters) {
    const auto count = static_cast<std::size_t>(range.count);
    const auto address = static_cast<std::size_t>(range.address);
    result_map::read_registers(snapshot, {}, range.address,
                               std::span(bank.registers).subspan(address, count));
  }
  spread_bits(image.control, bank.coils);
}

void take_over(const Bank& bank, const Range& range, job::CommandImage& image) noexcept {
  if (range.space == Space::kCoils) {
    image.control = gathered_bits(bank.coils);
  } else {
    const auto count = static_cast<std::size_t>(range.count);
    const auto address = static_cast<std::size_t>(range.address);
    result_map::write_registers(image, range.address,
                                std::span(bank.registers).subspan(address, count));
  }
}

bool touches(result_map::Field field, const Range& range) noexcept {
  return range.space == Space::kRegisters && result_map::touches(field, range.address, range.count);
}

}  // namespace

Served Server::serve(std::int64_t now_us, const job::Master& master, const Adu& adu,
                     std::span<std::uint8_t, kAduBytesMax> response) noexcept {
  Served served;
  now_us_ = now_us;
  pdu_bytes_ = 0;
  Request request;
  served.exception = is_served(adu.unit) ? understand(adu.pdu, request) : Exception::kNoTarget;
  if (served.exception == Exception::kNone) {
    served.exception = answer(master, request, served);
  } else {
    served.outputs = machine_.process(now_us, {});
  }
  if (served.exception != Exception::kNone) {
    const std::uint8_t function = adu.pdu.empty() ? std::uint8_t{0} : adu.pdu[0];
    pdu_[0] = static_cast<std::uint8_t>(function | kExceptionFlag);
    pdu_[1] = static_cast<std::uint8_t>(served.exception);
    pdu_bytes_ = 2;
  }
  served.bytes = compose(adu.transaction, adu.unit, std::span(pdu_).first(pdu_bytes_), response);
  return served;
}

Exception Server::answer(const job::Master& master, const Request& request,
                         Served& served) noexcept {
  if (request.function == Function::kReadWriteRegisters)
    return read_and_write(master, request, served);
  if (request.is_write()) return write(master, request, served);
  const job::Request heard{master, false, {}, false, false};
  served.outputs = machine_.process(now_us_, {.request = &heard});
  if (request.function == Function::kEncapsulated)
    return read_identification(settings_.identity, request.pdu, pdu_, pdu_bytes_);
  if (request.function != Function::kReportServerId) return read(master, request.read, request.pdu);
  pdu_bytes_ = report_server_id(settings_.identity, pdu_);
  return Exception::kNone;
}

Exception Server::execute(std::span<const std::uint8_t> pdu) noexcept {
  pdu_bytes_ = executor_.execute(pdu, bank_, pdu_);
  const bool is_done = pdu_bytes_ > 0 && pdu_bytes_ <= pdu_.size() && pdu_[0] == pdu[0];
  return is_done ? Exception::kNone : Exception::kDeviceFailure;
}

Exception Server::read(const job::Master& master, const Range& range,
                       std::span<const std::uint8_t> pdu) noexcept {
  const job::Snapshot snapshot = machine_.snapshot(master.address);
  if (range.space == Space::kRegisters) {
    const auto count = static_cast<std::size_t>(range.count);
    const auto address = static_cast<std::size_t>(range.address);
    result_map::read_registers(snapshot, settings_.format, range.address,
                               std::span(bank_.registers).subspan(address, count));
  }
  spread_bits(snapshot.image.control, bank_.coils);
  spread_bits(snapshot.bits, bank_.discrete_inputs);
  return execute(pdu);
}

// Executed on the bank first: what the machine then refuses was never applied.
Exception Server::write(const job::Master& master, const Request& request,
                        Served& served) noexcept {
  job::Request wish{master, true, machine_.image_for(master), false, false};
  lay_out(wish.image, request.write, bank_);
  const Exception exception = execute(request.pdu);
  if (exception != Exception::kNone) {
    served.outputs = machine_.process(now_us_, {});
    return exception;
  }
  take_over(bank_, request.write, wish.image);
  wish.touches_number = touches(result_map::Field::kCommandNumber, request.write);
  wish.touches_control =
      request.write.space == Space::kCoils || touches(result_map::Field::kControl, request.write);
  served.outputs = machine_.process(now_us_, {.request = &wish});
  switch (served.outputs.verdict) {
    case job::Verdict::kGranted: return Exception::kNone;
    case job::Verdict::kNotOwner: return Exception::kBusy;
    case job::Verdict::kBadValue: return Exception::kIllegalValue;
  }
  return Exception::kDeviceFailure;
}

Exception Server::read_and_write(const job::Master& master, const Request& request,
                                 Served& served) noexcept {
  Pdu part{};
  const std::span<const std::uint8_t> tail = request.pdu.subspan(5);  // as in function 16
  part[0] = static_cast<std::uint8_t>(Function::kWriteRegisters);
  std::copy(tail.begin(), tail.end(), part.begin() + 1);
  const Request writing{Function::kWriteRegisters,
                        {},
                        request.write,
                        std::span<const std::uint8_t>(part).first(tail.size() + 1)};
  Exception exception = write(master, writing, served);
  if (exception != Exception::kNone) return exception;

  std::copy_n(request.pdu.begin(), 5, part.begin());
  part[0] = static_cast<std::uint8_t>(Function::kReadHoldingRegisters);
  exception = read(master, request.read, std::span<const std::uint8_t>(part).first(5));
  pdu_[0] = static_cast<std::uint8_t>(Function::kReadWriteRegisters);
  return exception;
}

}  // namespace flatpose::modbus
