// The document of the register map, for PLC programmers.

#include <bit>
#include <cmath>

#include "flatpose/result_map/table.hpp"
#include "flatpose/result_map/value.hpp"
#include "port/linux/tool/map_names.hpp"
#include "port/linux/tool/map_text.hpp"
#include "port/linux/tool/number_text.hpp"

namespace flatpose::tool {
namespace {

using result_map::Entry;
using result_map::Table;
using result_map::ValueSet;

constexpr const char* kIntroduction =
    R"(# Registers

Made by `flatpose map --format markdown` from the table that the server itself reads.

## From trigger to pose
1. On each new connection write `command_number` = 0, then read the result block: one read of )";

constexpr const char* kSteps =
    R"(Keep `session_id` and `last_number`.
2. Write `command_number` to `job` in one request (function 16): a number that is neither 0 nor `last_number`, the
   session, the command, the job. Before the response leaves, the number is accepted or refused, and the last result is gone.
3. Read the result block until `done_number` is your number, at head and tail, and `result_is_readers` is 1. If
   `refused_number` is your number, `refused_status` says why. `answer_by_ms` is for your watchdog.
4. `status` >= 0 and the bit `valid`: there is a pose. Anything else: there is none, and its registers say so.

Your last number is executed once, however often it is written: write it again when you cannot know whether it arrived. A
refused number is used up, and takes the last result away too. Count upwards, from 65535 to 1: only the last is
remembered, and one before it is a new command. A write answered by exception 6 was not applied at all: another master holds the lease, or a newer
connection of yours has written since this one was last heard (send it again). The lease ends 5 s after the owner's last
request, of any kind, on whatever connection; a command that runs then ends as `cancelled`.

## How numbers are written
Value = raw x scale. 32-bit values take two registers; by default the order of bytes is ABCD (high word first), and
`word_order` in the config gives CDAB, BADC or DCBA. The test registers tell which one your PLC has. There is no pose:
int32 0x80000000, float32 NaN (both can be set in the config), int16 -32768, uint16 65535, uint32 0xFFFFFFFF. Results are
read by functions 3 and 4 alike; every address below is that of the PDU, then as 4xxxxx for function 3 and as 3xxxxx for
function 4. The bits are discrete inputs too, and with handshake = "bits" the control bits are coils, both from 0.
Function 17 and 43/14 say who answers.

On CAN the same is read and written as `object`, index:subindex, both hexadecimal; low byte first, whatever `word_order`.

)";

void add_row(const Entry& entry, std::string& text) {
  const std::string scale = entry.scale == 1.0 ? "" : formatted("%g", entry.scale);
  const std::string unit = entry.unit;
  const std::string measure = scale.empty() || unit.empty() ? scale + unit : scale + " " + unit;
  text +=
      formatted("| %d | %d | %d | %04X:%02X | `%s` | %s | %s | %s |\n", entry.address,
                400001 + entry.address, 300001 + entry.address, entry.can_index, entry.can_subindex,
                entry.name, name_of(entry.type), measure.c_str(), entry.doc);
}

void add_head(const char* title, std::string& text) {
  text += formatted(
      "## %s\n| PDU | 4x | 3x | object | name | type | scale | "
      "|\n|---|---|---|---|---|---|---|---|\n",
      title);
}

template <class Belongs>
void add_registers(const char* title, const Belongs& belongs, std::string& text) {
  add_head(title, text);
  for (const Entry& entry : result_map::entries())
    if (belongs(entry)) add_row(entry, text);
  text += "\n";
}

void add_values(const char* title, ValueSet set, std::string& text) {
  text +=
      formatted("## %s\n| %s | name | |\n|---|---|---|\n", title, is_bits(set) ? "bit" : "value");
  for (const NamedValue& named : values_of(set))
    text += formatted("| %d | `%s` | %s |\n", named.value, named.name.c_str(), named.doc.c_str());
  text += "\n";
}

// What of all that is said above holds for this config.
void add_config(const ServedMap& served, std::string& text) {
  const auto& format = served.format;
  const auto none = std::bit_cast<float>(format.none_float32);
  text += formatted(
      "## As configured\nWord order %s. There is no pose: int32 %d, float32 %s. Trigger: "
      "handshake = \"%s\".\n\n| job | parts; frame, convention | int32 of rotations |\n"
      "|---|---|---|\n",
      name_of(format.order), static_cast<std::int32_t>(format.none_int32),
      std::isnan(none) ? "NaN" : formatted("%g", static_cast<double>(none)).c_str(),
      served.handshake == job::Handshake::kBits ? "bits" : "number");
  for (const ServedJob& job : served.jobs)
    text += formatted("| %d | %s | x %g |\n", job.number, text_of(job).c_str(),
                      result_map::rotation_scale(job.convention));
  text += "\n";
}

}  // namespace

std::string map_markdown(const ServedMap& served) {
  std::string text = kIntroduction;
  text +=
      formatted("%d registers\n   from %d. ", result_map::kResultWords, result_map::kResultAddress);
  text += kSteps;
  if (!served.config_path.empty()) add_config(served, text);
  add_registers(
      "Commands, written", [](const Entry& e) { return e.table == Table::kHolding; }, text);
  add_registers(
      "Test registers",
      [](const Entry& e) {
        return e.table == Table::kInput && e.address < result_map::kResultAddress;
      },
      text);
  add_registers(
      "Result block, read whole",
      [](const Entry& e) { return e.block == 0 && e.address >= result_map::kResultAddress; }, text);
  add_registers(
      "Further matches: the first of eight blocks", [](const Entry& e) { return e.block == 1; },
      text);
  text += formatted(
      "Blocks from %d follow every %d registers; one is whole when number and tail are yours. "
      "Those "
      "from %d (%d registers\neach) say how the same matches are to be picked. On CAN the blocks "
      "are "
      "2020 to 2027, with both.\n\n",
      result_map::kFurtherAddress, result_map::kFurtherWords, result_map::kFurtherPickAddress,
      result_map::kFurtherPickWords);
  add_values("`status`: cause; remedy", ValueSet::kAnswers, text);
  add_values("`command`", ValueSet::kCommands, text);
  add_values("`refused_status`", ValueSet::kRefusals, text);
  add_values("`bits`", ValueSet::kBits, text);
  add_values("`control`", ValueSet::kControlBits, text);
  add_values("`pick_outcome`", ValueSet::kPickOutcomes, text);
  add_values("`frame`", ValueSet::kFrames, text);
  add_values("`convention`", ValueSet::kConventions, text);
  return text +
         "## Function blocks\n`docs/plc/FB_Flatpose.st` (CODESYS) and `docs/plc/FB_Flatpose.scl` "
         "(Siemens) do steps 1 to 4. No compiler\nfor Structured Text is packaged for Debian: they "
         "are made from this table, and no compiler has read them here.\n";
}

}  // namespace flatpose::tool
