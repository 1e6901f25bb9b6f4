// FB_Flatpose in Structured Text. One text; '$' before a local name is '#' for Siemens and nothing
// for CODESYS, and the declarations differ. Reading and writing registers is the PLC's own Modbus
// master: the block gets what was read and gives what is to be written, both cyclically if you
// like, for a number written again does nothing.

#include <string>

#include "flatpose/result_map/table.hpp"
#include "port/linux/files/input_error.hpp"
#include "port/linux/tool/map_text.hpp"
#include "port/linux/tool/number_text.hpp"

namespace flatpose::tool {
namespace {

int place_of(const std::string& name) {
  for (const result_map::Entry& entry : result_map::entries()) {
    if (entry.block == 0 && entry.name == name) return entry.address - result_map::kResultAddress;
  }
  return -1;
}

std::string word(const char* name) {
  return formatted("WORD_TO_UINT($awBlock[%d])", place_of(name));
}

std::string pair_of(const char* name, PlcDialect dialect) {
  const int place = place_of(name);
  const char* shift = dialect == PlcDialect::kScl ? "SHL(IN := %s, N := 16)" : "SHL(%s, 16)";
  const std::string high = formatted("WORD_TO_DWORD($awBlock[%d + $iHigh])", place);
  const std::string low = formatted("WORD_TO_DWORD($awBlock[%d - $iHigh])", place + 1);
  const std::string text = shift;
  const std::size_t at = text.find("%s");
  return "DWORD_TO_DINT(" + text.substr(0, at) + high + text.substr(at + 2) + " OR " + low + ")";
}

std::string declarations(PlcDialect dialect, bool is_low_word_first) {
  const bool is_scl = dialect == PlcDialect::kScl;
  const char* timer =
      is_scl ? "tonWatch {InstructionName := 'TON_TIME'; LibVersion := '1.0'} : TON_TIME;"
             : "tonWatch : TON;";
  return std::string(R"(VAR_INPUT
    xExecute : BOOL;             // a rising edge starts the command
    uiCommand : UINT := 1;       // 1 locate, 2 next, 3 capture, ...
    uiJob : UINT := 1;
    tPatience : TIME := T#15s;   // more than answer_by_ms
    xLinkOk : BOOL;              // your Modbus master reads without error
    xLowWordFirst : BOOL)") +
         (is_low_word_first ? " := TRUE;" : ";       ") + R"( // word_order = "CDAB"
)" +
         formatted("    awBlock : ARRAY[0..%d] OF WORD; // read: %d registers from %d\n",
                   result_map::kResultWords - 1, result_map::kResultWords,
                   result_map::kResultAddress) +
         R"(END_VAR
VAR_OUTPUT
    awCommand : ARRAY[0..3] OF WORD; // write with function 16: 4 registers from 0
    xReady : BOOL;
    xBusy : BOOL;
    xDone : BOOL;                // an answer: iStatus says which
    xValid : BOOL;               // a pose
    xError : BOOL;               // refused, restarted or silent: trigger again
    iStatus : INT;
    uiRefused : UINT;            // why, when refused
    uiMatchesLeft : UINT;
    uiTool : UINT;               // which tool the pose is for; 0: the part's own pose
    uiPick : UINT;
    lrX : LREAL;                 // mm
    lrY : LREAL;
    lrZ : LREAL;
    lrR1 : LREAL;                // degrees; rad or 1 by convention
    lrR2 : LREAL;
    lrR3 : LREAL;
    lrR4 : LREAL;
END_VAR
VAR
    iState : INT;                // 0 claim, 1 idle, 2 waiting
    iHigh : INT;
    xExecuteBefore : BOOL;
    uiNumber : UINT;
    uiSession : UINT;
    lrScale : LREAL;
    )" + timer +
         "\nEND_VAR\n";
}

std::string claim_and_idle() {
  return R"($tonWatch(IN := $iState = 2, PT := $tPatience);
IF NOT $xLinkOk AND $iState < 2 THEN
    $iState := 0;
END_IF;
IF $xLowWordFirst THEN
    $iHigh := 1;
ELSE
    $iHigh := 0;
END_IF;

IF $iState = 0 THEN // nothing of an older connection comes after this write
    $awCommand[0] := UINT_TO_WORD(0);
    $awCommand[1] := UINT_TO_WORD(0);
    IF $xLinkOk AND )" +
         word("session_id") + " <> 0 AND " + word("map_version") +
         formatted(" = %d", result_map::kMapVersion) + R"( THEN
        $uiSession := )" +
         word("session_id") + R"(;
        $iState := 1;
    END_IF;
ELSIF $iState = 1 AND $xExecute AND NOT $xExecuteBefore THEN
    $uiNumber := )" +
         word("last_number") + R"(;
    IF $uiNumber >= 65535 THEN
        $uiNumber := 1;
    ELSE
        $uiNumber := $uiNumber + 1;
    END_IF;
    $uiSession := )" +
         word("session_id") + R"(;
    $awCommand[0] := UINT_TO_WORD($uiNumber);
    $awCommand[1] := UINT_TO_WORD($uiSession);
    $awCommand[2] := UINT_TO_WORD($uiCommand);
    $awCommand[3] := UINT_TO_WORD($uiJob);
    $xDone := FALSE;
    $xValid := FALSE;
    $xError := FALSE;
    $uiRefused := 0;
    $iState := 2;
)";
}

