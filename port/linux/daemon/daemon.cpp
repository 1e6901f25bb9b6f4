#include "port/linux/daemon/daemon.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <new>
#include <ostream>
#include <sstream>

#include "port/linux/daemon/check.hpp"
#include "port/linux/daemon/config.hpp"
#include "port/linux/daemon/search_engine.hpp"
#include "port/linux/daemon/service.hpp"
#include "port/linux/daemon/stop_signal.hpp"
#include "port/linux/files/input_error.hpp"
#include "port/linux/realtime/process_setup.hpp"

namespace flatpose::daemon {
namespace {

struct Options {
  std::string config_path;
  bool only_checks = false;
};

int say(std::ostream& err, const std::string& line, ExitCode code) {
  err << "flatposed: " << line << '\n' << std::flush;
  return static_cast<int>(code);
}

void log(std::ostream& err, const std::string& line) {
  err << "flatposed: " << port::printable(line, 1000) << '\n' << std::flush;
}

void log(std::ostream& err, const port::Steps& steps) {
  for (const port::Step& step : steps)
    log(err, (step.is_done ? "" : "warning: not done: ") + port::line_of(step));
}

/// CLI11's message in one line of ours.
std::string usage_line(const CLI::ParseError& error) {
  std::string why = error.what();
  std::replace(why.begin(), why.end(), '\n', ' ');
  while (!why.empty() && (why.back() == '.' || why.back() == ' ')) why.pop_back();
  return port::InputError("command line", why, "see flatposed --help").line();
}

/// Until a signal ends it. The service manager hears that the daemon lives only as long as the
/// search thread answers.
void serve(SearchEngine& engine, StopSignal& signal) {
  const auto interval = alive_interval();
  engine.ask();
  while (!signal.wait_for(interval)) {
    if (!engine.has_answered()) continue;
    tell_alive();
    engine.ask();
  }
}

void run_service(const Options& options, const Config& config, std::ostream& err,
                 const std::string& root) {
  check_memory(options.config_path, config, root);
  StopSignal signal;  // before there are threads, which inherit what is blocked
  SearchEngine engine(config);
  const port::ProcessSetup setup(config.realtime, root);
  log(err, setup.steps());
  engine.start();
  log(err, engine.steps());
  const std::string state =
      threads_text(config.search) + ", " + std::to_string(held_bytes(config.search) >> 20) + " MB";
  tell_ready(state);
  log(err, "ready: " + state + "; no bus is built in yet: SIGTERM ends it");
  serve(engine, signal);
  tell_stopping();
  log(err, "ended");
}

int run(std::span<const std::string> args, std::ostream& out, std::ostream& err,
        const std::string& root) {
  CLI::App app("Finds flat parts in range images when a PLC asks for it.", "flatposed");
  Options options;
  app.add_option("--config", options.config_path, "what to do, in TOML")
      ->type_name("FILE.toml")
      ->required();
  app.add_flag("--check", options.only_checks,
               "validate the config, name what the machine lacks for real time, and end");
  try {
    app.parse(std::vector<std::string>(args.rbegin(), args.rend()));
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) return say(err, usage_line(error), ExitCode::kInput);
    app.exit(error, out, err);
    return static_cast<int>(ExitCode::kDone);
  }
  const Config config = load_config(options.config_path);
  if (options.only_checks) {
    out << check_report(options.config_path, config, root) << std::flush;
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
