#include "port/linux/realtime/thread_setup.hpp"

#include <pthread.h>
#include <sched.h>
#include <sys/prctl.h>

#include <cerrno>
#include <cstring>

namespace flatpose::port {
namespace {

Step step_of(int error, std::string what, const std::string& remedy) {
  if (error == 0) return {true, std::move(what), {}, {}};
  return {false, std::move(what), std::strerror(error), remedy};
}

Step pin(int cpu, const std::string& name) {
  const std::string what = name + ": on CPU " + std::to_string(cpu);
  const std::string remedy = "give a CPU that is online and that this process may use";
  if (cpu < 0 || cpu >= CPU_SETSIZE) return step_of(EINVAL, what, remedy);
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(static_cast<unsigned>(cpu), &set);
  return step_of(pthread_setaffinity_np(pthread_self(), sizeof set, &set), what, remedy);
}

Step set_priority(int priority, const std::string& name) {
  sched_param param{};
  param.sched_priority = priority;
  const std::string number = std::to_string(priority);
  return step_of(pthread_setschedparam(pthread_self(), SCHED_FIFO, &param),
                 name + ": SCHED_FIFO " + number,
                 "needs CAP_SYS_NICE or a limit: LimitRTPRIO=" + number +
                     " in the unit, or rtprio in /etc/security/limits.d");
}

Step set_timer_slack(std::int64_t slack_ns, const std::string& name) {
  // 0 would mean the system's own; a nanosecond is as good as none.
  const auto value = static_cast<unsigned long>(slack_ns < 1 ? 1 : slack_ns);
  return step_of(prctl(PR_SET_TIMERSLACK, value) == 0 ? 0 : errno,
                 name + ": timer slack " + std::to_string(value) + " ns", "take the line out");
}

[[gnu::noinline]] void touch_stack() noexcept {
  volatile char bytes[kStackTouched_bytes];
  for (std::size_t i = 0; i < sizeof bytes; i += 1024) bytes[i] = 0;
}

}  // namespace

Steps set_up_this_thread(const RealtimeConfig& config, int index, const std::string& name) {
  Steps steps;
  pthread_setname_np(pthread_self(), name.substr(0, 15).c_str());
  if (!config.cpus.empty())
    steps.push_back(pin(config.cpus[static_cast<std::size_t>(index) % config.cpus.size()], name));
  if (config.lock_memory) touch_stack();
  if (config.timer_slack_ns) steps.push_back(set_timer_slack(*config.timer_slack_ns, name));
  if (config.priority > 0) steps.push_back(set_priority(config.priority, name));
  return steps;
}

}  // namespace flatpose::port
