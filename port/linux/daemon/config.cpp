#include "port/linux/daemon/config.hpp"

#include "port/linux/daemon/section.hpp"

namespace flatpose::daemon {
namespace {

Config read_config(Section file) {
  Config config;
  read_search(file.section("search"), config);
  read_realtime(file.section("realtime"), config);
  read_modbus(file.section("modbus"), config);
  read_can(file.section("can"), config);
  read_source(file.section("source"), config);
  read_records(file.section("records"), config);
  for (const Section& part : file.sections("part")) read_part(part, config);
  for (const Section& job : file.sections("job")) read_job(job, config);
  file.finish();
  return config;
}

}  // namespace

Config load_config(const std::string& path) { return read_config(Section::of_file(path)); }

Config parse_config(const std::string& path, std::string_view text) {
  return read_config(Section::of_text(path, text));
}

}  // namespace flatpose::daemon
