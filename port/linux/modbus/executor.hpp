#pragma once
// libmodbus does what a request says, on the bank's own registers. It is given requests that were
// understood, so none of its exceptions, nor the pauses that come with them, is ever reached; it
// never sees a client's socket, but one end of a pair of our own.

#include <cstdint>
#include <memory>
#include <span>

#include "flatpose/modbus/server.hpp"
#include "port/linux/modbus/file_descriptor.hpp"

struct _modbus;

namespace flatpose::port {

class LibmodbusExecutor final : public modbus::Executor {
 public:
  /// Fails: std::system_error when the system gives no sockets.
  LibmodbusExecutor();

  /// Cost: two system calls.  Thread: one at a time.
  [[nodiscard]] std::size_t execute(std::span<const std::uint8_t> request, modbus::Bank& bank,
                                    std::span<std::uint8_t> response) noexcept override;

 private:
  struct Free {
    void operator()(_modbus* context) const noexcept;
  };

  std::unique_ptr<_modbus, Free> context_;
  FileDescriptor its_end_;
  FileDescriptor our_end_;
};

}  // namespace flatpose::port
