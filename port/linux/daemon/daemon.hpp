#pragma once
// The program `flatposed` without its main(), so that tests call it in process.
//
//   flatposed --config FILE.toml [--modbus-port N] [--scan FILE|DIR] [--check]
//
// Exit codes: 0 ended by SIGTERM or SIGINT, or the config is valid; 2 usage or config; 3 internal.
// Errors are one line on `err`: `flatposed: FILE:LINE: WHAT; REMEDY`. What --check finds goes to
// `out`, everything else to `err`, which is the log.

#include <iosfwd>
#include <span>
#include <string>

namespace flatpose::daemon {

enum class ExitCode : int { kDone = 0, kInput = 2, kInternal = 3 };

/// `args` are those after the program's name; `root` stands before /proc, /sys and /dev: tests give
/// a folder.  Fails: never throws.
[[nodiscard]] int run_daemon(std::span<const std::string> args, std::ostream& out,
                             std::ostream& err, const std::string& root = {}) noexcept;

}  // namespace flatpose::daemon
