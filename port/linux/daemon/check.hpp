#pragma once
// --check: what is wrong with the config, what the machine lacks.

#include <functional>
#include <string>

#include "port/linux/can/interface.hpp"
#include "port/linux/daemon/config.hpp"

namespace flatpose::daemon {

using LookAtCan = std::function<port::CanInterface(const std::string& name)>;

/// What --check prints of a valid config, each lack of the machine with the command that mends it;
/// advice, for the config may be another machine's; but the first line tells whether the daemon
/// would start on this one, and if not why, in the words in which the start would say it.  `root`
/// stands before /proc, /sys and /dev, and `look_at_can` in place of the kernel: tests give their
/// own.
[[nodiscard]] std::string check_report(const std::string& path, const Config& config,
                                       const std::string& root = {},
                                       const LookAtCan& look_at_can = port::look_at_can);

/// Fails: port::InputError when the memory that the config asks for is not there.
void check_memory(const std::string& path, const Config& config, const std::string& root = {});

}  // namespace flatpose::daemon
