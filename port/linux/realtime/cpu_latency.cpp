#include "port/linux/realtime/cpu_latency.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace flatpose::port {

CpuLatencyRequest::~CpuLatencyRequest() {
  if (file_ >= 0) close(file_);
}

Step CpuLatencyRequest::request(std::int32_t latency_us, const std::string& root) {
  const std::string path = "/dev/cpu_dma_latency";
  const std::string what = "processors: awake within " + std::to_string(latency_us) + " us";
  if (file_ < 0) file_ = open((root + path).c_str(), O_WRONLY | O_CLOEXEC);
  if (file_ < 0)
    return {false, what, path + ": " + std::strerror(errno),
            "let the daemon's user write " + path + " by a udev rule"};
  if (write(file_, &latency_us, sizeof latency_us) != sizeof latency_us)
    return {false, what, path + ": " + std::strerror(errno), "take the line out"};
  return {true, what, {}, {}};
}

}  // namespace flatpose::port
