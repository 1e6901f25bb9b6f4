#include "bench/footprint/painted_stack.hpp"

#include <pthread.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

namespace flatpose::bench {
namespace {

constexpr std::byte kPaint{0xA5};
constexpr std::size_t kPageBytes = 4096;

struct Job {
  void (*run)(void*);
  void* context;
  const std::byte* top = nullptr;  ///< Where the stack stood when `run` was called.
};

void* run_job(void* context) {
  Job& job = *static_cast<Job*>(context);
  job.top = static_cast<const std::byte*>(__builtin_frame_address(0));
  job.run(job.context);
  return nullptr;
}

}  // namespace

std::size_t stack_taken_by(std::size_t stack_bytes, void (*run)(void* context), void* context) {
  std::vector<std::byte> memory(stack_bytes + kPageBytes, kPaint);
  const auto address = reinterpret_cast<std::uintptr_t>(memory.data());
  std::byte* const bottom = memory.data() + (kPageBytes - address % kPageBytes) % kPageBytes;
  Job job{run, context};
  pthread_attr_t attributes;
  pthread_t thread;
  if (pthread_attr_init(&attributes) != 0 ||
      pthread_attr_setstack(&attributes, bottom, stack_bytes) != 0 ||
      pthread_create(&thread, &attributes, run_job, &job) != 0 ||
      pthread_join(thread, nullptr) != 0)
    throw std::runtime_error("no thread on a stack of its own");
  pthread_attr_destroy(&attributes);
  const std::byte* const lowest =
      std::find_if(bottom, bottom + stack_bytes, [](std::byte b) { return b != kPaint; });
  return static_cast<std::size_t>(job.top - lowest);
}

}  // namespace flatpose::bench
