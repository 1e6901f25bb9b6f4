#pragma once
// --check: what is wrong with the config, what the machine lacks.

#include <string>

#include "port/linux/daemon/config.hpp"

namespace flatpose::daemon {

/// What --check prints of a valid config, each lack of the machine with the command that mends it.
/// `root` stands before /proc, /sys and /dev: tests give a folder.
[[nodiscard]] std::string check_report(const std::string& path, const Config& config,
                                       const std::string& root = {});

/// Fails: port::InputError when the memory that the config asks for is not there.
void check_memory(const std::string& path, const Config& config, const std::string& root = {});

}  // namespace flatpose::daemon
