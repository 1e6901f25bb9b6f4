#include "port/linux/tool/map_names.hpp"

#include "flatpose/geometry/robot_convention.hpp"
#include "flatpose/job/command.hpp"
#include "flatpose/job/status.hpp"
#include "port/linux/tool/map_text.hpp"

namespace flatpose::tool {
namespace {

using result_map::Type;
using result_map::ValueSet;

std::vector<NamedValue> from(std::span<const job::Named> names) {
  std::vector<NamedValue> values;
  for (const job::Named& named : names) values.push_back({named.value, named.name, named.doc});
  return values;
}

std::vector<NamedValue> answers() {
  std::vector<NamedValue> values;
  for (const job::AnswerText& text : job::answer_texts()) {
    values.push_back(
        {static_cast<int>(text.answer), text.name, std::string(text.cause) + "; " + text.remedy});
  }
  return values;
}

std::vector<NamedValue> conventions() {
  static constexpr const char* kDocs[kConventionCount] = {
      "A B C: R = Rz(A) Ry(B) Rx(C), degrees",
      "W P R: R = Rz(R) Ry(P) Rx(W), degrees; Yaskawa's Rx Ry Rz too",
      "rx ry rz: turn by the vector's length about it, rad",
      "q1 to q4: quaternion w x y z",
      "rx ry rz: R = Rx(rx) Ry(ry) Rz(rz), degrees",
      "z-y'-z'': R = Rz(a) Ry(b) Rz(c), degrees; singular at no tilt"};
  std::vector<NamedValue> values;
  for (int i = 0; i < kConventionCount; ++i)
    values.push_back({i, to_string(static_cast<Convention>(i)), kDocs[i]});
  return values;
}

}  // namespace

std::vector<NamedValue> values_of(ValueSet set) {
  switch (set) {
    case ValueSet::kNone: return {};
    case ValueSet::kCommands: return from(job::command_names());
    case ValueSet::kPickOutcomes: return from(job::pick_outcome_names());
    case ValueSet::kControlBits: return from(job::control_bit_names());
    case ValueSet::kBits: return from(job::bit_names());
    case ValueSet::kRefusals: return from(job::refusal_names());
    case ValueSet::kFrames: return from(job::frame_names());
    case ValueSet::kAnswers: return answers();
    case ValueSet::kConventions: return conventions();
  }
  return {};
}

std::string name_of(const result_map::Entry& entry) {
  return entry.block == 0 ? entry.name
                          : "further_" + std::to_string(entry.block) + "_" + entry.name;
}

const char* name_of(Type type) {
  switch (type) {
    case Type::kUint16: return "uint16";
    case Type::kInt16: return "int16";
    case Type::kUint32: return "uint32";
    case Type::kInt32: return "int32";
    case Type::kFloat32: return "float32";
  }
  return "unknown";
}

}  // namespace flatpose::tool
