#pragma once
// What happens in a folder, by inotify, in the order in which it happens. A mark is put into that
// same order by whoever wants to know what came after it, and is read with the rest: so it does not
// matter how late the rest is read.
//
// inotify tells what this machine does: files that another one writes to a shared folder are not
// seen.

#include <sys/types.h>

#include <array>
#include <cstdint>
#include <string>

#include "port/linux/daemon/arrivals.hpp"
#include "port/linux/modbus/file_descriptor.hpp"

namespace flatpose::daemon {

class FolderWatch {
 public:
  using Mark = int;
  static constexpr Mark kNoMark = -1;

  /// Fails: std::system_error.
  explicit FolderWatch(std::string path);

  /// Readable when something happened.
  [[nodiscard]] int file() const noexcept { return inotify_.get(); }
  /// Any thread but the reader's.  Cost: two system calls.  Fails: kNoMark.
  [[nodiscard]] Mark mark() const noexcept;

  // The reader's thread.

  /// Goes back to the folder when it is not, or no longer, the one that is watched. Returns whether
  /// it is watched.
  bool attach() noexcept;
  [[nodiscard]] bool is_attached() const noexcept { return folder_ >= 0; }
  /// Takes in what has happened.  Memory: the names'.
  void read(Arrivals& arrivals, std::int64_t now_us);
  /// Whether what is fresh among the arrivals came after the mark: it, or a later one, was read.
  [[nodiscard]] bool has_passed(Mark mark) const noexcept;
  /// Whether events were lost since this was asked.
  [[nodiscard]] bool has_overflown() noexcept;

 private:
  struct Event;
  void take(const Event& event, Arrivals& arrivals, std::int64_t now_us);
  void detach() noexcept;
  [[nodiscard]] Mark mark_by(const char* path) const noexcept;
  [[nodiscard]] bool is_still_there() const noexcept;

  const std::string path_;
  port::FileDescriptor inotify_;
  int folder_ = -1;
  dev_t device_ = 0;
  ino_t inode_ = 0;
  Mark passed_ = kNoMark;
  bool has_overflown_ = false;
  alignas(8) std::array<char, 16384> buffer_{};
};

}  // namespace flatpose::daemon
