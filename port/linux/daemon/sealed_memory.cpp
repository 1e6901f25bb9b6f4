#include "port/linux/daemon/sealed_memory.hpp"

#include <fcntl.h>
#include <sys/mman.h>

#include <cerrno>
#include <system_error>
#include <utility>

namespace flatpose::daemon {

SealedMemory::SealedMemory(std::size_t size_bytes)
    : file_(memfd_create("flatpose scan", MFD_CLOEXEC | MFD_ALLOW_SEALING)),
      size_bytes_(size_bytes) {
  const auto fail = [] { throw std::system_error(errno, std::generic_category(), "memfd"); };
  const auto size = static_cast<off_t>(size_bytes);
  if (!file_.is_open() || ftruncate(file(), size) != 0) fail();
  if (fallocate(file(), 0, 0, size) != 0) fail();
  if (fcntl(file(), F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) != 0) fail();
  void* const at = mmap(nullptr, size_bytes, PROT_READ, MAP_SHARED | MAP_POPULATE, file(), 0);
  if (at == MAP_FAILED) fail();
  bytes_ = static_cast<const std::byte*>(at);
}

SealedMemory::~SealedMemory() {
  if (bytes_ != nullptr) munmap(const_cast<std::byte*>(bytes_), size_bytes_);
}

SealedMemory& SealedMemory::operator=(SealedMemory&& other) noexcept {
  std::swap(file_, other.file_);
  std::swap(bytes_, other.bytes_);
  std::swap(size_bytes_, other.size_bytes_);
  return *this;
}

}  // namespace flatpose::daemon
