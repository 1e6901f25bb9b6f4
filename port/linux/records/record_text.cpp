#include "port/linux/records/record_text.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "flatpose/core/fnv.hpp"
#include "flatpose/core/maths.hpp"
#include "port/linux/files/input_error.hpp"
#include "port/linux/files/json_text.hpp"
#include "port/linux/files/pcd.hpp"
#include "port/linux/tool/match_json.hpp"
#include "port/linux/tool/number_text.hpp"

namespace flatpose::port {
namespace {

using tool::Json;

/// Beyond any coordinate that is allowed.
constexpr double kViewpoint_mm = 1.0e8;
constexpr std::int64_t kUsPerMs = 1000;
constexpr std::int64_t kUsPerS = 1'000'000;

/// "2026-01-31T23:59:59.123Z"
std::string iso_time(std::int64_t since_1970_us) {
  const std::string t = utc_text(since_1970_us);
  const auto ms = static_cast<int>(since_1970_us % kUsPerS / kUsPerMs);
  return t.substr(0, 4) + "-" + t.substr(4, 2) + "-" + t.substr(6, 5) + ":" + t.substr(11, 2) +
         ":" + t.substr(13, 2) + tool::formatted(".%03dZ", ms);
}

double rank(const Json& match) {
  return match["score"].get<double>() * match["visible"].get<double>();
}

// Of several parts: the matches of all, best first, each with its part; times and counts summed.
void add_part(Json& json, const Json& more) {
  Json& matches = json["matches"];
  for (const Json& match : more["matches"]) matches.push_back(match);
  std::stable_sort(matches.begin(), matches.end(),
                   [](const Json& a, const Json& b) { return rank(a) > rank(b); });
  for (auto& [stage, time_us] : json["timings_us"].items()) {
    if (stage != "load")
      time_us = time_us.get<std::int64_t>() + more["timings_us"][stage].get<std::int64_t>();
  }
  for (const char* const count : {"hypotheses", "evaluated"})
    json["search"][count] =
        json["search"][count].get<std::int64_t>() + more["search"][count].get<std::int64_t>();
  json["search"]["exact"] =
      json["search"]["exact"].get<bool>() && more["search"]["exact"].get<bool>();
  for (const char* const most : {"/search/bound_gap", "/memory/peak_bytes"}) {
    const Json::json_pointer place(most);
    json[place] = std::max(json[place], more[place]);
  }
  Fnv1a64 both;
  for (const Json* digest : {&std::as_const(json)["digest"], &more["digest"]}) {
    const auto text = digest->get<std::string>();
    both.add(std::as_bytes(std::span(text)));
  }
  json["digest"] = tool::formatted("%016llx", static_cast<unsigned long long>(both.value()));
}

Json searched_json(const Record& record) {
  Json all;
  const SearchTrace& trace = record.trace;
  for (int i = 0; i < trace.part_count; ++i) {
    const SearchedPart& part = trace.parts[static_cast<std::size_t>(i)];
    Json json = tool::json_of(*part.part, record.loaded, part.result, record.arena_bytes);
    if (trace.part_count > 1)
      for (Json& match : json["matches"]) match["part"] = part.part->name.data();
    if (i == 0) {
      all = std::move(json);
    } else {
      add_part(all, json);
    }
  }
  return all;
}

Json told_json(const job::ScanResult& result) {
  Json told;
  told["status"] = static_cast<int>(result.answer);
  told["frame"] = job::name_of(job::frame_names(), static_cast<int>(result.frame));
  told["matches"] = Json::array();
  for (int i = 0; i < result.match_count; ++i) {
    const job::FoundMatch& match = result.matches[static_cast<std::size_t>(i)];
    Json one;
    one["part_index"] = match.part;
    one["tool"] = match.tool;
    one["pick"] = match.pick;
    one["score"] = match.score;
    one["visible"] = match.visible;
    tool::add_pose(one, match.frame_T_pick);
    told["matches"].push_back(one);
  }
  told["part_hash"] = result.part_hash;
  told["alignment_hash"] = result.alignment_hash;
  return told;
}

Json scan_json(const Record& record, const RecordName& name) {
  if (!record.has_scan()) return nullptr;
  Json scan;
  scan["file"] = name.text() + ".pcd";
  scan["number"] = record.result.scan_number;
  scan["source"] = record.loaded.path;
  scan["simulated"] = record.result.is_simulated;
  scan["repeated"] = record.result.is_repeated;
  return scan;
}

Json times_json(const Record& record) {
  const auto time = [](std::int64_t us) { return us == 0 ? Json() : Json(us); };
  Json times;
  times["accepted"] = time(record.order.accepted_us);
  times["acquired"] = time(record.result.acquired_us);
  times["begun"] = time(record.times.begun_us);
  times["ended"] = time(record.times.ended_us);
  times["said"] = time(record.times.said_us);
  times["copied"] = time(record.times.copied_us);
  times["posted"] = time(record.times.posted_us);
  return times;
}

void add_asked(Json& json, const Record& record, const RecordName& name) {
  json["record"] = name.sequence;
  json["time"] = iso_time(record.since_1970_us);
  json["number"] = record.order.number;
  json["command"] = job::name_of(job::command_names(), static_cast<int>(record.order.command));
  json["job"] = record.order.job;
  json["scan"] = scan_json(record, name);
}

Json parsed(const std::string& path, const std::string& text) {
  (void)parse_json(path, std::as_bytes(std::span(text)));  // for its limits and messages
  return Json::parse(text);
}

const char* outcome_name(std::uint16_t outcome) {
  return job::name_of(job::pick_outcome_names(), outcome);
}

}  // namespace

RecordName name_of(const Record& record) {
  RecordName name;
  name.time = utc_text(record.since_1970_us);
  name.number = record.order.number;
  const job::Answer answer = record.result.answer;
  const bool has_pose = record.result.match_count > 0;
  name.kind = !job::may_have_pose(answer) ? RecordName::Kind::kFailed
              : has_pose                  ? RecordName::Kind::kFound
                                          : RecordName::Kind::kDone;
  name.status = job::to_string(answer);
  return name;
}

std::string record_json(const Record& record, const RecordName& name) {
  Json json;
  json["status"] = job::to_string(record.result.answer);
  json["matches"] = Json::array();
  if (record.trace.part_count > 0) json = searched_json(record);
  json["status"] = job::to_string(record.result.answer);
  add_asked(json, record, name);
  json["told"] = told_json(record.result);
  json["times_us"] = times_json(record);
  json["dropped"] = record.dropped_count;
  json["picks"] = Json::array();
  return tool::line_of(json);
}

std::string saved_json(const Record& record, const RecordName& name) {
  Json json;
  json["up"] = to_string(record.loaded.scan.up);
  add_asked(json, record, name);
  return tool::line_of(json);
}

std::vector<std::byte> record_pcd(const Record& record) {
  const double z_mm = record.loaded.scan.up == Up::kPlusZ ? kViewpoint_mm : -kViewpoint_mm;
  return pcd_bytes(record.loaded.scan.view(), {0.0, 0.0, z_mm}, record.result.is_simulated);
}

std::string with_pick(const std::string& path, const std::string& text, const Pick& pick) {
  Json json = parsed(path, text);
  if (!json.is_object() || !json["picks"].is_array())
    throw InputError(path, "it is no record", "leave records as they are");
  Json added;
  added["outcome"] = pick.outcome;
  added["name"] = outcome_name(pick.outcome);
  added["time"] = iso_time(pick.since_1970_us);
  json["picks"].push_back(added);
  return tool::line_of(json);
}

std::string with_pick_counted(const std::string& path, const std::string& text, const Pick& pick) {
  Json json = text.empty() ? Json::object() : parsed(path, text);
  if (!json.is_object()) throw InputError(path, "it counts nothing", "take it away");
  for (const job::Named& named : job::pick_outcome_names())
    if (!json[named.name].is_number_unsigned()) json[named.name] = 0U;
  Json& count = json[outcome_name(pick.outcome)];
  count = (count.is_number_unsigned() ? count.get<std::uint64_t>() : 0) + 1;
  return tool::line_of(json);
}

}  // namespace flatpose::port
