#pragma once
// What the machine lacks for a search whose time is certain, each with the command that mends it.

#include <cstdint>
#include <string>
#include <vector>

#include "port/linux/realtime/config.hpp"
#include "port/linux/realtime/machine.hpp"

namespace flatpose::port {

struct Advice {
  std::string what;     ///< "kernel"
  std::string why;      ///< What is so, and what it costs.
  std::string command;  ///< For a shell, or a line of the config.
};

/// In the order of what it is worth.  `memory_bytes` is what the process may take.
[[nodiscard]] std::vector<Advice> advise(const Machine& machine, const RealtimeConfig& config,
                                         int thread_count, std::int64_t memory_bytes);

}  // namespace flatpose::port
