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
  RotationMeasure rotation;

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

bool is_rotation(ReportField field) {
  return field == ReportField::kRotation1 || field == ReportField::kRotation2 ||
         field == ReportField::kRotation3;
}

void add_rotation(const can::ReportLine& line, Dbc& dbc) {
  const auto [scale, unit] = dbc.rotation;
  dbc.signal(line.name, 8 * line.bytes, true, scale, line.least / line.scale * scale,
             line.greatest / line.scale * scale, unit, line.doc, line.values);
}

void add_head(ReportField field, const std::string& name, Dbc& dbc) {
  const can::ReportLine& line = can::line_of(field);
  if (field == ReportField::kBits) return add_bits(dbc);
  if (is_rotation(field)) return add_rotation(line, dbc);
  dbc.signal(name, 8 * line.bytes, line.is_signed, line.scale, line.least, line.greatest, line.unit,
             line.doc, line.values);
}

void add_tpdo(int tpdo, unsigned node, Dbc& dbc) {
  dbc.frame(can::kTpdoBase + can::kTpdoStep * static_cast<unsigned>(tpdo) + node, kTpdoNames[tpdo],
            8, "FLATPOSE",
            tpdo == 0 ? "Wait until done_number is yours; only if bit_valid is set then, until the "
                        "three pose frames show this sequence"
                      : "When a pose comes or is taken back; of the status frame with the same "
                        "sequence");
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

// What is another thing in this frame than in the registers.
std::string fd_doc_of(const result_map::Entry& entry) {
  switch (entry.field) {
    case result_map::Field::kAge: return "since the end of acquisition, when the frame was sent";
    case result_map::Field::kConvention:
    case result_map::Field::kFrame:
      return std::string(entry.doc) + "; 255: the result is another's";
    default: return entry.doc;
  }
}

// A register in as many bytes as it has there.
void add_register(const can::FdLine& line, Dbc& dbc) {
  using result_map::Type;
  const result_map::Entry& entry = *result_map::find(line.field);
  const bool is_signed = entry.type == Type::kInt16 || entry.type == Type::kInt32;
  const int bits = 8 * line.bytes;
  const double most = std::ldexp(1.0, is_signed ? bits - 1 : bits) - 1;
  const double spared = !is_signed && (entry.may_be_none || bits == 8) ? 1 : 0;
  const double scale = result_map::is_rotation(line.field) ? dbc.rotation.scale : entry.scale;
  const char* unit = result_map::is_rotation(line.field) ? dbc.rotation.unit : entry.unit;
  std::string doc = fd_doc_of(entry);
  if (const std::string none = none_of(entry, line.bytes); !none.empty())
    doc += (doc.empty() ? "" : "; ") + none;
  dbc.signal(entry.name, bits, is_signed, scale, is_signed ? -most * scale : 0,
             (most - spared) * scale, unit, doc, entry.values);
}

void add_fd(unsigned id, Dbc& dbc) {
  dbc.frame(id, "FLATPOSE_RESULT", int{can::kFdBytesMax}, "FLATPOSE",
            "The whole result in one CAN FD frame: off unless fd_frame = true, or by 2006h:1");
  dbc.whole("sequence", 8, "another with each result; here it need not be compared");
  for (const ReportField field : can::fields_of_tpdo(0).subspan(1))
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
            "A command_number that is not your last one starts the command; sent again it only "
            "shows that you live");
  dbc.whole("command_number", 16, "0 starts nothing; count upwards");
  dbc.whole("command_session", 16, "session_id, 2010h:0Bh; 0 is not checked");
  dbc.whole("command", 8, "", ValueSet::kCommands);
  dbc.whole("pick_outcome", 8, "with report_pick", ValueSet::kPickOutcomes);
  dbc.whole("argument", 16, "the job; with report_pick the command whose pose was tried");
  dbc.frame(can::kHeartbeatBase + node, "FLATPOSE_HEARTBEAT", 1, "FLATPOSE",
            "Still there, and in which state");
  dbc.whole("nmt_state", 8, "0 boot-up, 4 stopped, 5 operational, 127 pre-operational");
}

std::string rotations_of(const ServedMap& served) {
  if (const auto shared = rotation_measure_of(served))
    return formatted("%g %s, as all jobs of the config have them", shared->scale,
                     *shared->unit == 0 ? "(quaternion)" : shared->unit);
  const char* differ = served.jobs.empty() ? "" : "the jobs of the config differ: ";
  return std::string(differ) + "0.001 degree; of a rotation vector 1e-6 rad, of a quaternion 1e-6";
}

}  // namespace

std::string map_dbc(const ServedMap& served) {
  Dbc dbc;
  dbc.rotation = rotation_measure_of(served).value_or(RotationMeasure{});
  const auto id = static_cast<unsigned>(served.node);
  add_others(id, dbc);
  for (int tpdo = 0; tpdo < can::kTpdoCount; ++tpdo) add_tpdo(tpdo, id, dbc);
  add_fd(
      served.fd_frame_id != 0 ? static_cast<unsigned>(served.fd_frame_id) : can::kFdReportBase + id,
      dbc);
  return "VERSION \"\"\n\nNS_ :\n\nBS_:\n\nBU_: FLATPOSE MASTER\n" + dbc.frames + "\n" +
         formatted("CM_ \"Made by flatpose map --format dbc, for node %d. Rotations: %s.\";\n",
                   served.node, rotations_of(served).c_str()) +
         dbc.comments + "\n" + kFrameFormats + dbc.attributes + "\n" + dbc.values;
}

}  // namespace flatpose::tool
