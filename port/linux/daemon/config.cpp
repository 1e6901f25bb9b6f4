#include "port/linux/daemon/config.hpp"

#include "port/linux/daemon/section.hpp"

namespace flatpose::daemon {
namespace {

Config read_config(Section file) {
  Config config;
  read_search(file.section("search"), config);
  read_realtime(file.section("realtime"), config);
  file.finish();
  return config;
}

}  // namespace

Config load_config(const std::string& path) { return read_config(Section::of_file(path)); }

Config parse_config(const std::string& path, std::string_view text) {
  return read_config(Section::of_text(path, text));
}

}  // namespace flatpose::daemon
