// Built without sanitizers, which turn mlockall into nothing: locks its memory as the daemon does,
// then touches arena, heap and a new thread's stack, and counts page faults. Exit code 0: none, and
// the kernel says that memory is locked; 77: this process may not lock memory, and was told so.

#include <sys/resource.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>

#include "port/linux/realtime/memory.hpp"
#include "port/linux/realtime/thread_setup.hpp"

namespace {

constexpr std::size_t kArena_bytes = 3 << 20;
constexpr std::size_t kHeap_bytes = 1 << 20;

long faults() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_minflt + usage.ru_majflt;
}

void touch(volatile char* bytes, std::size_t size_bytes) {
  for (std::size_t i = 0; i < size_bytes; i += 512) bytes[i] = 1;
}

[[gnu::noinline]] void use_stack() {
  volatile char bytes[flatpose::port::kStackTouched_bytes - 64 * 1024];
  touch(bytes, sizeof bytes);
}

long locked_kb() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmLck:")) return std::atol(line.c_str() + 6);
  return -1;
}

}  // namespace

int main() {
  using namespace flatpose::port;
  PrefaultedMemory arena(kArena_bytes);
  std::free(std::malloc(kHeap_bytes));  // the heap as a daemon's that has loaded something
  const Step lock = lock_all_memory();
  std::printf("%s\n", line_of(lock).c_str());
  if (!lock.is_done) return lock.remedy.find("LimitMEMLOCK") == std::string::npos ? 1 : 77;
  if (locked_kb() * 1024 < static_cast<long>(kArena_bytes)) return 2;
  void* const once = std::malloc(kHeap_bytes);
  touch(static_cast<volatile char*>(once), kHeap_bytes);
  std::free(once);
  long counted = -1;
  std::thread([&] {
    RealtimeConfig config;
    config.lock_memory = true;
    const Steps steps = set_up_this_thread(config, 0, "probe");
    const long before = faults();
    use_stack();
    touch(reinterpret_cast<volatile char*>(arena.span().data()), kArena_bytes);
    counted = faults() - before;
  }).join();
  const long before = faults();
  void* const again = std::malloc(kHeap_bytes);
  touch(static_cast<volatile char*>(again), kHeap_bytes);
  const long heap = faults() - before;
  std::free(again);
  std::printf("page faults: %ld in arena and stack, %ld in memory of the heap used before\n",
              counted, heap);
  return counted == 0 && heap == 0 ? 0 : 3;
}
