// The node's frames as a DBC file.

#include <cmath>

#include "flatpose/can/dictionary.hpp"
#include "flatpose/can/fd_report.hpp"
#include "flatpose/can/report.hpp"
#include "flatpose/result_map/table.hpp"
#include "port/linux/tool/map_can.hpp"
#include "port/linux/tool/map_names.hpp"
#include "port/linux/tool/number_text.hpp"

namespace flatpose::tool {
namespace {

using can::ReportField;
using result_map::ValueSet;

constexpr const char* kTpdoNames[can::kTpdoCount] = {"FLATPOSE_STATUS", "FLATPOSE_POSE_1",
                                                     "FLATPOSE_POSE_2", "FLATPOSE_POSE_3"};

/// How tools are told which frames are FD: the 15th of these is.
constexpr const char* kFrameFormats =
    "BA_DEF_ BO_ \"VFrameFormat\" ENUM \"StandardCAN\",\"ExtendedCAN\",\"reserved\",\"J1939PG\","
    "\"reserved\",\"reserved\",\"reserved\",\"reserved\",\"reserved\",\"reserved\",\"reserved\","
    "\"reserved\",\"reserved\",\"reserved\",\"StandardCAN_FD\",\"ExtendedCAN_FD\";\n"
    "BA_DEF_DEF_ \"VFrameFormat\" \"StandardCAN\";\n";

/// What the file is made of: frames first, then what is said about them.
struct Dbc {
  std::string frames;
  std::string comments;
  std::string attributes;
  std::string values;
  unsigned id = 0;
  int bit = 0;
  const char* reader = "";

