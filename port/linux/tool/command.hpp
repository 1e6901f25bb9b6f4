#pragma once
// What every command of the tool is made of: options that it adds to the command line, and an
// action that runs when the line was understood.

#include <functional>
#include <string>
#include <vector>

#include "port/linux/files/input_error.hpp"
#include "port/linux/tool/served_map.hpp"

namespace CLI {
class App;
}

namespace flatpose::tool {

enum class ExitCode : int { kDone = 0, kNone = 1, kInput = 2, kInternal = 3 };

/// What a command has to say. It is printed when the command is over, so that a failure prints
/// nothing but its one line.
struct Report {
  std::string text;                   ///< For stdout.
  std::vector<std::string> warnings;  ///< For stderr, a line each.
};

/// Sound input that holds nothing to find: exit code 1.
struct NothingFound : port::InputError {
  using InputError::InputError;
};

using Action = std::function<ExitCode(Report&)>;

/// Each adds one command to the line; the action belongs to it.
[[nodiscard]] Action add_teach(CLI::App& app);
[[nodiscard]] Action add_locate(CLI::App& app);
[[nodiscard]] Action add_test(CLI::App& app);
[[nodiscard]] Action add_align(CLI::App& app);
[[nodiscard]] Action add_info(CLI::App& app);
[[nodiscard]] Action add_simulate(CLI::App& app);
[[nodiscard]] Action add_map(CLI::App& app, const ReadServedMap& read_config);

}  // namespace flatpose::tool
