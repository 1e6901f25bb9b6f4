#include "port/linux/daemon/config.hpp"

#include "port/linux/daemon/section.hpp"
#include "port/linux/files/atomic_file.hpp"

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

Config load_config(const std::string& path) {
  const std::vector<std::byte> bytes = port::read_file(path, kConfigBytesMax);
  return parse_config(path, port::as_text(bytes));
}

Config parse_config(const std::string& path, std::string_view text) {
  Config config = read_config(Section::of_text(path, text));
  config.text = text;
  return config;
}

}  // namespace flatpose::daemon
