#include "port/linux/realtime/background_thread.hpp"

#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace flatpose::port {
namespace {

constexpr int kNicest = 19;

Step keep_off(const std::vector<int>& cpus, const std::string& name) {
  Step step{true, name + ": not on the search's CPUs", {}, {}};
  cpu_set_t set;
  CPU_ZERO(&set);
  int error = sched_getaffinity(0, sizeof set, &set) == 0 ? 0 : errno;
  for (const int cpu : cpus)
    if (cpu >= 0 && cpu < CPU_SETSIZE) CPU_CLR(static_cast<unsigned>(cpu), &set);
  if (error == 0) error = pthread_setaffinity_np(pthread_self(), sizeof set, &set);
  if (error == 0) return step;
  return {false, step.what, std::strerror(error), "leave a CPU to all that is no search"};
}

// In Linux a thread has a nice value of its own.
Step be_nice(const std::string& name) {
  const auto thread = static_cast<id_t>(gettid());
  const bool is_done = setpriority(PRIO_PROCESS, thread, kNicest) == 0;
  return {is_done, name + ": nice " + std::to_string(kNicest), is_done ? "" : std::strerror(errno),
          is_done ? "" : "let the unit allow setpriority"};
}

}  // namespace

Steps set_up_background_thread(const RealtimeConfig& config, const std::string& name) {
  Steps steps;
  pthread_setname_np(pthread_self(), name.substr(0, 15).c_str());
  steps.push_back(be_nice(name));
  if (!config.cpus.empty()) steps.push_back(keep_off(config.cpus, name));
  return steps;
}

}  // namespace flatpose::port
