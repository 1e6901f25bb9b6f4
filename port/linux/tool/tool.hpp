#pragma once
// The program `flatpose` without its main(), so that tests call it in process.
//
// Exit codes: 0 at least one match (or done), 1 none, 2 usage or input, 3 internal. Errors are one
// line on `err`, `flatpose: WHAT: WHY; REMEDY`; with 2 and 3 nothing is printed on `out`.

#include <iosfwd>
#include <span>
#include <string>

#include "port/linux/tool/served_map.hpp"

namespace flatpose::tool {

/// Runs one command; `args` are those after the program's name. `read_config` is for map --config.
/// Fails: never throws; what goes wrong is its exit code and a line on `err`.
[[nodiscard]] int run_tool(std::span<const std::string> args, std::ostream& out, std::ostream& err,
                           const ReadServedMap& read_config) noexcept;

}  // namespace flatpose::tool
