#pragma once
// Memory that another process writes and this one reads: a memfd of fixed size, sealed, so that
// nobody can cut it short under a reader.

#include <cstddef>
#include <span>

#include "port/linux/modbus/file_descriptor.hpp"

namespace flatpose::daemon {

class SealedMemory {
 public:
  SealedMemory() = default;
  /// All of it is there from the start.  Fails: std::system_error.
  explicit SealedMemory(std::size_t size_bytes);
  ~SealedMemory();
  SealedMemory(SealedMemory&& other) noexcept { *this = std::move(other); }
  SealedMemory& operator=(SealedMemory&& other) noexcept;

  /// What the other process is handed; it may map it to be written.
  [[nodiscard]] int file() const noexcept { return file_.get(); }
  /// May change at any time: what is read twice may differ.
  [[nodiscard]] std::span<const std::byte> bytes() const noexcept { return {bytes_, size_bytes_}; }

 private:
  port::FileDescriptor file_;
  const std::byte* bytes_ = nullptr;
  std::size_t size_bytes_ = 0;
};

}  // namespace flatpose::daemon
