#include "port/linux/tool/tool.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <new>
#include <ostream>
#include <sstream>

#include "port/linux/files/input_error.hpp"
#include "port/linux/tool/command.hpp"

namespace flatpose::tool {
namespace {

constexpr const char* kVersion = "flatpose 0.1.0";

struct Command {
  const char* name;
  const char* what;
  Action (*add)(CLI::App&);
};
constexpr Command kCommands[] = {
    {"teach", "learn a part from one or more scans", add_teach},
    {"locate", "find a part in a scan", add_locate},
    {"test", "how well a part will work", add_test},
    {"align", "find the work plane in a scan", add_align},
    {"info", "what a file is and holds", add_info},
    {"simulate", "make a scan whose truth is known", add_simulate},
};

// What stands on the line that no option or command takes; CLI11 complains of something missing
// first, though the reason is most often this.
std::string stray_text(const CLI::App& app) {
  for (const std::string& text : app.remaining(true)) {
    if (!text.empty() && text != "--") return port::printable(text, 60);
  }
  return {};
}

// CLI11's messages, made one line in the tool's own form.
std::string usage_line(const CLI::App& app, const CLI::ParseError& error) {
  std::string what = "command line";
  std::string help = "flatpose --help";
  for (const CLI::App* command : app.get_subcommands()) {
    what = command->get_name();
    help = "flatpose " + what + " --help";
  }
  std::string why = error.what();
  if (const std::string stray = stray_text(app); !stray.empty()) {
    const bool has_command = !app.get_subcommands().empty();
    const char* kind = !has_command ? "command" : stray[0] == '-' ? "option" : "argument";
    why = "unknown " + std::string(kind) + " \"" + stray + "\"";
  } else if (app.get_subcommands().empty()) {
    why = "a command is missing";
  }
  while (!why.empty() && (why.back() == '.' || why.back() == '\n')) why.pop_back();
  std::replace(why.begin(), why.end(), '\n', ' ');
  return port::InputError(what, why, "see " + help).line();
}

// CLI11 takes an empty text for an option that was not given, and what was asked is then quietly
// not done.
void refuse_empty(std::span<const std::string> args) {
  std::string before = "command line";
  bool may_be_option = true;
  for (const std::string& arg : args) {
    const bool is_option = may_be_option && arg.starts_with("-");
    const bool ends_empty = is_option && arg.starts_with("--") && arg.find('=') == arg.size() - 1;
    if (arg.empty() || ends_empty)
      throw port::InputError(ends_empty ? arg.substr(0, arg.size() - 1) : before,
                             arg.empty() ? "an argument is empty" : "its value is empty",
                             "give a value or leave it out");
    if (arg == "--") may_be_option = false;
    before = is_option && arg != "--" ? arg : "command line";
  }
}

int say(std::ostream& err, const std::string& line, ExitCode code) {
  err << "flatpose: " << line << '\n' << std::flush;
  return static_cast<int>(code);
}

int print(const Report& report, ExitCode code, std::ostream& out, std::ostream& err) {
  for (const std::string& warning : report.warnings)
    err << "flatpose: warning: " << port::printable(warning, port::kReasonBytesMax) << '\n';
  err.flush();
  out << report.text << std::flush;
  if (!out) return say(err, "stdout: cannot write it; check where it goes", ExitCode::kInput);
  return static_cast<int>(code);
}

int run(std::span<const std::string> args, std::ostream& out, std::ostream& err,
        const ReadServedMap& read_config) {
  refuse_empty(args);
  CLI::App app("Finds flat parts in range images, as a 6-DoF pose.", "flatpose");
  app.set_version_flag("--version", kVersion);
  app.require_subcommand(1);
  Action action;
  for (const Command& command : kCommands) {
    CLI::App* sub = app.add_subcommand(command.name, command.what);
    sub->final_callback([&action, own = command.add(*sub)] { action = own; });
  }
  CLI::App* map = app.add_subcommand("map", "the registers that a PLC reads and writes");
  map->final_callback([&action, own = add_map(*map, read_config)] { action = own; });
  try {
    app.parse(std::vector<std::string>(args.rbegin(), args.rend()));
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) return say(err, usage_line(app, error), ExitCode::kInput);
    std::ostringstream text;
    app.exit(error, text, text);
    return print({text.str(), {}}, ExitCode::kDone, out, err);
  }
  Report report;
  const ExitCode code = action(report);
  return print(report, code, out, err);
}

}  // namespace

int run_tool(std::span<const std::string> args, std::ostream& out, std::ostream& err,
             const ReadServedMap& read_config) noexcept {
  try {
    return run(args, out, err, read_config);
  } catch (const NothingFound& nothing) {
    return say(err, nothing.line(), ExitCode::kNone);
  } catch (const port::InputError& error) {
    return say(err, error.line(), ExitCode::kInput);
  } catch (const std::bad_alloc&) {
    return say(err, "memory: there is not enough; free some or give a smaller scan",
               ExitCode::kInternal);
  } catch (const std::exception& error) {
    return say(err,
               "internal error: " + port::printable(error.what(), port::kReasonBytesMax) +
                   "; please report it with the command line",
               ExitCode::kInternal);
  } catch (...) {
    return say(err, "internal error: of unknown kind; please report it with the command line",
               ExitCode::kInternal);
  }
}

}  // namespace flatpose::tool
