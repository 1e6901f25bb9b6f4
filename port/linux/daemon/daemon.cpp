#include "port/linux/daemon/daemon.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <new>
#include <optional>
#include <ostream>
#include <sstream>
#include <utility>

#include "port/linux/daemon/bus.hpp"
#include "port/linux/daemon/check.hpp"
#include "port/linux/daemon/config.hpp"
#include "port/linux/daemon/job_set.hpp"
#include "port/linux/daemon/log.hpp"
#include "port/linux/daemon/reloader.hpp"
#include "port/linux/daemon/search_engine.hpp"
#include "port/linux/daemon/service.hpp"
#include "port/linux/daemon/stop_signal.hpp"
#include "port/linux/daemon/warnings.hpp"
#include "port/linux/files/input_error.hpp"
#include "port/linux/realtime/process_setup.hpp"
#include "port/linux/records/boot_count.hpp"

namespace flatpose::daemon {
namespace {

constexpr int kPortMax = 65535;

struct Options {
  std::string config_path;
  std::string scan_path;
  std::optional<int> modbus_port;
  bool only_checks = false;
};

int say(std::ostream& err, const std::string& line, ExitCode code) {
  err << "flatposed: " << line << '\n' << std::flush;
  return static_cast<int>(code);
}

void log(Log& log, const port::Steps& steps) {
  for (const port::Step& step : steps)
    log.line((step.is_done ? "" : "warning: not done: ") + port::line_of(step));
}

/// CLI11's message in one line of ours.
std::string usage_line(const CLI::ParseError& error) {
  std::string why = error.what();
  std::replace(why.begin(), why.end(), '\n', ' ');
  while (!why.empty() && (why.back() == '.' || why.back() == ' ')) why.pop_back();
  return port::InputError("command line", why, "see flatposed --help").line();
}

/// The file's, with what the command line says instead.
Config config_of(const Options& options) {
  Config config = load_config(options.config_path);
  if (options.modbus_port) {
    config.modbus.is_on = true;
    config.modbus.port = *options.modbus_port;
    config.modbus.place = "--modbus-port";
  }
  if (!options.scan_path.empty()) {
    config.source.watch.clear();
    config.source.driver.clear();
    config.source.replay = options.scan_path;
    config.source.place = "--scan";
  }
  std::error_code error;
  const std::string& replay = config.source.replay;
  if (!replay.empty() && !std::filesystem::exists(replay, error))
    throw port::InputError(config.source.place, "there is no " + replay,
                           "name a scan or a folder of scans");
  return config;
}

/// Until a signal ends it. The service manager hears that the daemon lives only as long as the
/// search thread answers and the bus goes round.
void serve(SearchEngine& engine, Bus* bus, StopSignal& signal, Reloader& reloader, Log& log) {
  constexpr std::chrono::microseconds kReloadStep(2000);
  constexpr std::chrono::microseconds kNewsStep(500'000);
  const auto watched = alive_interval();
  auto interval = watched;
  if (bus != nullptr && bus->has_can())
    interval = std::min(interval.value_or(kNewsStep), kNewsStep);
  std::uint32_t turns = 0;
  std::uint32_t asked = engine.ask();
  for (;;) {
    const Signal came = signal.wait_for(reloader.is_busy() ? kReloadStep : interval);
    if (came == Signal::kStop) return;
    if (came == Signal::kReload) reloader.ask();
    reloader.step();
    if (bus != nullptr)
      for (const std::string& line : bus->news()) log.line(line);
    if (!watched) continue;
    const bool is_bus_alive = bus == nullptr || std::exchange(turns, bus->turns()) != bus->turns();
    if (!engine.has_answered(asked) || !is_bus_alive) continue;
    tell_alive();
    asked = engine.ask();
  }
}

void warn(const Config& config, const JobSet& jobs, Log& log) {
  for (const std::string& line : jobs.problems()) log.line("warning: " + line);
  for (const std::string& line : warnings_of(config)) log.line("warning: " + line);
}

std::uint16_t counted_boots(const RecordsConfig& records, Log& log) {
  const std::string path = state_file_of(records, std::getenv("STATE_DIRECTORY"));
  if (path.empty()) return 0;
  return port::count_boot(path, [&](const std::string& line) { log.line("warning: " + line); });
}

void run_service(const Options& options, const Config& config, std::ostream& err,
                 const std::string& root) {
  const auto set = std::make_shared<const JobSet>(load_jobs(config));
  check_memory(options.config_path, config, root);
  Log events(err);
  StopSignal signal;              // before there are threads, which inherit what is blocked
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is an error like a full disk
  SearchEngine engine(config, set, events);
  std::unique_ptr<Bus> bus;
  const std::uint16_t boots = counted_boots(config.records, events);
  if (config.modbus.is_on || config.can.is_on)
    bus = std::make_unique<Bus>(config, set->rules(), engine, boots);
  const port::ProcessSetup setup(config.realtime, root);
  log(events, setup.steps());
  engine.start();
  log(events, engine.steps());
  if (bus) bus->start();
  warn(config, *set, events);
  const std::string state = threads_text(config.search) + ", " +
                            std::to_string(held_bytes(config) >> 20) + " MB" +
                            (bus ? "; " + bus->name() : std::string());
  tell_ready(state);
  events.line("ready: " + state);
  Reloader reloader(
      config, [&options] { return config_of(options); }, engine, bus != nullptr, events);
  serve(engine, bus.get(), signal, reloader, events);
  tell_stopping();
  bus.reset();
  events.line("ended");
}

int run(std::span<const std::string> args, std::ostream& out, std::ostream& err,
        const std::string& root) {
  CLI::App app("Finds flat parts in range images when a PLC asks for it.", "flatposed");
  Options options;
  app.add_option("--config", options.config_path, "what to do, in TOML")
      ->type_name("FILE.toml")
      ->required();
  app.add_option("--modbus-port", options.modbus_port, "instead of [modbus]'s; 0: any that is free")
      ->type_name("N")
      ->check(CLI::Range(0, kPortMax));
  app.add_option(
         "--scan", options.scan_path,
         "replay this file for every trigger, or a folder's files in the order of their names")
      ->type_name("FILE|DIR");
  app.add_flag(
      "--check", options.only_checks,
      "validate the config, say whether the daemon would start on this machine and what it "
      "lacks for real time, and end; the exit code is that of the config alone");
  try {
    app.parse(std::vector<std::string>(args.rbegin(), args.rend()));
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) return say(err, usage_line(error), ExitCode::kInput);
    app.exit(error, out, err);
    return static_cast<int>(ExitCode::kDone);
  }
  const Config config = config_of(options);
  if (options.only_checks) {
    const JobSet jobs = load_jobs(config);
    out << check_report(options.config_path, config, root);
    for (const std::string& line : jobs.problems()) out << "\nwarning: " << line << '\n';
    for (const std::string& line : warnings_of(config)) out << "\nwarning: " << line << '\n';
    out << std::flush;
    if (!out) return say(err, "stdout: cannot write it; check where it goes", ExitCode::kInput);
  } else {
    run_service(options, config, err, root);
  }
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

int run_daemon(std::span<const std::string> args, std::ostream& out, std::ostream& err,
               const std::string& root) noexcept {
  try {
    return run(args, out, err, root);
  } catch (const port::InputError& error) {
    return say(err, error.line(), ExitCode::kInput);
  } catch (const std::bad_alloc&) {
    return say(err, "memory: there is not enough; free some or lower the limits of [search]",
               ExitCode::kInternal);
  } catch (const std::exception& error) {
    return say(err,
               "internal error: " + port::printable(error.what(), port::kReasonBytesMax) +
                   "; please report it with the config",
               ExitCode::kInternal);
  } catch (...) {
    return say(err, "internal error: of unknown kind; please report it with the config",
               ExitCode::kInternal);
  }
}

}  // namespace flatpose::daemon
