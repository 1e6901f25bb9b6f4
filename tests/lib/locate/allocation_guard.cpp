#include "tests/lib/locate/allocation_guard.hpp"

#include <atomic>
#include <cerrno>
#include <cstddef>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define FLATPOSE_SANITIZER_OWNS_MALLOC
#endif

#if defined(FLATPOSE_SANITIZER_OWNS_MALLOC)
// Of <sanitizer/allocator_interface.h>, which Debian's g++ does not bring.
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*on_malloc)(const volatile void*,
                                                                           std::size_t),
                                                         void (*on_free)(const volatile void*));
#endif

namespace {

std::atomic<long> allocation_count{0};

#if defined(FLATPOSE_SANITIZER_OWNS_MALLOC)
// The sanitizer owns malloc and new; it tells of each call.
void on_malloc(const volatile void*, std::size_t) { ++allocation_count; }
void on_free(const volatile void*) {}
const int hooks_installed = __sanitizer_install_malloc_and_free_hooks(on_malloc, on_free);
#endif

}  // namespace

#if !defined(FLATPOSE_SANITIZER_OWNS_MALLOC)
// glibc's own, which ours stand in front of. new and aligned new end up here too.
extern "C" {
void* __libc_malloc(std::size_t size_bytes);
void* __libc_calloc(std::size_t count, std::size_t size_bytes);
void* __libc_realloc(void* old, std::size_t size_bytes);
void* __libc_memalign(std::size_t alignment_bytes, std::size_t size_bytes);

void* malloc(std::size_t size_bytes) noexcept {
  ++allocation_count;
  return __libc_malloc(size_bytes);
}
void* calloc(std::size_t count, std::size_t size_bytes) noexcept {
  ++allocation_count;
  return __libc_calloc(count, size_bytes);
}
void* realloc(void* old, std::size_t size_bytes) noexcept {
  ++allocation_count;
  return __libc_realloc(old, size_bytes);
}
void* aligned_alloc(std::size_t alignment_bytes, std::size_t size_bytes) noexcept {
  ++allocation_count;
  return __libc_memalign(alignment_bytes, size_bytes);
}
int posix_memalign(void** out, std::size_t alignment_bytes, std::size_t size_bytes) noexcept {
  ++allocation_count;
  *out = __libc_memalign(alignment_bytes, size_bytes);
  return *out == nullptr ? ENOMEM : 0;
}
}
#endif

namespace flatpose::test {

long AllocationGuard::total() noexcept { return allocation_count.load(); }

}  // namespace flatpose::test
