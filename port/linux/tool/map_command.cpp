// flatpose map

#include <memory>
#include <optional>

#include "port/linux/tool/command.hpp"
#include "port/linux/tool/map_can.hpp"
#include "port/linux/tool/map_text.hpp"
#include "port/linux/tool/number_text.hpp"
#include "port/linux/tool/options.hpp"
#include "port/linux/tool/served_map.hpp"

namespace flatpose::tool {
namespace {

struct Format {
  const char* name;
  std::string (*text)(const ServedMap& served);
};
constexpr Format kFormats[] = {
    {"markdown", map_markdown},
    {"json", map_json},
    {"csv", map_csv},
    {"c", map_c_header},
    {"st", [](const ServedMap& s) { return map_function_block(PlcDialect::kCodesys, s); }},
    {"scl", [](const ServedMap& s) { return map_function_block(PlcDialect::kScl, s); }},
    {"eds", map_eds},
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

Action add_map(CLI::App& app, const ReadServedMap& read_config) {
  auto format = std::make_shared<const Format*>(&kFormats[0]);
  auto node = std::make_shared<std::optional<int>>();
  auto config = std::make_shared<std::string>();
  add_text(app, "--format", "FORMAT",
           "json | markdown | csv | st | scl | c | eds | dbc; default markdown",
           [format](const std::string& text) { *format = &format_named(text); });
  app.add_option("--config", *config, "a daemon's: the map as that serves it")
      ->type_name("FILE.toml");
  add_text(app, "--node", "N", "of dbc: the CAN node that it is for; default the config's, or 10",
           [node](const std::string& text) {
             *node = static_cast<int>(parse_whole("--node", text, 1, can::kNodeMax));
           });
  return [format, node, config, read_config](Report& report) {
    ServedMap served = config->empty() ? ServedMap{} : read_config(*config);
    served.node = node->value_or(served.node);
    report.text = (*format)->text(served);
    return ExitCode::kDone;
  };
}

}  // namespace flatpose::tool