  void frame(unsigned new_id, const char* name, int bytes, const char* sender, const char* doc) {
    id = new_id;
    bit = 0;
    reader = std::string(sender) == "FLATPOSE" ? "MASTER" : "FLATPOSE";
    frames += formatted("\nBO_ %u %s: %d %s\n", id, name, bytes, sender);
    comments += formatted("CM_ BO_ %u \"%s\";\n", id, doc);
  }
  void signal(const std::string& name, int bits, bool is_signed, double scale, double least,
              double greatest, const char* unit, const std::string& doc, ValueSet set) {
    frames += formatted(" SG_ %s : %d|%d@1%c (%.15g,0) [%.15g|%.15g] \"%s\" %s\n", name.c_str(),
                        bit, bits, is_signed ? '-' : '+', scale, least, greatest, unit, reader);
    bit += bits;
    if (!doc.empty())
      comments += formatted("CM_ SG_ %u %s \"%s\";\n", id, name.c_str(), doc.c_str());
    if (set == ValueSet::kNone) return;
    values += formatted("VAL_ %u %s", id, name.c_str());
    for (const NamedValue& named : values_of(set))
      values += formatted(" %d \"%s\"", named.value, named.name.c_str());
    values += " ;\n";
  }
  void whole(const char* name, int bits, const char* doc, ValueSet set = ValueSet::kNone) {
    signal(name, bits, false, 1, 0, bits == 16 ? 65535 : 255, "", doc, set);
  }
};

void add_bits(Dbc& dbc) {
  for (const NamedValue& named : values_of(ValueSet::kBits))
    dbc.signal("bit_" + named.name, 1, false, 1, 0, 1, "", named.doc, ValueSet::kNone);
}

void add_head(ReportField field, const std::string& name, Dbc& dbc) {
  const can::ReportLine& line = can::line_of(field);
  if (field == ReportField::kBits) return add_bits(dbc);
  dbc.signal(name, 8 * line.bytes, line.is_signed, line.scale, line.least, line.greatest, line.unit,
             line.doc, line.values);
}

void add_tpdo(int tpdo, unsigned node, Dbc& dbc) {
  dbc.frame(can::kTpdoBase + can::kTpdoStep * static_cast<unsigned>(tpdo) + node, kTpdoNames[tpdo],
            8, "FLATPOSE",
            tpdo == 0 ? "Take a pose when this and the three pose frames have one sequence, and "
                        "done_number is yours"
                      : "Belongs to the status frame with the same sequence");
  for (const ReportField field : can::fields_of_tpdo(tpdo))
    add_head(
        field,
        field == ReportField::kSequence ? formatted("sequence_%d", tpdo) : can::line_of(field).name,
        dbc);
}

/// What stands for "there is none".
std::string none_of(const result_map::Entry& entry, int bytes) {
  if (!entry.may_be_none) return {};
  if (bytes == 1) return "255: none";
  if (entry.type == result_map::Type::kInt16) return "-32768: none";
  if (entry.type == result_map::Type::kUint16) return "65535: none";
  return entry.type == result_map::Type::kInt32 ? "-2147483648: none" : "4294967295: none";
}

// A register in as many bytes as it has there.
void add_register(const can::FdLine& line, Dbc& dbc) {
  using result_map::Type;
  const result_map::Entry& entry = *result_map::find(line.field);
  const bool is_signed = entry.type == Type::kInt16 || entry.type == Type::kInt32;
  const int bits = 8 * line.bytes;
  const double most = std::ldexp(1.0, is_signed ? bits - 1 : bits) - 1;
  const double spared = !is_signed && (entry.may_be_none || bits == 8) ? 1 : 0;
  std::string doc = entry.doc;
  if (const std::string none = none_of(entry, line.bytes); !none.empty())
    doc += (doc.empty() ? "" : "; ") + none;
  dbc.signal(entry.name, bits, is_signed, entry.scale, is_signed ? -most * entry.scale : 0,
             (most - spared) * entry.scale, entry.unit, doc, entry.values);
}

void add_fd(unsigned id, Dbc& dbc) {
  dbc.frame(id, "FLATPOSE_RESULT", int{can::kFdBytesMax}, "FLATPOSE",
            "The whole result in one CAN FD frame: off unless fd_frame = true, or by 2006h:1");
  for (const ReportField field : can::fields_of_tpdo(0))
    add_head(field, can::line_of(field).name, dbc);
  for (const can::FdLine& line : can::fd_lines()) add_register(line, dbc);
  dbc.attributes += formatted("BA_ \"VFrameFormat\" BO_ %u 14;\n", id);
}

void add_others(unsigned node, Dbc& dbc) {
  dbc.frame(can::kNmtId, "NMT_COMMAND", 2, "MASTER",
            "1 0: start all nodes; PDOs work from then on");
  dbc.whole("nmt_command", 8,
            "1 start, 2 stop, 128 pre-operational, 129 reset, 130 reset communication");
  dbc.whole("nmt_node", 8, "0: all");
  dbc.frame(can::kEmergencyBase + node, "FLATPOSE_EMERGENCY", 8, "FLATPOSE",
            "Once when a fault begins, and with code 0 when it ends");
  dbc.whole("emergency_code", 16, "CiA 301; from FF00h up: FF00h less the status of the command");
  dbc.whole("error_register", 8, "bit 0 any, 4 communication, 7 a command's fault");
  dbc.whole("emergency_number", 16, "the command, if it is a command's fault");
  dbc.signal("emergency_status", 8, true, 1, -128, 127, "", "how that command ended",
             ValueSet::kAnswers);
  dbc.frame(can::kRpdoBase + node, "FLATPOSE_COMMAND", 8, "MASTER",
            "A command_number that is new starts the command; sent again it does nothing");
  dbc.whole("command_number", 16, "0 does nothing");
  dbc.whole("command_session", 16, "session_id of 2010h; 0 is not checked");
  dbc.whole("command", 8, "", ValueSet::kCommands);
  dbc.whole("pick_outcome", 8, "with report_pick", ValueSet::kPickOutcomes);
  dbc.whole("argument", 16, "the job; with report_pick the command whose pose was tried");
  dbc.frame(can::kHeartbeatBase + node, "FLATPOSE_HEARTBEAT", 1, "FLATPOSE",
            "Still there, and in which state");
  dbc.whole("nmt_state", 8, "0 boot-up, 4 stopped, 5 operational, 127 pre-operational");
}

}  // namespace

std::string map_dbc(int node, int fd_frame_id) {
  Dbc dbc;
  const auto id = static_cast<unsigned>(node);
  add_others(id, dbc);
  for (int tpdo = 0; tpdo < can::kTpdoCount; ++tpdo) add_tpdo(tpdo, id, dbc);
  add_fd(fd_frame_id != 0 ? static_cast<unsigned>(fd_frame_id) : can::kFdReportBase + id, dbc);
  return "VERSION \"\"\n\nNS_ :\n\nBS_:\n\nBU_: FLATPOSE MASTER\n" + dbc.frames + "\n" +
         formatted(
             "CM_ \"Made by flatpose map --format dbc, for node %d. Rotations: 0.001 degree; "
             "of a rotation vector 1e-6 rad.\";\n",
             node) +
         dbc.comments + "\n" + kFrameFormats + dbc.attributes + "\n" + dbc.values;
}

}  // namespace flatpose::tool
