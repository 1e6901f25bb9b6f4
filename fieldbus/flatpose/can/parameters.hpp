#pragma once
// The communication objects that can be set, 1000h to 1FFFh. Identifiers are those of the
// predefined connection set; of a PDO's only the bit that says whether it exists can be changed.
// The whole result's frame is set like a TPDO, and its identifier too.

#include <array>
#include <cstdint>

#include "flatpose/can/abort.hpp"
#include "flatpose/can/config.hpp"
#include "flatpose/can/transmit_pdo.hpp"

namespace flatpose::can {

inline constexpr std::uint32_t kNotValid = 0x80000000;  ///< Of a PDO's COB-ID, and EMCY's.
inline constexpr std::uint16_t kFdReportIndex = 0x2006;
inline constexpr std::uint32_t kNoRemote = 0x40000000;  ///< Of a PDO's; they never are answered.

struct Parameters {
  bool emergency_is_valid = true;                ///< 1014h
  std::uint8_t watched_node = 0;                 ///< 1016h:1
  std::uint16_t watched_ms = 0;                  ///< 1016h:1
  std::uint16_t heartbeat_ms = 0;                ///< 1017h
  bool rpdo_is_valid = true;                     ///< 1400h:1
  std::uint8_t rpdo_type = 254;                  ///< 1400h:2; up to 240: taken at the next SYNC.
  std::array<TpdoSettings, kTpdoCount> tpdos{};  ///< 1800h to 1803h
  TpdoSettings fd{.is_valid = false};            ///< 2006h
  std::uint16_t fd_id = 0;                       ///< 2006h:1

  [[nodiscard]] static Parameters at_start(const Config& config) noexcept;

  /// The value of an object here; false: it is none of these.
  [[nodiscard]] bool read(std::uint16_t index, std::uint8_t subindex, std::uint8_t node,
                          std::uint32_t& value) const noexcept;

  /// Sets one that the dictionary lets be written.  Returns why not, and nothing has changed then.
  [[nodiscard]] Abort write(std::uint16_t index, std::uint8_t subindex, std::uint8_t node,
                            std::uint32_t value) noexcept;

  friend bool operator==(const Parameters&, const Parameters&) = default;
};

}  // namespace flatpose::can
