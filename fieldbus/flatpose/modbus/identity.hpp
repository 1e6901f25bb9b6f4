#pragma once
// Who answers here: functions 17 (report server id) and 43/14 (read device identification).

#include <cstdint>
#include <span>

#include "flatpose/modbus/request.hpp"

namespace flatpose::modbus {

/// Texts are cut at 30 bytes.
struct Identity {
  const char* vendor = "flatpose";
  const char* product_code = "flatpose";
  const char* revision = "";
  const char* vendor_url = "";
  const char* product_name = "flatpose: pose of flat parts";
  const char* model = "";
  const char* application = "";
};

inline constexpr std::uint8_t kServerId = 0x46;

/// Writes the response PDU.  Returns its size.
[[nodiscard]] std::size_t report_server_id(const Identity& identity,
                                           std::span<std::uint8_t> pdu) noexcept;

/// Writes the response PDU and its size.  Fails: kIllegalFunction (another type than 14),
/// kIllegalValue (length, access), kIllegalAddress (a single object that there is not).
[[nodiscard]] Exception read_identification(const Identity& identity,
                                            std::span<const std::uint8_t> request,
                                            std::span<std::uint8_t> pdu,
                                            std::size_t& pdu_bytes) noexcept;

}  // namespace flatpose::modbus
