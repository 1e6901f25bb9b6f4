#pragma once
// One line of the register map: what it is called, where it lies on either bus, how its number is
// written, and what it means.

#include <cstdint>
#include <limits>

namespace flatpose::result_map {

/// Input registers are read alone, by FC4 and by FC3 alike; holding registers are written too.
enum class Table : std::uint8_t { kHolding, kInput };

enum class Type : std::uint8_t { kUint16, kInt16, kUint32, kInt32, kFloat32 };

[[nodiscard]] constexpr int words_of(Type type) noexcept {
  return type == Type::kUint16 || type == Type::kInt16 ? 1 : 2;
}

/// What a register tells: see value.cpp.
enum class Field : std::uint8_t {
  // written by a master
  kCommandNumber,
  kCommandSession,
  kCommand,
  kJob,
  kPickNumber,
  kPickOutcome,
  kControl,
  // constants
  kTestUint16,
  kTestUint32,
  kTestFloat32,
  kMapVersion,
  // the machine
  kDoneNumber,
  kStatus,
  kBits,
  kAcceptedNumber,
  kRefusedNumber,
  kRefusedStatus,
  kScannedNumber,
  kCancelledNumber,
  kLastNumber,
  kSessionId,
  kBootCount,
  kHeartbeat,
  kReaderIsOwner,
  kOwnerAddress,
  kUptime,
  kAnswerBy,
  // the result
  kResultIsReaders,
  kFrame,
  kConvention,
  kResultJob,
  kScanNumber,
  kAge,
  kSensorTime,
  kCycleTime,
  kPartHash,
  kAlignmentHash,
  kMatchCount,
  kMatchesLeft,
  // a match
  kMatchNumber,
  kMatchIndex,
  kPart,
  kTool,
  kPick,
  kScore,
  kVisible,
  kPositionX,
  kPositionY,
  kPositionZ,
  kRotation1,
  kRotation2,
  kRotation3,
  kRotation4,
  kSigmaX,
  kSigmaY,
  kSigmaZ,
  kSigmaTurnX,
  kSigmaTurnY,
  kSigmaTurnZ,
};

/// The names that a register's numbers have.
enum class ValueSet : std::uint8_t {
  kNone,
  kCommands,
  kPickOutcomes,
  kControlBits,
  kBits,
  kAnswers,
  kRefusals,
  kFrames,
  kConventions,
};

struct Entry {
  const char* name;
  Table table;
  std::uint16_t address;  ///< Of the PDU, from zero; the first of its words.
  Type type;
  Field field;
  double scale;  ///< Value = raw x scale. Rotations: see rotation_scale().
  const char* unit;
  bool may_be_none;  ///< Has a raw value that says: there is none.
  ValueSet values;
  std::uint16_t can_index;
  std::uint8_t can_subindex;
  std::uint8_t block;  ///< 0; or which of the further matches, from 1: part of the name.
  const char* doc;

  [[nodiscard]] constexpr int words() const noexcept { return words_of(type); }
};

[[nodiscard]] constexpr bool is_rotation(Field field) noexcept {
  return field >= Field::kRotation1 && field <= Field::kRotation4;
}

}  // namespace flatpose::result_map
