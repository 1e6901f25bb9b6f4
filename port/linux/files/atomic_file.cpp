#include "port/linux/files/atomic_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <system_error>
#include <utility>

#include "port/linux/files/input_error.hpp"

namespace flatpose::port {
namespace {

constexpr std::size_t kReadStepBytesMin = 64 * 1024;
constexpr int kTemporaryNamesMax = 100;

std::string reason(int error) { return std::generic_category().message(error); }

// Closes on every way out.
class Descriptor {
 public:
  explicit Descriptor(int fd) noexcept : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  [[nodiscard]] int get() const noexcept { return fd_; }

 private:
  int fd_;
};

const char* kind_of(mode_t mode) {
  if (S_ISDIR(mode)) return "it is a folder";
  if (S_ISFIFO(mode)) return "it is a pipe";
  if (S_ISSOCK(mode)) return "it is a socket";
  return "it is a device";
}

[[noreturn]] void fail_reading(const std::string& path, int error) {
  throw InputError(path, "cannot read it: " + reason(error),
                   error == ENOENT   ? "check the name"
                   : error == EACCES ? "ask its owner for the right to read it"
                                     : "check the path and the disk");
}

[[noreturn]] void fail_writing(const std::string& path, int error) {
  const char* remedy = "check the path and the disk";
  if (error == ENOENT || error == ENOTDIR) remedy = "create the folder first or name another";
  if (error == EACCES || error == EPERM || error == EROFS)
    remedy = "name a folder that you may write to";
  if (error == ENOSPC || error == EDQUOT || error == EFBIG)
    remedy = "make room on the disk or name another";
  if (error == ENAMETOOLONG) remedy = "give it a shorter name";
  throw InputError(path, "cannot write it: " + reason(error), remedy);
}

// The number of bytes read, 0 at the end of the file.
std::size_t read_some(const std::string& path, int fd, std::span<std::byte> room) {
  while (true) {
    const ssize_t count = ::read(fd, room.data(), room.size());
    if (count >= 0) return static_cast<std::size_t>(count);
    if (errno != EINTR) fail_reading(path, errno);
  }
}

void write_all(const std::string& path, int fd, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(fd, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail_writing(path, errno);
    if (count == 0) fail_writing(path, ENOSPC);
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
}

// The file behind a link, so that the rename replaces it and not the link.
std::string resolved(const std::string& path) {
  char* real = ::realpath(path.c_str(), nullptr);
  if (real == nullptr) return path;
  std::string target(real);
  std::free(real);  // NOLINT: realpath gives malloc's memory
  return target;
}

std::string folder_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  return slash == std::string::npos ? "." : path.substr(0, slash + 1);
}

// A file of its own beside the target; it vanishes unless it was renamed.
class TemporaryFile {
 public:
  TemporaryFile(const std::string& path, const std::string& folder) {
    static std::atomic<unsigned> counter{0};
    for (int i = 0; i < kTemporaryNamesMax && fd_ < 0; ++i) {
      name_ = folder + "/.flatpose-" + std::to_string(::getpid()) + "-" +
              std::to_string(counter.fetch_add(1)) + ".tmp";
      fd_ = ::open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      if (fd_ < 0 && errno != EEXIST) fail_writing(path, errno);
    }
    if (fd_ < 0) fail_writing(path, EEXIST);
  }
  ~TemporaryFile() {
    if (fd_ >= 0) ::close(fd_);
    if (!name_.empty()) ::unlink(name_.c_str());
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  [[nodiscard]] int fd() const noexcept { return fd_; }
  void rename_to(const std::string& path, const std::string& target) {
    if (::fsync(fd_) != 0 && errno != EINVAL) fail_writing(path, errno);
    if (::close(std::exchange(fd_, -1)) != 0) fail_writing(path, errno);
    if (::rename(name_.c_str(), target.c_str()) != 0) fail_writing(path, errno);
    name_.clear();
  }

 private:
  std::string name_;
  int fd_ = -1;
};

}  // namespace

std::vector<std::byte> read_file(const std::string& path, std::int64_t bytes_max) {
  // Without O_NONBLOCK a pipe that nobody writes to would hang in open().
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
  if (file.get() < 0) fail_reading(path, errno);
  struct stat info {};
  if (::fstat(file.get(), &info) != 0) fail_reading(path, errno);
  if (!S_ISREG(info.st_mode)) throw InputError(path, kind_of(info.st_mode), "name a regular file");
  const auto too_long = [&](const std::string& length) {
    return InputError(path, length + " are more than the " + std::to_string(bytes_max) + " allowed",
                      "check that it is the right file or make it smaller");
  };
  if (info.st_size > bytes_max) throw too_long(std::to_string(info.st_size) + " bytes");

  // One byte more than it says it has, so that the end is seen without growing.
  std::vector<std::byte> bytes(static_cast<std::size_t>(info.st_size) + 1);
  std::size_t used_bytes = 0;
  while (true) {
    const std::size_t count = read_some(path, file.get(), std::span(bytes).subspan(used_bytes));
    if (count == 0) break;
    used_bytes += count;
    if (std::cmp_greater(used_bytes, bytes_max)) throw too_long("its bytes");
    if (used_bytes == bytes.size()) bytes.resize(bytes.size() * 2 + kReadStepBytesMin);
  }
  bytes.resize(used_bytes);
  return bytes;
}

void write_file_atomically(const std::string& path, std::span<const std::byte> bytes,
                           NewName name) {
  if (path.empty()) throw InputError("output", "its name is empty", "name a file");
  const std::string target = resolved(path);
  if (target.back() == '/') throw InputError(path, "it is a folder", "name a file in it");
  struct stat info {};
  const bool exists = ::stat(target.c_str(), &info) == 0;
  // Renaming onto a device would replace the device.
  if (exists && !S_ISREG(info.st_mode))
    throw InputError(path, kind_of(info.st_mode), "name a regular file");
  if (exists && ::faccessat(AT_FDCWD, target.c_str(), W_OK, AT_EACCESS) != 0)
    fail_writing(path, errno);

  const std::string folder = folder_of(target);
  TemporaryFile temporary(path, folder);
  write_all(path, temporary.fd(), bytes);
  if (exists && ::fchmod(temporary.fd(), info.st_mode & 07777) != 0) fail_writing(path, errno);
  temporary.rename_to(path, target);
  if (name == NewName::kMayBeLost) return;
  // A folder that cannot be synced is no failure.
  const Descriptor parent(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (parent.get() >= 0) ::fsync(parent.get());
}

void write_file_atomically(const std::string& path, std::string_view text, NewName name) {
  write_file_atomically(path, std::as_bytes(std::span(text.data(), text.size())), name);
}

}  // namespace flatpose::port
