#include "port/linux/realtime/process_setup.hpp"

#include "port/linux/realtime/memory.hpp"

namespace flatpose::port {

ProcessSetup::ProcessSetup(const RealtimeConfig& config, const std::string& root) {
  if (config.lock_memory) steps_.push_back(lock_all_memory());
  if (config.cpu_latency_us) steps_.push_back(latency_.request(*config.cpu_latency_us, root));
}

}  // namespace flatpose::port
