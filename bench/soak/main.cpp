// flatpose_soak echo | plc: run_soak.py starts both.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <exception>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "bench/soak/echo.hpp"
#include "bench/soak/plc.hpp"

namespace flatpose::soak {
namespace {

using Json = nlohmann::ordered_json;

/// The least sample that so many are not above.
double quantile_us(const std::vector<std::int64_t>& sorted_ns, double share) {
  const auto count = static_cast<double>(sorted_ns.size());
  const auto at = static_cast<std::size_t>(std::max(std::ceil(share * count) - 1.0, 0.0));
  return static_cast<double>(sorted_ns[std::min(at, sorted_ns.size() - 1)]) / 1000.0;
}

Json summary(std::vector<std::int64_t> samples_ns) {
  if (samples_ns.empty()) return nullptr;
  std::sort(samples_ns.begin(), samples_ns.end());
  return {{"count", samples_ns.size()},
          {"p50_us", quantile_us(samples_ns, 0.5)},
          {"p99_us", quantile_us(samples_ns, 0.99)},
          {"p999_us", quantile_us(samples_ns, 0.999)},
          {"max_us", quantile_us(samples_ns, 1.0)}};
}

Json report(const Tally& tally) {
  Json statuses = Json::object();
  for (const auto& [status, count] : tally.statuses) statuses[std::to_string(status)] = count;
  return {{"done", tally.done_count},       {"refused", tally.refused_count},
          {"lost", tally.lost_count},       {"doubled", tally.doubled_count},
          {"torn", tally.torn_count},       {"statuses", statuses},
          {"read", summary(tally.read_ns)}, {"write", summary(tally.write_ns)},
          {"echo", summary(tally.echo_ns)}};
}

void write_trips(const std::string& path, const Tally& tally) {
  std::ofstream file(path);
  file << "number,written_us,read_us,status\n";
  for (const Trip& trip : tally.trips)
    file << trip.number << ',' << trip.written_us << ',' << trip.read_us << ',' << trip.status
         << '\n';
}

int run(int argc, char** argv) {
  CLI::App app("A PLC for ./run soak", "flatpose_soak");
  app.require_subcommand(1);
  CLI::App& echo = *app.add_subcommand("echo", "answers bytes with bytes");
  CLI::App& plc = *app.add_subcommand("plc", "triggers and reads");
  Plan plan;
  std::string trips_path;
  plc.add_option("--port", plan.port)->required();
  plc.add_option("--echo-port", plan.echo_port)->required();
  plc.add_option("--triggers", plan.trigger_count)->required();
  plc.add_option("--time-max-us", plan.time_max_us);
  plc.add_option("--poll-us", plan.poll_us);
  plc.add_option("--pause-us", plan.pause_us);
  plc.add_option("--first", plan.first_number);
  plc.add_option("--trips", trips_path);
  CLI11_PARSE(app, argc, argv);
  if (echo.parsed()) return serve_echo(kReadBytes, kBlockBytes);
  const Tally tally = run_plc(plan);
  if (!trips_path.empty()) write_trips(trips_path, tally);
  std::cout << report(tally).dump() << std::endl;
  return 0;
}

}  // namespace
}  // namespace flatpose::soak

int main(int argc, char** argv) {
  try {
    return flatpose::soak::run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "flatpose_soak: " << error.what() << '\n';
    return 3;
  }
}
