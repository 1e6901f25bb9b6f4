// flatpose map

#include <memory>

#include "port/linux/tool/command.hpp"
#include "port/linux/tool/map_text.hpp"
#include "port/linux/tool/options.hpp"

namespace flatpose::tool {
namespace {

struct Format {
  const char* name;
  std::string (*text)();
};
constexpr Format kFormats[] = {
    {"markdown", map_markdown},
    {"json", map_json},
    {"csv", map_csv},
    {"c", map_c_header},
    {"st", [] { return map_function_block(PlcDialect::kCodesys); }},
    {"scl", [] { return map_function_block(PlcDialect::kScl); }},
};

const Format& format_named(const std::string& name) {
  for (const Format& format : kFormats) {
    if (name == format.name) return format;
  }
  if (name == "eds" || name == "dbc")
    throw port::InputError("--format", name + " comes with CAN, which is not built yet",
                           "take json, it has the CAN objects");
  throw port::InputError("--format", "there is no \"" + port::printable(name, 20) + "\"",
                         "take json, markdown, csv, st, scl or c");
}

}  // namespace

Action add_map(CLI::App& app) {
  auto format = std::make_shared<const Format*>(&kFormats[0]);
  add_text(app, "--format", "FORMAT", "json | markdown | csv | st | scl | c; default markdown",
           [format](const std::string& text) { *format = &format_named(text); });
  return [format](Report& report) {
    report.text = (*format)->text();
    return ExitCode::kDone;
  };
}

}  // namespace flatpose::tool
