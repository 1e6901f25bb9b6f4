#pragma once
// A PDU as a request: understood and held against the map before anybody executes it.
// Source: MODBUS Application Protocol Specification V1.1b3.

#include <cstdint>
#include <span>

namespace flatpose::modbus {

enum class Function : std::uint8_t {
  kReadCoils = 1,
  kReadDiscreteInputs = 2,
  kReadHoldingRegisters = 3,
  kReadInputRegisters = 4,
  kWriteCoil = 5,
  kWriteRegister = 6,
  kWriteCoils = 15,
  kWriteRegisters = 16,
  kReportServerId = 17,
  kMaskWriteRegister = 22,
  kReadWriteRegisters = 23,
  kEncapsulated = 43,
};

enum class Exception : std::uint8_t {
  kNone = 0,
  kIllegalFunction = 1,
  kIllegalAddress = 2,
  kIllegalValue = 3,
  kDeviceFailure = 4,
  kBusy = 6,         ///< Another master holds the lease.
  kNoTarget = 0x0b,  ///< A unit id that is not served here.
};

/// Coils are the bits of the control register, discrete inputs those of `bits`.
enum class Space : std::uint8_t { kNone, kRegisters, kCoils, kDiscreteInputs };

struct Range {
  Space space = Space::kNone;
  int address = 0;
  int count = 0;
};

struct Request {
  Function function = Function::kReadHoldingRegisters;
  Range read;   ///< Space::kNone: the request reads nothing.
  Range write;  ///< Space::kNone: the request writes nothing.
  std::span<const std::uint8_t> pdu;

  [[nodiscard]] bool is_write() const noexcept { return write.space != Space::kNone; }
};

inline constexpr int kReadRegistersMax = 125;
inline constexpr int kWriteRegistersMax = 123;
inline constexpr int kReadWriteRegistersMax = 121;  ///< Written by function 23.
inline constexpr int kReadBitsMax = 2000;
inline constexpr int kWriteBitsMax = 1968;

/// Says what is wrong in the order of the specification: function, then length, count and value,
/// then address. kNone: it can be executed as it stands.
[[nodiscard]] Exception understand(std::span<const std::uint8_t> pdu, Request& request) noexcept;

}  // namespace flatpose::modbus
