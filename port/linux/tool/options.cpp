#include "port/linux/tool/options.hpp"

#include "port/linux/files/input_error.hpp"

namespace flatpose::tool {

void add_reading(CLI::App& app, ScanOptions& options) {
  add_text(app, "--up", "+z|-z", "side of the scan that the sensor looks from",
           [&options](const std::string& text) {
             options.up = port::parse_up(text);
             if (!options.up)
               throw port::InputError("--up", "\"" + text + "\" names no side", "give +z or -z");
           });
  add_text(app, "--max-points", "N", "largest scan that is read, in pixels (4000000)",
           [&options](const std::string& text) {
             options.limits.max_points = parse_whole("--max-points", text, 4, 1'000'000'000);
           });
}

void add_reading_and_work(CLI::App& app, ScanOptions& options) {
  add_reading(app, options);
  app.add_option("--work", options.work_path, "work plane of `align`: all is in its frame then")
      ->type_name("WORK.json");
}

}  // namespace flatpose::tool
