#include "port/linux/daemon/config.hpp"

#include "port/linux/daemon/section.hpp"
#include "port/linux/files/atomic_file.hpp"

namespace flatpose::daemon {
namespace {

constexpr Range kLeases_ms{100, 3'600'000};
constexpr std::int64_t kUsPerMs = 1000;

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

void read_lease(Section& section, Config& config) {
  const auto lease_ms = section.whole("lease_ms", kLeases_ms);
  if (!lease_ms) return;
  const std::int64_t before_ms = config.lease_us.value_or(*lease_ms * kUsPerMs) / kUsPerMs;
  if (*lease_ms != before_ms)
    section.fail("lease_ms",
                 "'lease_ms' is " + std::to_string(*lease_ms) + " here and " +
                     std::to_string(before_ms) + " in the other bus's section",
                 "there is one lease: write it once");
  config.lease_us = *lease_ms * kUsPerMs;
}

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
