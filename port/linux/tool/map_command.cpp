// flatpose map

#include <memory>

#include "flatpose/can/config.hpp"
#include "port/linux/tool/command.hpp"
#include "port/linux/tool/map_can.hpp"
#include "port/linux/tool/map_text.hpp"
#include "port/linux/tool/number_text.hpp"
#include "port/linux/tool/options.hpp"

namespace flatpose::tool {
namespace {

struct Format {
  const char* name;
  std::string (*text)(int node);
};
constexpr Format kFormats[] = {
    {"markdown", [](int) { return map_markdown(); }},
    {"json", [](int) { return map_json(); }},
    {"csv", [](int) { return map_csv(); }},
    {"c", [](int) { return map_c_header(); }},
    {"st", [](int) { return map_function_block(PlcDialect::kCodesys); }},
    {"scl", [](int) { return map_function_block(PlcDialect::kScl); }},
    {"eds", [](int) { return map_eds(); }},
    {"dbc", map_dbc},
};

const Format& format_named(const std::string& name) {
  for (const Format& format : kFormats) {
    if (name == format.name) return format;
  }
  throw port::InputError("--format", "there is no \"" + port::printable(name, 20) + "\"",
                         "take json, markdown, csv, st, scl, c, eds or dbc");
}

}  // namespace

Action add_map(CLI::App& app) {
  auto format = std::make_shared<const Format*>(&kFormats[0]);
  auto node = std::make_shared<int>(can::Config{}.node);
  add_text(app, "--format", "FORMAT",
           "json | markdown | csv | st | scl | c | eds | dbc; default markdown",
           [format](const std::string& text) { *format = &format_named(text); });
  add_text(app, "--node", "N", "of dbc: the CAN node that it is for; default 10",
           [node](const std::string& text) {
             *node = static_cast<int>(parse_whole("--node", text, 1, can::kNodeMax));
           });
  return [format, node](Report& report) {
    report.text = (*format)->text(*node);
    return ExitCode::kDone;
  };
}

}  // namespace flatpose::tool
