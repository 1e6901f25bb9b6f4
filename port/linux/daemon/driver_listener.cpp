#include "port/linux/daemon/driver_listener.hpp"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "port/linux/files/input_error.hpp"

namespace flatpose::daemon {
namespace {

constexpr int kBacklog = 8;
constexpr mode_t kMode = 0660;

port::FileDescriptor new_socket() {
  return port::FileDescriptor(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
}

/// Whether somebody answers there.
bool is_served(const sockaddr_un& name) {
  const port::FileDescriptor probe = new_socket();
  return connect(probe.get(), reinterpret_cast<const sockaddr*>(&name), sizeof name) == 0 ||
         errno == EAGAIN;  // served, and its backlog is full
}

std::string remedy_for(int error) {
  if (error == ENOENT) return "make the folder, or name another (RuntimeDirectory= of the unit)";
  if (error == EACCES || error == EPERM || error == EROFS)
    return "name a folder that the daemon's user may write to";
  return "name another path";
}

}  // namespace

DriverListener::DriverListener(const std::string& place, const std::string& path) : path_(path) {
  const std::string what = "cannot listen on " + path + ": ";
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  if (path.size() >= sizeof name.sun_path)
    throw port::InputError(place, what + "the path is longer than 107 bytes", "shorten it");
  path.copy(name.sun_path, path.size());
  struct stat found {};
  if (lstat(path.c_str(), &found) == 0) {
    if (!S_ISSOCK(found.st_mode))
      throw port::InputError(place, what + "there is a file that is no socket",
                             "name another path or take the file away");
    if (is_served(name))
      throw port::InputError(place, what + "another process listens there",
                             "end it (another flatposed?), or name another path");
    ::unlink(path.c_str());
  }
  socket_ = new_socket();
  const bool is_bound =
      socket_.is_open() &&
      bind(socket(), reinterpret_cast<const sockaddr*>(&name), sizeof name) == 0 &&
      chmod(path.c_str(), kMode) == 0 && listen(socket(), kBacklog) == 0 &&
      lstat(path.c_str(), &found) == 0;
  if (!is_bound) throw port::InputError(place, what + std::strerror(errno), remedy_for(errno));
  device_ = found.st_dev;
  inode_ = found.st_ino;
}

DriverListener::~DriverListener() {
  struct stat found {};
  const bool is_ours =
      lstat(path_.c_str(), &found) == 0 && found.st_dev == device_ && found.st_ino == inode_;
  if (is_ours) ::unlink(path_.c_str());
}

port::FileDescriptor DriverListener::accept() const noexcept {
  return port::FileDescriptor(accept4(socket(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
}

}  // namespace flatpose::daemon
