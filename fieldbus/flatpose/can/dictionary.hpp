#pragma once
// The object dictionary: what there is, of which type, and who may write it. Communication objects
// as CiA 301 has them; of ours those of the register map, from its own table, and what only CAN
// needs: small numbers for PDOs, and the command and the result as one object each, so that neither
// can be torn.
//
//   2000h command   2001h test values   2002h command, small   2003h result, small (see report.hpp)
//   2004h command, whole   2006h when the whole result goes out in an FD frame (see fd_report.hpp)
//   2010h result   2011h result, whole   2020h.. further matches

#include <cstdint>
#include <span>

#include "flatpose/can/abort.hpp"
#include "flatpose/can/frame.hpp"
#include "flatpose/can/report.hpp"
#include "flatpose/result_map/entry.hpp"

namespace flatpose::can {

/// The numbers are those of CiA 301.
enum class DataType : std::uint8_t {
  kInteger8 = 0x02,
  kInteger16 = 0x03,
  kInteger32 = 0x04,
  kUnsigned8 = 0x05,
  kUnsigned16 = 0x06,
  kUnsigned32 = 0x07,
  kReal32 = 0x08,
  kVisibleString = 0x09,
  kOctetString = 0x0a,
  kInteger24 = 0x10,
};
enum class ObjectCode : std::uint8_t { kVariable = 7, kArray = 8, kRecord = 9 };
enum class Access : std::uint8_t { kConst, kReadOnly, kReadWrite };
enum class Mapping : std::uint8_t { kNone, kTpdo, kRpdo };

struct Object {
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  const char* name = "";
  DataType type = DataType::kUnsigned32;
  Access access = Access::kReadOnly;
  std::uint32_t initial = 0;  ///< A constant's value; what another starts with.
  bool adds_node = false;     ///< The node id is added to `initial`.
  Mapping mapping = Mapping::kNone;
  const result_map::Entry* entry = nullptr;  ///< Where it comes from, if from the register map.
};

/// An index: one object, or several under one roof.
struct Group {
  std::uint16_t index = 0;
  const char* name = "";
  ObjectCode code = ObjectCode::kRecord;
};

inline constexpr std::uint16_t kCommandIndex = 0x2000;
inline constexpr std::uint16_t kSmallCommandIndex = 0x2002;
inline constexpr std::uint16_t kReportIndex = 0x2003;
inline constexpr std::uint16_t kWholeCommandIndex = 0x2004;
inline constexpr std::uint16_t kResultIndex = 0x2010;
inline constexpr std::uint16_t kWholeResultIndex = 0x2011;
inline constexpr std::uint16_t kFurtherIndex = 0x2020;
inline constexpr int kWholeCommandBytes = 14;
/// Subindices of 2002h.
inline constexpr std::uint8_t kSmallCommand = 1;
inline constexpr std::uint8_t kSmallOutcome = 2;
inline constexpr std::uint8_t kSmallArgument = 3;

[[nodiscard]] constexpr std::size_t bytes_of(DataType type) noexcept {
  switch (type) {
    case DataType::kInteger8:
    case DataType::kUnsigned8: return 1;
    case DataType::kInteger16:
    case DataType::kUnsigned16: return 2;
    case DataType::kInteger24: return 3;
    case DataType::kVisibleString:
    case DataType::kOctetString: return 0;  // as many as there are
    default: return 4;
  }
}

/// What a PDO holds, in the order of its bytes, as 1600h and 1A00h have it.
struct Mapped {
  std::uint16_t index;
  std::uint8_t subindex;
  std::uint8_t bits;
  [[nodiscard]] constexpr std::uint32_t value() const noexcept {
    return static_cast<std::uint32_t>(index) << 16 | static_cast<std::uint32_t>(subindex) << 8 |
           bits;
  }
};
[[nodiscard]] std::span<const Mapped> rpdo_mapping() noexcept;
/// The n-th object of a TPDO, from 0.
[[nodiscard]] Mapped tpdo_mapped(int tpdo, int n) noexcept;

/// Every index, rising.
[[nodiscard]] int group_count() noexcept;
[[nodiscard]] Group group_at(int i) noexcept;

/// Fails: kNoObject, kNoSubindex.  Cost: a walk over the table.
[[nodiscard]] Abort find_object(std::uint16_t index, std::uint8_t subindex,
                                Object& object) noexcept;

}  // namespace flatpose::can
