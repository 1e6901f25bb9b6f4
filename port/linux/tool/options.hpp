#pragma once
// Options that several commands share, each parsed strictly. For this folder's commands: it pulls
// CLI11 in.

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "port/linux/files/scan.hpp"
#include "port/linux/tool/number_text.hpp"
#include "port/linux/tool/region_text.hpp"

namespace flatpose::tool {

/// What is asked of a scan on its way in.
struct ScanOptions {
  std::optional<port::Up> up;
  std::string work_path;  ///< Empty: none.
  port::ReadLimits limits;
};

/// An option whose text `take(text)` understands, or refuses by InputError.
template <class Take>
CLI::Option* add_text(CLI::App& app, const std::string& name, const std::string& form,
                      const std::string& help, Take take) {
  return app
      .add_option_function<std::string>(
          name, [take = std::move(take)](const std::string& text) { take(text); }, help)
      ->type_name(form);
}

inline CLI::Option* add_number(CLI::App& app, const std::string& name, const std::string& form,
                               const std::string& help, double& value, double low, double high) {
  return add_text(app, name, form, help, [&value, name, low, high](const std::string& text) {
    value = parse_number(name, text, low, high);
  });
}

inline CLI::Option* add_count(CLI::App& app, const std::string& name, const std::string& form,
                              const std::string& help, int& value, int low, int high) {
  return add_text(app, name, form, help, [&value, name, low, high](const std::string& text) {
    value = static_cast<int>(parse_whole(name, text, low, high));
  });
}

inline void add_region(CLI::App& app, const std::string& help, Region& region) {
  add_text(app, "--region", "REGION",
           help + ": circle:X,Y,R | box:X0,Y0,X1,Y1 | polygon:X,Y;X,Y;..",
           [&region](const std::string& text) { region = parse_region("--region", text); });
}

/// --up and --max-points.
void add_reading(CLI::App& app, ScanOptions& options);
/// --work too.
void add_reading_and_work(CLI::App& app, ScanOptions& options);

}  // namespace flatpose::tool
