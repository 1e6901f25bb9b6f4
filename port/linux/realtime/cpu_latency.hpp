#pragma once
// Asks the kernel's power management to keep processors where they wake up fast. The request stands
// as long as the file is open.

#include <cstdint>
#include <string>

#include "port/linux/realtime/step.hpp"

namespace flatpose::port {

class CpuLatencyRequest {
 public:
  CpuLatencyRequest() = default;
  ~CpuLatencyRequest();
  CpuLatencyRequest(const CpuLatencyRequest&) = delete;
  CpuLatencyRequest& operator=(const CpuLatencyRequest&) = delete;

  /// `root` stands before /dev: tests give a folder.  Fails: never, see the step.
  [[nodiscard]] Step request(std::int32_t latency_us, const std::string& root = {});

 private:
  int file_ = -1;
};

}  // namespace flatpose::port
