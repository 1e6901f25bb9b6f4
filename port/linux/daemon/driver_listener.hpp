#pragma once
// The Unix socket that a camera driver connects to. Its file is made at the start and removed at
// the end; one that a dead daemon left is replaced, one that a living one answers at is not.

#include <sys/types.h>

#include <string>

#include "port/linux/modbus/file_descriptor.hpp"

namespace flatpose::daemon {

class DriverListener {
 public:
  /// For the owner and his group; `place` is where the config names it, for messages.
  /// Fails: port::InputError.
  DriverListener(const std::string& place, const std::string& path);
  ~DriverListener();
  DriverListener(const DriverListener&) = delete;
  DriverListener& operator=(const DriverListener&) = delete;

  [[nodiscard]] int socket() const noexcept { return socket_.get(); }
  /// A connection, not open when there is none.
  [[nodiscard]] port::FileDescriptor accept() const noexcept;

 private:
  const std::string path_;
  port::FileDescriptor socket_;
  dev_t device_ = 0;
  ino_t inode_ = 0;
};

}  // namespace flatpose::daemon
