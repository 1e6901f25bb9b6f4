#include "port/linux/realtime/memory.hpp"

#include <malloc.h>
#include <pthread.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <new>

namespace flatpose::port {
namespace {

void set_stack_size() noexcept {
  pthread_attr_t attributes;
  if (pthread_attr_init(&attributes) != 0) return;
  if (pthread_attr_setstacksize(&attributes, kStackOfThread_bytes) == 0)
    pthread_setattr_default_np(&attributes);
  pthread_attr_destroy(&attributes);
}

}  // namespace

PrefaultedMemory::PrefaultedMemory(std::size_t size_bytes) : size_bytes_(size_bytes) {
  if (size_bytes == 0) return;
  void* const address =
      mmap(nullptr, size_bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (address == MAP_FAILED) throw std::bad_alloc();
  bytes_ = static_cast<std::byte*>(address);
  const auto page_bytes = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  volatile std::byte* const touched = bytes_;
  for (std::size_t i = 0; i < size_bytes; i += page_bytes) touched[i] = std::byte{0};
}

PrefaultedMemory::~PrefaultedMemory() {
  if (bytes_ != nullptr) munmap(bytes_, size_bytes_);
}

Step lock_all_memory() {
  const std::string what = "memory: locked";
  if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    return {false, what, std::strerror(errno),
            "needs CAP_IPC_LOCK or a limit: LimitMEMLOCK=infinity in the unit, or memlock in "
            "/etc/security/limits.d"};
  }
  mallopt(M_TRIM_THRESHOLD, -1);
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_ARENA_MAX, 1);  // each further one would lock the 64 MB that it reserves
  set_stack_size();
  return {true, what, {}, {}};
}

}  // namespace flatpose::port
