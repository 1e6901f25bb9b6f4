#pragma once
// An eventfd: what a thread waits at together with sockets, and any other thread rings.

#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <system_error>

#include "port/linux/modbus/file_descriptor.hpp"

namespace flatpose::daemon {

inline void ring_event(int file) noexcept {
  const std::uint64_t once = 1;
  (void)!::write(file, &once, sizeof once);
}

/// However often it was rung.
inline void clear_event(int file) noexcept {
  std::uint64_t times = 0;
  (void)!::read(file, &times, sizeof times);
}

class EventFile {
 public:
  /// Fails: std::system_error.
  EventFile() : file_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
    if (!file_.is_open()) throw std::system_error(errno, std::generic_category(), "eventfd");
  }

  [[nodiscard]] int get() const noexcept { return file_.get(); }
  void ring() const noexcept { ring_event(get()); }
  void clear() const noexcept { clear_event(get()); }

 private:
  port::FileDescriptor file_;
};

}  // namespace flatpose::daemon
