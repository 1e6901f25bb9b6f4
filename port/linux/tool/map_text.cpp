#include "port/linux/tool/map_text.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>

#include "flatpose/result_map/table.hpp"
#include "flatpose/result_map/value.hpp"
#include "port/linux/tool/map_names.hpp"
#include "port/linux/tool/number_text.hpp"

namespace flatpose::tool {
namespace {

using result_map::Entry;
using result_map::Table;
using result_map::Type;
using Json = nlohmann::ordered_json;

const char* table_of(const Entry& entry) {
  return entry.table == Table::kHolding ? "holding" : "input";
}

bool has_scale_by_convention(const Entry& entry) {
  return result_map::is_rotation(entry.field) && entry.type == Type::kInt32;
}

// The jobs that there are, beside the numbers that have names in any case.
std::vector<NamedValue> named_values(const Entry& entry, const ServedMap& served) {
  if (entry.field != result_map::Field::kJob) return values_of(entry.values);
  std::vector<NamedValue> jobs;
  for (const ServedJob& job : served.jobs) jobs.push_back({job.number, text_of(job), ""});
  return jobs;
}

double scale_of(const Entry& entry, const ServedMap& served) {
  const auto shared = rotation_measure_of(served);
  return shared && has_scale_by_convention(entry) ? shared->scale : entry.scale;
}

const char* unit_of(const Entry& entry, const ServedMap& served) {
  const auto shared = rotation_measure_of(served);
  return shared && result_map::is_rotation(entry.field) ? shared->unit : entry.unit;
}

// How the config has 32-bit values written.
void add_format(const Entry& entry, const result_map::WireFormat& format, Json& json) {
  if (entry.words() != 2) return;
  json["word_order"] = name_of(format.order);
  if (!entry.may_be_none || entry.type == Type::kUint32) return;
  if (entry.type == Type::kInt32) {
    json["none"] = static_cast<std::int32_t>(format.none_int32);
    return;
  }
  const auto none = std::bit_cast<float>(format.none_float32);
  json["none"] = std::isnan(none) ? Json("NaN") : Json(none);
}

Json json_of(const Entry& entry, const ServedMap& served) {
  Json json;
  json["name"] = name_of(entry);
  json["table"] = table_of(entry);
  json["address"] = entry.address;
  json["words"] = entry.words();
  json["type"] = name_of(entry.type);
  json["scale"] = scale_of(entry, served);
  json["unit"] = unit_of(entry, served);
  json["values"] = nullptr;
  for (const NamedValue& named : named_values(entry, served))
    json["values"][std::to_string(named.value)] = named.name;
  if (is_bits(entry.values)) json["values_are_bits"] = true;
  if (has_scale_by_convention(entry)) {
    for (int i = 0; i < kConventionCount; ++i) {
      const auto convention = static_cast<Convention>(i);
      json["scale_by_convention"][to_string(convention)] = result_map::rotation_scale(convention);
    }
  }
  if (!served.config_path.empty()) add_format(entry, served.format, json);
  json["can"] = {{"index", entry.can_index}, {"subindex", entry.can_subindex}};
  json["doc"] = entry.doc;
  return json;
}

std::string csv_field(const std::string& text) {
  std::string doubled = "\"";
  for (const char c : text) doubled += c == '"' ? std::string("\"\"") : std::string(1, c);
  return doubled + "\"";
}

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

void add_enumeration(const char* prefix, result_map::ValueSet set, std::string& text) {
  const auto values = values_of(set);
  text += "\nenum {\n";
  for (const NamedValue& named : values) {
    const int value = is_bits(set) ? 1 << named.value : named.value;
    text += formatted("  FLATPOSE_%s_%s = %d,\n", prefix, upper(named.name).c_str(), value);
  }
  text += "};\n";
}

}  // namespace

std::string map_json(const ServedMap& served) {
  Json list = Json::array();
  for (const Entry& entry : result_map::entries()) list.push_back(json_of(entry, served));
  return list.dump(1) + "\n";
}

std::string map_csv(const ServedMap& served) {
  std::string text = "name,table,address,words,type,scale,unit,values,can_index,can_subindex,doc\n";
  for (const Entry& entry : result_map::entries()) {
    std::string values;
    for (const NamedValue& named : named_values(entry, served))
      values += (values.empty() ? "" : " ") + std::to_string(named.value) + "=" + named.name;
    text += formatted("%s,%s,%d,%d,%s,%g,%s,%s,0x%04X,0x%02X,%s\n", name_of(entry).c_str(),
                      table_of(entry), entry.address, entry.words(), name_of(entry.type),
                      scale_of(entry, served), unit_of(entry, served), csv_field(values).c_str(),
                      entry.can_index, entry.can_subindex, csv_field(entry.doc).c_str());
  }
  return text;
}

std::string map_c_header(const ServedMap& served) {
  std::string text =
      "/* Made by `flatpose map --format c`. Registers of flatpose: zero-based addresses of the "
      "PDU,\n"
      "   read by functions 3 and 4 alike; those below FLATPOSE_WRITABLE_END are written by 6 and "
      "16.\n"
      "   32-bit values take two registers, the high one first by default. */\n"
      "#ifndef FLATPOSE_REGISTERS_H\n#define FLATPOSE_REGISTERS_H\n\n";
  if (!served.config_path.empty())
    text += formatted("#define FLATPOSE_WORD_ORDER \"%s\" /* as configured */\n",
                      name_of(served.format.order));
  text += formatted("#define FLATPOSE_MAP_VERSION %d\n", result_map::kMapVersion);
  text += formatted("#define FLATPOSE_RESULT_ADDRESS %d\n#define FLATPOSE_RESULT_WORDS %d\n",
                    result_map::kResultAddress, result_map::kResultWords);
  text += formatted("#define FLATPOSE_FURTHER_ADDRESS %d\n#define FLATPOSE_FURTHER_WORDS %d\n",
                    result_map::kFurtherAddress, result_map::kFurtherWords);
  text += formatted(
      "#define FLATPOSE_FURTHER_PICK_ADDRESS %d\n#define FLATPOSE_FURTHER_PICK_WORDS %d\n",
      result_map::kFurtherPickAddress, result_map::kFurtherPickWords);
  // Written so that the least number is C as well.
  const long long none = static_cast<std::int32_t>(served.format.none_int32);
  text += formatted("#define FLATPOSE_NONE_INT32 (%lld - 1)\n\nenum {\n", none + 1);
  int writable_end = 0;
  for (const Entry& entry : result_map::entries()) {
    if (entry.table == Table::kHolding) writable_end = entry.address + entry.words();
    text += formatted("  FLATPOSE_REG_%s = %d, /* %s */\n", upper(name_of(entry)).c_str(),
                      entry.address, name_of(entry.type));
  }
  text += formatted("  FLATPOSE_WRITABLE_END = %d\n};\n", writable_end);
  add_enumeration("COMMAND", result_map::ValueSet::kCommands, text);
  add_enumeration("STATUS", result_map::ValueSet::kAnswers, text);
  add_enumeration("REFUSED", result_map::ValueSet::kRefusals, text);
  add_enumeration("BIT", result_map::ValueSet::kBits, text);
  add_enumeration("CONTROL", result_map::ValueSet::kControlBits, text);
  add_enumeration("PICK", result_map::ValueSet::kPickOutcomes, text);
  add_enumeration("FRAME", result_map::ValueSet::kFrames, text);
  add_enumeration("CONVENTION", result_map::ValueSet::kConventions, text);
  return text + "\n#endif\n";
}

}  // namespace flatpose::tool
