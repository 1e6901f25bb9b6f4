#pragma once
// What is set up once for the whole process, and stands as long as this does.

#include <string>

#include "port/linux/realtime/config.hpp"
#include "port/linux/realtime/cpu_latency.hpp"
#include "port/linux/realtime/step.hpp"

namespace flatpose::port {

class ProcessSetup {
 public:
  /// Before threads are started.  `root` stands before /dev: tests give a folder.
  explicit ProcessSetup(const RealtimeConfig& config, const std::string& root = {});

  /// One for each thing that the config asks for.
  [[nodiscard]] const Steps& steps() const noexcept { return steps_; }

 private:
  CpuLatencyRequest latency_;
  Steps steps_;
};

}  // namespace flatpose::port
