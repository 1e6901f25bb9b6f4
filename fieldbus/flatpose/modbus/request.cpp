#include "flatpose/modbus/request.hpp"

#include "flatpose/job/command.hpp"
#include "flatpose/modbus/words.hpp"
#include "flatpose/result_map/table.hpp"

namespace flatpose::modbus {
namespace {

constexpr std::uint16_t kCoilOff = 0x0000;
constexpr std::uint16_t kCoilOn = 0xff00;

bool is_count(int count, int most) noexcept { return count >= 1 && count <= most; }

// function, address (2), count (2)
Exception read(Space space, int most, Request& request) noexcept {
  if (request.pdu.size() != 5) return Exception::kIllegalValue;
  request.read = {space, word_at(request.pdu, 1), word_at(request.pdu, 3)};
  return is_count(request.read.count, most) ? Exception::kNone : Exception::kIllegalValue;
}

// function, address (2), value (2)
Exception write_one(Space space, Request& request) noexcept {
  if (request.pdu.size() != 5) return Exception::kIllegalValue;
  request.write = {space, word_at(request.pdu, 1), 1};
  if (space == Space::kRegisters) return Exception::kNone;
  const std::uint16_t value = word_at(request.pdu, 3);
  return value == kCoilOff || value == kCoilOn ? Exception::kNone : Exception::kIllegalValue;
}

// function, address (2), count (2), bytes (1), values
Exception write_many(Space space, int most, Request& request) noexcept {
  if (request.pdu.size() < 6) return Exception::kIllegalValue;
  request.write = {space, word_at(request.pdu, 1), word_at(request.pdu, 3)};
  const int count = request.write.count;
  if (!is_count(count, most)) return Exception::kIllegalValue;
  const int bytes = space == Space::kRegisters ? 2 * count : (count + 7) / 8;
  const bool fits = request.pdu[5] == bytes && static_cast<int>(request.pdu.size()) == 6 + bytes;
  return fits ? Exception::kNone : Exception::kIllegalValue;
}

// function, address (2), mask to and (2), mask to or (2)
Exception mask(Request& request) noexcept {
  if (request.pdu.size() != 7) return Exception::kIllegalValue;
  request.write = {Space::kRegisters, word_at(request.pdu, 1), 1};
  return Exception::kNone;
}

// function, read address (2) and count (2), write address (2) and count (2), bytes (1), values
Exception read_write(Request& request) noexcept {
  if (request.pdu.size() < 10) return Exception::kIllegalValue;
  request.read = {Space::kRegisters, word_at(request.pdu, 1), word_at(request.pdu, 3)};
  request.write = {Space::kRegisters, word_at(request.pdu, 5), word_at(request.pdu, 7)};
  if (!is_count(request.read.count, kReadRegistersMax)) return Exception::kIllegalValue;
  const int count = request.write.count;
  if (!is_count(count, kReadWriteRegistersMax)) return Exception::kIllegalValue;
  const bool fits =
      request.pdu[9] == 2 * count && static_cast<int>(request.pdu.size()) == 10 + 2 * count;
  return fits ? Exception::kNone : Exception::kIllegalValue;
}

Exception in_form(Request& request) noexcept {
  switch (request.function) {
    case Function::kReadCoils: return read(Space::kCoils, kReadBitsMax, request);
    case Function::kReadDiscreteInputs: return read(Space::kDiscreteInputs, kReadBitsMax, request);
    case Function::kReadHoldingRegisters:
    case Function::kReadInputRegisters: return read(Space::kRegisters, kReadRegistersMax, request);
    case Function::kWriteCoil: return write_one(Space::kCoils, request);
    case Function::kWriteRegister: return write_one(Space::kRegisters, request);
    case Function::kWriteCoils: return write_many(Space::kCoils, kWriteBitsMax, request);
    case Function::kWriteRegisters:
      return write_many(Space::kRegisters, kWriteRegistersMax, request);
    case Function::kMaskWriteRegister: return mask(request);
    case Function::kReadWriteRegisters: return read_write(request);
    case Function::kReportServerId:
      return request.pdu.size() == 1 ? Exception::kNone : Exception::kIllegalValue;
    case Function::kEncapsulated: return Exception::kNone;  // see identity.hpp
  }
  return Exception::kIllegalFunction;
}

int size_of(Space space) noexcept {
  switch (space) {
    case Space::kCoils: return job::kControlBitCount;
    case Space::kDiscreteInputs: return job::kBitCount;
    case Space::kRegisters: return result_map::kRegisterCount;
    case Space::kNone: break;
  }
  return 0;
}

bool can_read(const Range& range) noexcept {
  return range.space == Space::kNone || range.address + range.count <= size_of(range.space);
}

bool can_write(const Range& range) noexcept {
  if (!can_read(range)) return false;
  for (int i = 0; range.space == Space::kRegisters && i < range.count; ++i) {
    if (!result_map::is_writable(range.address + i)) return false;
  }
  return true;
}

}  // namespace

Exception understand(std::span<const std::uint8_t> pdu, Request& request) noexcept {
  if (pdu.empty()) return Exception::kIllegalFunction;
  request = {static_cast<Function>(pdu[0]), {}, {}, pdu};
  const Exception exception = in_form(request);
  if (exception != Exception::kNone) return exception;
  const bool is_there = can_read(request.read) && can_write(request.write);
  return is_there ? Exception::kNone : Exception::kIllegalAddress;
}

}  // namespace flatpose::modbus