std::string waiting() {
  return "ELSIF $iState = 2 THEN\n    IF $tonWatch.Q OR ($xLinkOk AND " + word("session_id") +
         R"( <> $uiSession) THEN
        $xError := TRUE; // silent, or started again: the number is lost
        $iState := 0;
    ELSIF $xLinkOk AND )" +
         word("refused_number") + " = $uiNumber AND " + word("reader_is_owner") + R"( = 1 THEN
        $uiRefused := )" +
         word("refused_status") + R"(;
        $xError := TRUE;
        $iState := 1;
    ELSIF $xLinkOk AND )" +
         word("done_number") + " = $uiNumber AND " + word("done_number_end") + " = $uiNumber AND " +
         word("result_is_readers") + R"( = 1 THEN
        $iStatus := WORD_TO_INT($awBlock[)" +
         std::to_string(place_of("status")) + R"(]);
        $xDone := TRUE;
        $xValid := $iStatus >= 0 AND ($awBlock[)" +
         std::to_string(place_of("bits")) + R"(] AND WORD#16#10) <> WORD#16#0;
        $uiMatchesLeft := )" +
         word("matches_left") + ";\n        $iState := 1;\n    END_IF;\nEND_IF;\n";
}

std::string pose(PlcDialect dialect) {
  std::string text = "IF $xDone AND $xValid AND NOT $xBusy THEN\n    $lrScale := 0.001;\n    IF " +
                     word("convention") + " = 2 OR " + word("convention") +
                     " = 3 THEN\n        $lrScale := 0.000001;\n    END_IF;\n";
  struct Target {
    const char* local;
    const char* name;
    const char* scale;
  };
  for (const Target& target :
       {Target{"lrX", "position_x", "0.001"}, Target{"lrY", "position_y", "0.001"},
        Target{"lrZ", "position_z", "0.001"}, Target{"lrR1", "rotation_1", "$lrScale"},
        Target{"lrR2", "rotation_2", "$lrScale"}, Target{"lrR3", "rotation_3", "$lrScale"},
        Target{"lrR4", "rotation_4", "$lrScale"}}) {
    text += formatted("    $%s := DINT_TO_LREAL(%s) * %s;\n", target.local,
                      pair_of(target.name, dialect).c_str(), target.scale);
  }
  return text + "    $uiTool := " + word("tool") + ";\n    $uiPick := " + word("pick") +
         ";\nEND_IF;\n";
}

// The pose is taken in the cycle in which the answer is, never from a later block.
std::string body(PlcDialect dialect) {
  std::string text = claim_and_idle() + waiting();
  text += "IF $xBusy AND $iState <> 2 THEN // ended in this cycle\n    $xBusy := FALSE;\n";
  const std::string inner = pose(dialect);
  for (std::size_t at = 0; at < inner.size();) {
    const std::size_t end = inner.find('\n', at) + 1;
    text += "    " + inner.substr(at, end - at);
    at = end;
  }
  return text +
         "END_IF;\n$xBusy := $iState = 2;\n$xReady := $iState = 1 AND $xLinkOk;\n"
         "$xExecuteBefore := $xExecute;\n";
}

std::string with_locals(const std::string& text, PlcDialect dialect) {
  std::string out;
  for (const char c : text) {
    if (c != '$') {
      out += c;
    } else if (dialect == PlcDialect::kScl) {
      out += '#';
    }
  }
  return out;
}

}  // namespace

std::string map_function_block(PlcDialect dialect, const ServedMap& served) {
  using result_map::WordOrder;
  const WordOrder order = served.format.order;
  if (order != WordOrder::kAbcd && order != WordOrder::kCdab)
    throw port::InputError(
        served.config_path,
        std::string("the function block cannot read word_order = \"") + name_of(order) + "\"",
        "take \"ABCD\" or \"CDAB\"");
  const bool is_scl = dialect == PlcDialect::kScl;
  const std::string head = formatted(
      "// Made by `flatpose map --format %s` for map version %d. No compiler has read it "
      "there.\n",
      is_scl ? "scl" : "st", result_map::kMapVersion);
  const std::string name = is_scl ? "FUNCTION_BLOCK \"FB_Flatpose\"\n{ S7_Optimized_Access := "
                                    "'TRUE' }\nVERSION : 0.1\n"
                                  : "FUNCTION_BLOCK FB_Flatpose\n";
  const std::string begin = is_scl ? "\nBEGIN\n" : "\n";
  return head + name + declarations(dialect, order == WordOrder::kCdab) + begin +
         with_locals(body(dialect), dialect) + "END_FUNCTION_BLOCK\n";
}

}  // namespace flatpose::tool
