#include "flatpose/result_map/table.hpp"

#include <array>
#include <cstddef>

namespace flatpose::result_map {
namespace {

constexpr Entry kSingle[] = {
    {"command_number", Table::kHolding, 0, Type::kUint16, Field::kCommandNumber, 1, "", false,
     ValueSet::kNone, 0x2000, 1, 0,
     "0 does nothing; any other number that is not your last one starts `command`, with all that "
     "the same request writes"},
    {"command_session", Table::kHolding, 1, Type::kUint16, Field::kCommandSession, 1, "", false,
     ValueSet::kNone, 0x2000, 2, 0,
     "set it to session_id: a number left over from before a restart is then refused; 0 is not "
     "checked"},
    {"command", Table::kHolding, 2, Type::kUint16, Field::kCommand, 1, "", false,
     ValueSet::kCommands, 0x2000, 3, 0, "what the number starts; 1 at start"},
    {"job", Table::kHolding, 3, Type::kUint16, Field::kJob, 1, "", false, ValueSet::kNone, 0x2000,
     4, 0, "which job; 1 at start"},
    {"pick_number", Table::kHolding, 4, Type::kUint16, Field::kPickNumber, 1, "", false,
     ValueSet::kNone, 0x2000, 5, 0, "report_pick: the command whose pose was tried"},
    {"pick_outcome", Table::kHolding, 5, Type::kUint16, Field::kPickOutcome, 1, "", false,
     ValueSet::kPickOutcomes, 0x2000, 6, 0, "report_pick: how it went"},
    {"control", Table::kHolding, 6, Type::kUint16, Field::kControl, 1, "", false,
     ValueSet::kControlBits, 0x2000, 7, 0,
     "only with handshake = \"bits\", also coils from 0; else it stays 0"},
    {"test_uint16", Table::kInput, 10, Type::kUint16, Field::kTestUint16, 1, "", false,
     ValueSet::kNone, 0x2001, 1, 0, "always 0x1234"},
    {"test_uint32", Table::kInput, 11, Type::kUint32, Field::kTestUint32, 1, "", false,
     ValueSet::kNone, 0x2001, 2, 0, "always 0x12345678: settles the order of words and bytes"},
    {"test_float32", Table::kInput, 13, Type::kFloat32, Field::kTestFloat32, 1, "", false,
     ValueSet::kNone, 0x2001, 3, 0, "always 123456.0"},
    {"map_version", Table::kInput, 100, Type::kUint16, Field::kMapVersion, 1, "", false,
     ValueSet::kNone, 0x2010, 1, 0, "of this map"},
    {"done_number", Table::kInput, 101, Type::kUint16, Field::kDoneNumber, 1, "", false,
     ValueSet::kNone, 0x2010, 2, 0,
     "the command that this result is of; 0: no result. Head of the block"},
    {"status", Table::kInput, 102, Type::kInt16, Field::kStatus, 1, "", false, ValueSet::kAnswers,
     0x2010, 3, 0, "how it ended"},
    {"bits", Table::kInput, 103, Type::kUint16, Field::kBits, 1, "", false, ValueSet::kBits, 0x2010,
     4, 0, "also discrete inputs from 0"},
    {"accepted_number", Table::kInput, 104, Type::kUint16, Field::kAcceptedNumber, 1, "", false,
     ValueSet::kNone, 0x2010, 5, 0, "the last command accepted"},
    {"refused_number", Table::kInput, 105, Type::kUint16, Field::kRefusedNumber, 1, "", false,
     ValueSet::kNone, 0x2010, 6, 0, "the command refused; 0 when one was accepted since"},
    {"refused_status", Table::kInput, 106, Type::kUint16, Field::kRefusedStatus, 1, "", false,
     ValueSet::kRefusals, 0x2010, 7, 0, "why"},
    {"scanned_number", Table::kInput, 107, Type::kUint16, Field::kScannedNumber, 1, "", false,
     ValueSet::kNone, 0x2010, 8, 0, "the command whose scan is acquired: robot or belt may move"},
    {"cancelled_number", Table::kInput, 108, Type::kUint16, Field::kCancelledNumber, 1, "", false,
     ValueSet::kNone, 0x2010, 9, 0, "the command that the last cancel ended"},
    {"last_number", Table::kInput, 109, Type::kUint16, Field::kLastNumber, 1, "", false,
     ValueSet::kNone, 0x2010, 10, 0, "the last command_number from your address: count on from it"},
    {"session_id", Table::kInput, 110, Type::kUint16, Field::kSessionId, 1, "", false,
     ValueSet::kNone, 0x2010, 11, 0, "another at each start"},
    {"boot_count", Table::kInput, 111, Type::kUint16, Field::kBootCount, 1, "", false,
     ValueSet::kNone, 0x2010, 12, 0, "starts so far"},
    {"heartbeat", Table::kInput, 112, Type::kUint16, Field::kHeartbeat, 1, "", false,
     ValueSet::kNone, 0x2010, 13, 0, "counts while both search and scan source live"},
    {"reader_is_owner", Table::kInput, 113, Type::kUint16, Field::kReaderIsOwner, 1, "", false,
     ValueSet::kNone, 0x2010, 14, 0, "1: you hold the lease, and others' writes are refused"},
    {"owner_address", Table::kInput, 114, Type::kUint32, Field::kOwnerAddress, 1, "", false,
     ValueSet::kNone, 0x2010, 15, 0,
     "IPv4 of the owner, 192.0.2.1 as 0xC0000201; a CAN node's id; 0: none"},
    {"uptime_s", Table::kInput, 116, Type::kUint32, Field::kUptime, 1, "s", false, ValueSet::kNone,
     0x2010, 16, 0, "since the start"},
    {"answer_by_ms", Table::kInput, 118, Type::kUint32, Field::kAnswerBy, 1, "ms", false,
     ValueSet::kNone, 0x2010, 17, 0,
     "within this after acceptance an answer comes in any case: for your watchdog"},
    {"result_is_readers", Table::kInput, 120, Type::kUint16, Field::kResultIsReaders, 1, "", false,
     ValueSet::kNone, 0x2010, 18, 0, "1: you asked for this result"},
    {"frame", Table::kInput, 121, Type::kUint16, Field::kFrame, 1, "", false, ValueSet::kFrames,
     0x2010, 19, 0, "what the pose counts from"},
    {"convention", Table::kInput, 122, Type::kUint16, Field::kConvention, 1, "", false,
     ValueSet::kConventions, 0x2010, 20, 0, "what the rotation numbers are"},
    {"result_job", Table::kInput, 123, Type::kUint16, Field::kResultJob, 1, "", false,
     ValueSet::kNone, 0x2010, 21, 0, "the job of this result"},
    {"part", Table::kInput, 124, Type::kUint16, Field::kPart, 1, "", true, ValueSet::kNone, 0x2010,
     22, 0, "which of the job's parts, from 1"},
    {"match_count", Table::kInput, 125, Type::kUint16, Field::kMatchCount, 1, "", false,
     ValueSet::kNone, 0x2010, 23, 0, "found in this scan"},
    {"match_index", Table::kInput, 126, Type::kUint16, Field::kMatchIndex, 1, "", false,
     ValueSet::kNone, 0x2010, 24, 0, "which of them this is, from 1, best first; 0: no pose"},
    {"matches_left", Table::kInput, 127, Type::kUint16, Field::kMatchesLeft, 1, "", false,
     ValueSet::kNone, 0x2010, 25, 0, "how often next will find one more"},
    {"score", Table::kInput, 128, Type::kInt16, Field::kScore, 0.0001, "", true, ValueSet::kNone,
     0x2010, 26, 0, "confirmed share of what is visible, 0 to 1"},
    {"visible", Table::kInput, 129, Type::kInt16, Field::kVisible, 0.0001, "", true,
     ValueSet::kNone, 0x2010, 27, 0, "share of the part that could be seen, 0 to 1"},
    {"scan_number", Table::kInput, 130, Type::kUint32, Field::kScanNumber, 1, "", false,
     ValueSet::kNone, 0x2010, 28, 0, "of the scan; 0: none"},
    {"age_ms", Table::kInput, 132, Type::kUint32, Field::kAge, 1, "ms", true, ValueSet::kNone,
     0x2010, 29, 0, "since the end of acquisition, at the moment of this read"},
    {"sensor_time_us", Table::kInput, 134, Type::kUint32, Field::kSensorTime, 1, "us", true,
     ValueSet::kNone, 0x2010, 30, 0, "from trigger to the end of acquisition"},
    {"cycle_time_us", Table::kInput, 136, Type::kUint32, Field::kCycleTime, 1, "us", true,
     ValueSet::kNone, 0x2010, 31, 0, "from the scan in memory to the result"},
    {"part_hash", Table::kInput, 138, Type::kUint32, Field::kPartHash, 1, "", false,
     ValueSet::kNone, 0x2010, 32, 0, "of the template in use"},
    {"alignment_hash", Table::kInput, 140, Type::kUint32, Field::kAlignmentHash, 1, "", false,
     ValueSet::kNone, 0x2010, 33, 0, "of the alignment in use; 0: none"},
    {"position_x", Table::kInput, 142, Type::kInt32, Field::kPositionX, 0.001, "mm", true,
     ValueSet::kNone, 0x2010, 34, 0, ""},
    {"position_y", Table::kInput, 144, Type::kInt32, Field::kPositionY, 0.001, "mm", true,
     ValueSet::kNone, 0x2010, 35, 0, ""},
    {"position_z", Table::kInput, 146, Type::kInt32, Field::kPositionZ, 0.001, "mm", true,
     ValueSet::kNone, 0x2010, 36, 0, ""},
    {"rotation_1", Table::kInput, 148, Type::kInt32, Field::kRotation1, 0.001, "deg", true,
     ValueSet::kNone, 0x2010, 37, 0,
     "A, W, rx or w; scale 1e-6 for rotation vector (rad) and quaternion"},
    {"rotation_2", Table::kInput, 150, Type::kInt32, Field::kRotation2, 0.001, "deg", true,
     ValueSet::kNone, 0x2010, 38, 0, "B, P, ry or x; scaled like rotation_1"},
    {"rotation_3", Table::kInput, 152, Type::kInt32, Field::kRotation3, 0.001, "deg", true,
     ValueSet::kNone, 0x2010, 39, 0, "C, R, rz or y; scaled like rotation_1"},
    {"rotation_4", Table::kInput, 154, Type::kInt32, Field::kRotation4, 0.001, "deg", true,
     ValueSet::kNone, 0x2010, 40, 0, "a quaternion's z, else 0; scaled like rotation_1"},
    {"sigma_x", Table::kInput, 156, Type::kUint16, Field::kSigmaX, 0.0001, "mm", true,
     ValueSet::kNone, 0x2010, 41, 0, "standard deviation of the position"},
    {"sigma_y", Table::kInput, 157, Type::kUint16, Field::kSigmaY, 0.0001, "mm", true,
     ValueSet::kNone, 0x2010, 42, 0, ""},
    {"sigma_z", Table::kInput, 158, Type::kUint16, Field::kSigmaZ, 0.0001, "mm", true,
     ValueSet::kNone, 0x2010, 43, 0, ""},
    {"sigma_turn_x", Table::kInput, 159, Type::kUint16, Field::kSigmaTurnX, 0.0001, "deg", true,
     ValueSet::kNone, 0x2010, 44, 0, "standard deviation of the turn about the part's axes"},
    {"sigma_turn_y", Table::kInput, 160, Type::kUint16, Field::kSigmaTurnY, 0.0001, "deg", true,
     ValueSet::kNone, 0x2010, 45, 0, ""},
    {"sigma_turn_z", Table::kInput, 161, Type::kUint16, Field::kSigmaTurnZ, 0.0001, "deg", true,
     ValueSet::kNone, 0x2010, 46, 0, "none about a free axis"},
    {"position_x_f", Table::kInput, 162, Type::kFloat32, Field::kPositionX, 1, "mm", true,
     ValueSet::kNone, 0x2010, 47, 0, ""},
    {"position_y_f", Table::kInput, 164, Type::kFloat32, Field::kPositionY, 1, "mm", true,
     ValueSet::kNone, 0x2010, 48, 0, ""},
    {"position_z_f", Table::kInput, 166, Type::kFloat32, Field::kPositionZ, 1, "mm", true,
     ValueSet::kNone, 0x2010, 49, 0, ""},
    {"rotation_1_f", Table::kInput, 168, Type::kFloat32, Field::kRotation1, 1, "deg", true,
     ValueSet::kNone, 0x2010, 50, 0, "rad for a rotation vector, 1 for a quaternion"},
    {"rotation_2_f", Table::kInput, 170, Type::kFloat32, Field::kRotation2, 1, "deg", true,
     ValueSet::kNone, 0x2010, 51, 0, ""},
    {"rotation_3_f", Table::kInput, 172, Type::kFloat32, Field::kRotation3, 1, "deg", true,
     ValueSet::kNone, 0x2010, 52, 0, ""},
    {"rotation_4_f", Table::kInput, 174, Type::kFloat32, Field::kRotation4, 1, "deg", true,
     ValueSet::kNone, 0x2010, 53, 0, ""},
    {"score_f", Table::kInput, 176, Type::kFloat32, Field::kScore, 1, "", true, ValueSet::kNone,
     0x2010, 54, 0, ""},
    {"visible_f", Table::kInput, 178, Type::kFloat32, Field::kVisible, 1, "", true, ValueSet::kNone,
     0x2010, 55, 0, ""},
    {"sigma_x_f", Table::kInput, 180, Type::kFloat32, Field::kSigmaX, 1, "mm", true,
     ValueSet::kNone, 0x2010, 56, 0, ""},
    {"sigma_y_f", Table::kInput, 182, Type::kFloat32, Field::kSigmaY, 1, "mm", true,
     ValueSet::kNone, 0x2010, 57, 0, ""},
    {"sigma_z_f", Table::kInput, 184, Type::kFloat32, Field::kSigmaZ, 1, "mm", true,
     ValueSet::kNone, 0x2010, 58, 0, ""},
    {"sigma_turn_x_f", Table::kInput, 186, Type::kFloat32, Field::kSigmaTurnX, 1, "deg", true,
     ValueSet::kNone, 0x2010, 59, 0, ""},
    {"sigma_turn_y_f", Table::kInput, 188, Type::kFloat32, Field::kSigmaTurnY, 1, "deg", true,
     ValueSet::kNone, 0x2010, 60, 0, ""},
    {"sigma_turn_z_f", Table::kInput, 190, Type::kFloat32, Field::kSigmaTurnZ, 1, "deg", true,
     ValueSet::kNone, 0x2010, 61, 0, ""},
    {"done_number_tail", Table::kInput, 192, Type::kUint16, Field::kDoneNumber, 1, "", false,
     ValueSet::kNone, 0x2010, 62, 0,
     "the same as done_number; if not, the block was read in pieces that do not fit"},
    {"tool", Table::kInput, 193, Type::kUint16, Field::kTool, 1, "", true, ValueSet::kNone, 0x2010,
     63, 0, "which tool the pose is for; 0: the pose is the part's own, no pick"},
    {"pick", Table::kInput, 194, Type::kUint16, Field::kPick, 1, "", true, ValueSet::kNone, 0x2010,
     64, 0, "which of the part's picks, from 1; 0: none of them"},
    {"done_number_end", Table::kInput, 195, Type::kUint16, Field::kDoneNumber, 1, "", false,
     ValueSet::kNone, 0x2010, 65, 0, "once more, where the block ends since map version 2"},
};

// A further match; the address counts from the start of its block.
constexpr Entry kFurther[] = {
    {"number", Table::kInput, 0, Type::kUint16, Field::kMatchNumber, 1, "", false, ValueSet::kNone,
     0x2020, 1, 1, "the command that this match is of; 0: no match here"},
    {"match_index", Table::kInput, 1, Type::kUint16, Field::kMatchIndex, 1, "", false,
     ValueSet::kNone, 0x2020, 2, 1, "which of the matches, from 1; 0: none"},
    {"part", Table::kInput, 2, Type::kUint16, Field::kPart, 1, "", true, ValueSet::kNone, 0x2020, 3,
     1, "which of the job's parts, from 1"},
    {"score", Table::kInput, 3, Type::kInt16, Field::kScore, 0.0001, "", true, ValueSet::kNone,
     0x2020, 4, 1, ""},
    {"position_x", Table::kInput, 4, Type::kInt32, Field::kPositionX, 0.001, "mm", true,
     ValueSet::kNone, 0x2020, 5, 1, ""},
    {"position_y", Table::kInput, 6, Type::kInt32, Field::kPositionY, 0.001, "mm", true,
     ValueSet::kNone, 0x2020, 6, 1, ""},
    {"position_z", Table::kInput, 8, Type::kInt32, Field::kPositionZ, 0.001, "mm", true,
     ValueSet::kNone, 0x2020, 7, 1, ""},
    {"rotation_1", Table::kInput, 10, Type::kInt32, Field::kRotation1, 0.001, "deg", true,
     ValueSet::kNone, 0x2020, 8, 1, "scaled like the first match's"},
    {"rotation_2", Table::kInput, 12, Type::kInt32, Field::kRotation2, 0.001, "deg", true,
     ValueSet::kNone, 0x2020, 9, 1, ""},
    {"rotation_3", Table::kInput, 14, Type::kInt32, Field::kRotation3, 0.001, "deg", true,
     ValueSet::kNone, 0x2020, 10, 1, ""},
    {"rotation_4", Table::kInput, 16, Type::kInt32, Field::kRotation4, 0.001, "deg", true,
     ValueSet::kNone, 0x2020, 11, 1, ""},
    {"visible", Table::kInput, 18, Type::kInt16, Field::kVisible, 0.0001, "", true, ValueSet::kNone,
     0x2020, 12, 1, ""},
    {"number_tail", Table::kInput, 19, Type::kUint16, Field::kMatchNumber, 1, "", false,
     ValueSet::kNone, 0x2020, 13, 1, "the same as number"},
};

// How a further match is to be picked; the blocks of these came later and follow all others.
constexpr Entry kFurtherPick[] = {
    {"tool_number", Table::kInput, 0, Type::kUint16, Field::kMatchNumber, 1, "", false,
     ValueSet::kNone, 0x2020, 14, 1, "the command that these are of; 0: no match here"},
    {"tool", Table::kInput, 1, Type::kUint16, Field::kTool, 1, "", true, ValueSet::kNone, 0x2020,
     15, 1, "which tool the pose is for; 0: no pick"},
    {"pick", Table::kInput, 2, Type::kUint16, Field::kPick, 1, "", true, ValueSet::kNone, 0x2020,
     16, 1, "which of the part's picks, from 1; 0: none of them"},
};

constexpr std::size_t kSingleCount = std::size(kSingle);
constexpr std::size_t kEntryCount =
    kSingleCount + kFurtherBlocks * (std::size(kFurther) + std::size(kFurtherPick));

// The entries once for each further match, each block `words` after the one before.
template <std::size_t kCount>
constexpr std::size_t add_blocks(const Entry (&entries)[kCount], int address, int words,
                                 std::array<Entry, kEntryCount>& table, std::size_t at) {
  for (int block = 0; block < kFurtherBlocks; ++block) {
    for (Entry entry : entries) {
      entry.address = static_cast<std::uint16_t>(address + block * words + entry.address);
      entry.can_index = static_cast<std::uint16_t>(entry.can_index + block);
      entry.block = static_cast<std::uint8_t>(block + 1);
      table[at++] = entry;
    }
  }
  return at;
}

constexpr std::array<Entry, kEntryCount> whole_table() {
  std::array<Entry, kEntryCount> table{};
  for (std::size_t i = 0; i < kSingleCount; ++i) table[i] = kSingle[i];
  const std::size_t at = add_blocks(kFurther, kFurtherAddress, kFurtherWords, table, kSingleCount);
  (void)add_blocks(kFurtherPick, kFurtherPickAddress, kFurtherPickWords, table, at);
  return table;
}
constexpr auto kTable = whole_table();

constexpr bool is_in_order() {
  int end = 0;
  for (const Entry& entry : kTable) {
    if (entry.address < end) return false;
    end = entry.address + entry.words();
  }
  return end <= kRegisterCount;
}
static_assert(is_in_order());

constexpr bool writable_are_words() {
  for (const Entry& entry : kTable) {
    if (entry.table == Table::kHolding && entry.type != Type::kUint16) return false;
  }
  return true;
}
static_assert(writable_are_words(), "a 32-bit value could be written by halves");
static_assert(kResultWords <= 125 && kFurtherWords <= 125, "more than a read may ask for");

constexpr std::uint8_t kNoEntry = 0xff;
static_assert(kEntryCount < kNoEntry);

constexpr std::array<std::uint8_t, kRegisterCount> index_of_registers() {
  std::array<std::uint8_t, kRegisterCount> index{};
  for (std::uint8_t& slot : index) slot = kNoEntry;
  for (std::size_t i = 0; i < kEntryCount; ++i) {
    for (int word = 0; word < kTable[i].words(); ++word) {
      index[static_cast<std::size_t>(kTable[i].address + word)] = static_cast<std::uint8_t>(i);
    }
  }
  return index;
}
constexpr auto kIndex = index_of_registers();

}  // namespace

std::span<const Entry> entries() noexcept { return kTable; }

const Entry* entry_at(int address) noexcept {
  if (address < 0 || address >= kRegisterCount) return nullptr;
  const std::uint8_t index = kIndex[static_cast<std::size_t>(address)];
  return index == kNoEntry ? nullptr : &kTable[index];
}

const Entry* find(Field field) noexcept {
  for (const Entry& entry : kTable) {
    if (entry.field == field) return &entry;
  }
  return nullptr;
}

bool is_writable(int address) noexcept {
  const Entry* entry = entry_at(address);
  return entry != nullptr && entry->table == Table::kHolding;
}

}  // namespace flatpose::result_map
