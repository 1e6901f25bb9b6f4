#pragma once
// Why an SDO transfer ended (CiA 301, 7.2.4.3.17).

#include <cstdint>

namespace flatpose::can {

enum class Abort : std::uint32_t {
  kNone = 0,
  kToggle = 0x05030000,     ///< Toggle bit not alternated.
  kTimeout = 0x05040000,    ///< The next segment did not come.
  kCommand = 0x05040001,    ///< No such command: block transfers among them.
  kWriteOnly = 0x06010001,  ///< Attempt to read what can only be written.
  kReadOnly = 0x06010002,   ///< Attempt to write what can only be read.
  kNoObject = 0x06020000,
  kLength = 0x06070010,  ///< Length and type do not match.
  kTooLong = 0x06070012,
  kTooShort = 0x06070013,
  kNoSubindex = 0x06090011,
  kValue = 0x06090030,         ///< No such value.
  kLocalControl = 0x08000021,  ///< Another master holds the lease: nothing was applied.
  kDeviceState = 0x08000022,   ///< Not while it is so: a PDO's times while it is valid, a trigger
                               ///< that the handshake does not have, FD on a classic interface.
};

}  // namespace flatpose::can
