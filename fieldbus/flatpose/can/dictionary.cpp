#include "flatpose/can/dictionary.hpp"

#include <algorithm>

#include "flatpose/can/parameters.hpp"
#include "flatpose/result_map/registers.hpp"
#include "flatpose/result_map/table.hpp"

namespace flatpose::can {
namespace {

using result_map::Entry;
using enum DataType;
using enum Access;

constexpr Group kGroups[] = {
    {0x1000, "Device type", ObjectCode::kVariable},
    {0x1001, "Error register", ObjectCode::kVariable},
    {0x1003, "Pre-defined error field", ObjectCode::kArray},
    {0x1005, "COB-ID SYNC message", ObjectCode::kVariable},
    {0x1008, "Manufacturer device name", ObjectCode::kVariable},
    {0x1009, "Manufacturer hardware version", ObjectCode::kVariable},
    {0x100a, "Manufacturer software version", ObjectCode::kVariable},
    {0x1014, "COB-ID EMCY", ObjectCode::kVariable},
    {0x1016, "Consumer heartbeat time", ObjectCode::kArray},
    {0x1017, "Producer heartbeat time", ObjectCode::kVariable},
    {0x1018, "Identity object", ObjectCode::kRecord},
    {0x1200, "SDO server parameter", ObjectCode::kRecord},
    {0x1400, "RPDO communication parameter 1", ObjectCode::kRecord},
    {0x1600, "RPDO mapping parameter 1", ObjectCode::kRecord},
    {0x1800, "TPDO communication parameter 1", ObjectCode::kRecord},
    {0x1801, "TPDO communication parameter 2", ObjectCode::kRecord},
    {0x1802, "TPDO communication parameter 3", ObjectCode::kRecord},
    {0x1803, "TPDO communication parameter 4", ObjectCode::kRecord},
    {0x1a00, "TPDO mapping parameter 1", ObjectCode::kRecord},
    {0x1a01, "TPDO mapping parameter 2", ObjectCode::kRecord},
    {0x1a02, "TPDO mapping parameter 3", ObjectCode::kRecord},
    {0x1a03, "TPDO mapping parameter 4", ObjectCode::kRecord},
    {kCommandIndex, "Command", ObjectCode::kRecord},
    {0x2001, "Test values", ObjectCode::kRecord},
    {kSmallCommandIndex, "Command, small", ObjectCode::kRecord},
    {kReportIndex, "Result, small", ObjectCode::kRecord},
    {kWholeCommandIndex, "Command, whole", ObjectCode::kVariable},
    {kFdReportIndex, "Result, whole, in a CAN FD frame", ObjectCode::kRecord},
    {kResultIndex, "Result", ObjectCode::kRecord},
    {kWholeResultIndex, "Result, whole", ObjectCode::kVariable},
    {kFurtherIndex, "Further match 1", ObjectCode::kRecord},
    {kFurtherIndex + 1, "Further match 2", ObjectCode::kRecord},
    {kFurtherIndex + 2, "Further match 3", ObjectCode::kRecord},
    {kFurtherIndex + 3, "Further match 4", ObjectCode::kRecord},
    {kFurtherIndex + 4, "Further match 5", ObjectCode::kRecord},
    {kFurtherIndex + 5, "Further match 6", ObjectCode::kRecord},
    {kFurtherIndex + 6, "Further match 7", ObjectCode::kRecord},
    {kFurtherIndex + 7, "Further match 8", ObjectCode::kRecord},
};

constexpr const char* kHighest = "Highest sub-index supported";

// "flat"
constexpr std::uint32_t kProductCode = 0x74616c66;
// The map's, in the upper half.
constexpr std::uint32_t kRevision = std::uint32_t{result_map::kMapVersion} << 16;

constexpr Object kObjects[] = {
    {0x1000, 0, "Device type", kUnsigned32, kConst, 0},
    {0x1001, 0, "Error register", kUnsigned8, kReadOnly, 0},
    {0x1003, 0, "Number of errors", kUnsigned8, kReadWrite, 0},
    {0x1005, 0, "COB-ID SYNC message", kUnsigned32, kReadWrite, kSyncId},
    {0x1008, 0, "Manufacturer device name", kVisibleString, kConst, 0},
    {0x1009, 0, "Manufacturer hardware version", kVisibleString, kConst, 0},
    {0x100a, 0, "Manufacturer software version", kVisibleString, kConst, 0},
    {0x1014, 0, "COB-ID EMCY", kUnsigned32, kReadWrite, kEmergencyBase, true},
    {0x1016, 0, kHighest, kUnsigned8, kConst, 1},
    {0x1016, 1, "The master's heartbeat", kUnsigned32, kReadWrite,
     std::uint32_t{Config{}.master} << 16 | Config{}.master_silence_ms},
    {0x1017, 0, "Producer heartbeat time", kUnsigned16, kReadWrite, Config{}.heartbeat_ms},
    {0x1018, 0, kHighest, kUnsigned8, kConst, 4},
    {0x1018, 1, "Vendor-ID", kUnsigned32, kConst, 0},
    {0x1018, 2, "Product code", kUnsigned32, kConst, kProductCode},
    {0x1018, 3, "Revision number", kUnsigned32, kConst, kRevision},
    {0x1018, 4, "Serial number", kUnsigned32, kReadOnly, 0},
    {0x1200, 0, kHighest, kUnsigned8, kConst, 2},
    {0x1200, 1, "COB-ID client to server (rx)", kUnsigned32, kConst, kSdoRequestBase, true},
    {0x1200, 2, "COB-ID server to client (tx)", kUnsigned32, kConst, kSdoAnswerBase, true},
    {0x1400, 0, kHighest, kUnsigned8, kConst, 2},
    {0x1400, 1, "COB-ID used by RPDO", kUnsigned32, kReadWrite, kRpdoBase, true},
    {0x1400, 2, "Transmission type", kUnsigned8, kReadWrite, 254},
    {kSmallCommandIndex, 0, kHighest, kUnsigned8, kConst, 3},
    {kSmallCommandIndex, kSmallCommand, "command", kUnsigned8, kReadWrite, 1, false,
     Mapping::kRpdo},
    {kSmallCommandIndex, kSmallOutcome, "pick_outcome", kUnsigned8, kReadWrite, 0, false,
     Mapping::kRpdo},
    {kSmallCommandIndex, kSmallArgument, "argument", kUnsigned16, kReadWrite, 1, false,
     Mapping::kRpdo},
    {kWholeCommandIndex, 0, "Command, whole", kOctetString, kReadWrite, 0},
    {kWholeResultIndex, 0, "Result, whole", kOctetString, kReadOnly, 0},
};

constexpr Mapped kRpdo[] = {{kCommandIndex, 1, 16},
                            {kCommandIndex, 2, 16},
                            {kSmallCommandIndex, kSmallCommand, 8},
                            {kSmallCommandIndex, kSmallOutcome, 8},
                            {kSmallCommandIndex, kSmallArgument, 16}};

constexpr const char* kMappedNames[] = {"Mapped object 1", "Mapped object 2", "Mapped object 3",
                                        "Mapped object 4", "Mapped object 5", "Mapped object 6"};

constexpr DataType type_of(result_map::Type type) noexcept {
  switch (type) {
    case result_map::Type::kUint16: return kUnsigned16;
    case result_map::Type::kInt16: return kInteger16;
    case result_map::Type::kUint32: return kUnsigned32;
    case result_map::Type::kInt32: return kInteger32;
    case result_map::Type::kFloat32: return kReal32;
  }
  return kUnsigned32;
}

constexpr DataType type_of(const ReportLine& line) noexcept {
  if (line.bytes == 1) return line.is_signed ? kInteger8 : kUnsigned8;
  return line.bytes == 2 ? kUnsigned16 : kInteger24;
}

constexpr std::uint32_t lowest(std::size_t bytes, std::uint32_t value) noexcept {
  return value & (0xffffffff >> (32 - 8 * bytes));
}

Object count_of(std::uint16_t index, std::uint32_t count) noexcept {
  return {index, 0, kHighest, kUnsigned8, kConst, count};
}

Abort find_history(std::uint8_t subindex, Object& object) noexcept {
  if (subindex > 8) return Abort::kNoSubindex;
  object = {0x1003, subindex, "Standard error field", kUnsigned32, kReadOnly, 0};
  return Abort::kNone;
}

Abort find_mapping(std::uint16_t index, std::uint8_t subindex, Object& object) noexcept {
  const bool is_rpdo = index == 0x1600;
  const int tpdo = index - 0x1a00;
  const auto count =
      static_cast<std::uint32_t>(is_rpdo ? std::size(kRpdo) : fields_of_tpdo(tpdo).size());
  if (subindex > count) return Abort::kNoSubindex;
  object = count_of(index, count);
  if (subindex == 0) return Abort::kNone;
  const Mapped mapped = is_rpdo ? kRpdo[subindex - 1] : tpdo_mapped(tpdo, subindex - 1);
  object = {index, subindex, kMappedNames[subindex - 1], kUnsigned32, kConst, mapped.value()};
  return Abort::kNone;
}

// Of a TPDO, and of the whole result's frame, which is off at start unless the config has it on.
Abort find_transmit(std::uint16_t index, std::uint8_t subindex, Object& object) noexcept {
  const TpdoSettings start;
  const bool is_fd = index == kFdReportIndex;
  const std::uint32_t id = is_fd ? kFdReportBase | kNotValid : tpdo_id(index - 0x1800, 0);
  switch (subindex) {
    case 0: object = count_of(index, 5); return Abort::kNone;
    case 1:
      object = {index,       1,          is_fd ? "COB-ID used by the frame" : "COB-ID used by TPDO",
                kUnsigned32, kReadWrite, id | kNoRemote,
                true};
      return Abort::kNone;
    case 2: object = {index, 2, "Transmission type", kUnsigned8, kReadWrite, start.type}; break;
    case 3:
      object = {index, 3, "Inhibit time", kUnsigned16, kReadWrite, start.inhibit_100us};
      break;
    case 5:
      object = {index, 5, "Event timer", kUnsigned16, kReadWrite, start.event_timer_ms};
      break;
    default: return Abort::kNoSubindex;
  }
  return Abort::kNone;
}

Abort find_report(std::uint8_t subindex, Object& object) noexcept {
  if (subindex > kReportFieldCount) return Abort::kNoSubindex;
  object = count_of(kReportIndex, kReportFieldCount);
  if (subindex == 0) return Abort::kNone;
  const ReportLine& line = report_lines()[subindex - 1U];
  const auto raw = static_cast<std::uint32_t>(report_of({}, {})[line.field]);
  const std::uint32_t initial = lowest(line.bytes, raw);
  object = {kReportIndex, subindex, line.name, type_of(line),
            kReadOnly,    initial,  false,     Mapping::kTpdo};
  return Abort::kNone;
}

Abort find_register(std::uint16_t index, std::uint8_t subindex, Object& object) noexcept {
  std::uint8_t highest = 0;
  for (const Entry& entry : result_map::entries()) {
    if (entry.can_index != index) continue;
    highest = std::max(highest, entry.can_subindex);
    if (entry.can_subindex != subindex) continue;
    const bool is_written = entry.table == result_map::Table::kHolding;
    object = {index,
              subindex,
              entry.name,
              type_of(entry.type),
              is_written ? kReadWrite : kReadOnly,
              lowest(2U * entry.words(), result_map::raw_of(entry, {}, {}))};
    object.entry = &entry;
    for (const Mapped& mapped : kRpdo) {
      if (mapped.index == index && mapped.subindex == subindex) object.mapping = Mapping::kRpdo;
    }
    return Abort::kNone;
  }
  if (highest == 0) return Abort::kNoObject;
  if (subindex != 0) return Abort::kNoSubindex;
  object = count_of(index, highest);
  return Abort::kNone;
}

}  // namespace

std::span<const Mapped> rpdo_mapping() noexcept { return kRpdo; }

Mapped tpdo_mapped(int tpdo, int n) noexcept {
  const ReportField field = fields_of_tpdo(tpdo)[static_cast<std::size_t>(n)];
  return {kReportIndex, static_cast<std::uint8_t>(field),
          static_cast<std::uint8_t>(8 * line_of(field).bytes)};
}

int group_count() noexcept { return static_cast<int>(std::size(kGroups)); }
Group group_at(int i) noexcept { return kGroups[i]; }

Abort find_object(std::uint16_t index, std::uint8_t subindex, Object& object) noexcept {
  if (index == 0x1003 && subindex > 0) return find_history(subindex, object);
  if (index == 0x1600 || (index >= 0x1a00 && index < 0x1a00 + kTpdoCount))
    return find_mapping(index, subindex, object);
  if (index == kFdReportIndex || (index >= 0x1800 && index < 0x1800 + kTpdoCount))
    return find_transmit(index, subindex, object);
  if (index == kReportIndex) return find_report(subindex, object);
  bool has_index = false;
  for (const Object& known : kObjects) {
    if (known.index != index) continue;
    has_index = true;
    if (known.subindex != subindex) continue;
    object = known;
    return Abort::kNone;
  }
  return has_index ? Abort::kNoSubindex : find_register(index, subindex, object);
}

}  // namespace flatpose::can
