#pragma once
// Lines for the log, whole, from any thread but the bus's, which must not wait for whoever reads
// it.

#include <mutex>
#include <ostream>
#include <string>

#include "port/linux/files/input_error.hpp"

namespace flatpose::daemon {

class Log {
 public:
  explicit Log(std::ostream& out) noexcept : out_(out) {}

  void line(const std::string& text) {
    const std::string whole = "flatposed: " + port::printable(text, kLineBytesMax) + "\n";
    const std::lock_guard lock(mutex_);
    out_ << whole << std::flush;
  }

 private:
  static constexpr std::size_t kLineBytesMax = 1000;

  std::ostream& out_;
  std::mutex mutex_;
};

}  // namespace flatpose::daemon
