#pragma once
// What a config makes of the register map, for flatpose map --config.

#include <string>

#include "port/linux/tool/served_map.hpp"

namespace flatpose::daemon {

/// Fails: port::InputError.
[[nodiscard]] tool::ServedMap read_served_map(const std::string& config_path);

}  // namespace flatpose::daemon
