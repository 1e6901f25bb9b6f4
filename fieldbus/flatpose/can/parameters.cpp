#include "flatpose/can/parameters.hpp"

namespace flatpose::can {
namespace {

constexpr std::uint16_t kTpdoIndex = 0x1800;

// Returns whether `value` is this identifier, whatever it says about existing.
constexpr bool is_id(std::uint32_t value, std::uint32_t id) noexcept {
  return (value & ~kNotValid) == id;
}

// The same of a PDO. Many masters know no bit for remote requests: none is answered in any case.
constexpr bool is_pdo_id(std::uint32_t value, std::uint32_t id) noexcept {
  return is_id(value & ~kNoRemote, id);
}

constexpr std::uint32_t id_value(std::uint32_t id, bool is_valid) noexcept {
  return is_valid ? id : id | kNotValid;
}

std::uint32_t read_tpdo(const TpdoSettings& tpdo, std::uint8_t subindex,
                        std::uint32_t id) noexcept {
  switch (subindex) {
    case 1: return id_value(id | kNoRemote, tpdo.is_valid);
    case 2: return tpdo.type;
    case 3: return tpdo.inhibit_100us;
    default: return tpdo.event_timer_ms;
  }
}

Abort write_tpdo(TpdoSettings& tpdo, std::uint8_t subindex, std::uint32_t id,
                 std::uint32_t value) noexcept {
  switch (subindex) {
    case 1:
      if (!is_pdo_id(value, id)) return Abort::kValue;
      tpdo.is_valid = (value & kNotValid) == 0;
      return Abort::kNone;
    case 2:
      if (!is_transmission_type(value)) return Abort::kValue;
      tpdo.type = static_cast<std::uint8_t>(value);
      return Abort::kNone;
    case 3:
      if (tpdo.is_valid) return Abort::kDeviceState;
      tpdo.inhibit_100us = static_cast<std::uint16_t>(value);
      return Abort::kNone;
    default: tpdo.event_timer_ms = static_cast<std::uint16_t>(value); return Abort::kNone;
  }
}

// The identifier stays while the frame exists.
Abort write_fd_id(TpdoSettings& fd, std::uint16_t& id, std::uint8_t node,
                  std::uint32_t value) noexcept {
  const std::uint32_t fresh = value & ~(kNotValid | kNoRemote);
  if (!is_fd_report_id(fresh, node)) return Abort::kValue;
  const bool is_valid = (value & kNotValid) == 0;
  if (is_valid && fd.is_valid && fresh != id) return Abort::kDeviceState;
  fd.is_valid = is_valid;
  id = static_cast<std::uint16_t>(fresh);
  return Abort::kNone;
}

}  // namespace

Parameters Parameters::at_start(const Config& config) noexcept {
  Parameters made;
  made.watched_node = config.master;
  made.watched_ms = config.master_silence_ms;
  made.heartbeat_ms = config.heartbeat_ms;
  made.fd.is_valid = config.fd_frame;
  made.fd_id = fd_report_id(config);
  return made;
}

bool Parameters::read(std::uint16_t index, std::uint8_t subindex, std::uint8_t node,
                      std::uint32_t& value) const noexcept {
  const int tpdo = index - kTpdoIndex;
  if (tpdo >= 0 && tpdo < kTpdoCount) {
    value = read_tpdo(tpdos[tpdo], subindex, tpdo_id(tpdo, node));
    return true;
  }
  switch (index) {
    case kFdReportIndex: value = read_tpdo(fd, subindex, fd_id); return true;
    case 0x1014: value = id_value(kEmergencyBase + node, emergency_is_valid); return true;
    case 0x1016: value = static_cast<std::uint32_t>(watched_node << 16) | watched_ms; return true;
    case 0x1017: value = heartbeat_ms; return true;
    case 0x1400:
      value = subindex == 1 ? id_value(kRpdoBase + node, rpdo_is_valid) : rpdo_type;
      return true;
    default: return false;
  }
}

Abort Parameters::write(std::uint16_t index, std::uint8_t subindex, std::uint8_t node,
                        std::uint32_t value) noexcept {
  const int tpdo = index - kTpdoIndex;
  if (tpdo >= 0 && tpdo < kTpdoCount)
    return write_tpdo(tpdos[tpdo], subindex, tpdo_id(tpdo, node), value);
  switch (index) {
    case kFdReportIndex:
      return subindex == 1 ? write_fd_id(fd, fd_id, node, value)
                           : write_tpdo(fd, subindex, fd_id, value);
    case 0x1005: return value == kSyncId ? Abort::kNone : Abort::kValue;
    case 0x1014:
      if (!is_id(value, kEmergencyBase + node)) return Abort::kValue;
      emergency_is_valid = (value & kNotValid) == 0;
      return Abort::kNone;
    case 0x1016:
      if (value >> 16 > kNodeMax || value >> 16 == node) return Abort::kValue;
      watched_node = static_cast<std::uint8_t>(value >> 16);
      watched_ms = static_cast<std::uint16_t>(value);
      return Abort::kNone;
    case 0x1017: heartbeat_ms = static_cast<std::uint16_t>(value); return Abort::kNone;
    case 0x1400:
      if (subindex == 1) {
        if (!is_pdo_id(value, kRpdoBase + node)) return Abort::kValue;
        rpdo_is_valid = (value & kNotValid) == 0;
        return Abort::kNone;
      }
      if (!is_transmission_type(value)) return Abort::kValue;
      rpdo_type = static_cast<std::uint8_t>(value);
      return Abort::kNone;
    default: return Abort::kReadOnly;
  }
}

}  // namespace flatpose::can
