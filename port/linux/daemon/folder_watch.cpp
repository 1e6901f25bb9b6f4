#include "port/linux/daemon/folder_watch.hpp"

#include <sys/inotify.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

namespace flatpose::daemon {
namespace {

constexpr std::uint32_t kFolderEvents = IN_CREATE | IN_CLOSE_WRITE | IN_MOVED_FROM | IN_MOVED_TO |
                                        IN_DELETE | IN_DELETE_SELF | IN_MOVE_SELF | IN_ONLYDIR;
constexpr std::uint32_t kEndsOfFolder = IN_DELETE_SELF | IN_MOVE_SELF | IN_UNMOUNT | IN_IGNORED;
/// Files that are always there; what they are watched for never happens.
constexpr const char* kAnyFile = "/dev/null";
constexpr const char* kAnotherFile = "/dev/zero";
constexpr int kReadsPerTurn = 64;

}  // namespace

struct FolderWatch::Event {
  int watch;
  std::uint32_t mask;
  std::uint32_t cookie;
  std::string name;
};

FolderWatch::FolderWatch(std::string path)
    : path_(std::move(path)), inotify_(inotify_init1(IN_NONBLOCK | IN_CLOEXEC)) {
  if (!inotify_.is_open()) throw std::system_error(errno, std::generic_category(), "inotify");
}

// A watch that is taken away again leaves a word in the queue. Their numbers count up.
FolderWatch::Mark FolderWatch::mark_by(const char* path) const noexcept {
  const int made = inotify_add_watch(file(), path, IN_DELETE_SELF);
  if (made < 0 || inotify_rm_watch(file(), made) != 0) return kNoMark;
  return made;
}

FolderWatch::Mark FolderWatch::mark() const noexcept { return mark_by(kAnyFile); }

bool FolderWatch::is_still_there() const noexcept {
  struct stat found {};
  return stat(path_.c_str(), &found) == 0 && found.st_dev == device_ && found.st_ino == inode_;
}

bool FolderWatch::attach() noexcept {
  if (is_attached() && is_still_there()) return true;
  detach();
  struct stat found {};
  if (stat(path_.c_str(), &found) != 0) return false;
  device_ = found.st_dev;
  inode_ = found.st_ino;
  folder_ = inotify_add_watch(file(), path_.c_str(), kFolderEvents);
  if (is_attached() && !is_still_there()) detach();
  return is_attached();
}

void FolderWatch::detach() noexcept {
  if (is_attached()) (void)inotify_rm_watch(file(), std::exchange(folder_, -1));
}

void FolderWatch::read(Arrivals& arrivals, std::int64_t now_us) {
  for (int i = 0; i < kReadsPerTurn; ++i) {
    const ssize_t size = ::read(file(), buffer_.data(), buffer_.size());
    if (size <= 0) return;
    for (ssize_t at = 0; at < size;) {
      inotify_event head;
      std::memcpy(&head, buffer_.data() + at, sizeof head);
      const char* const name = buffer_.data() + at + sizeof head;
      take({head.wd, head.mask, head.cookie, std::string(name, strnlen(name, head.len))}, arrivals,
           now_us);
      at += static_cast<ssize_t>(sizeof head + head.len);
    }
  }
}

void FolderWatch::take(const Event& event, Arrivals& arrivals, std::int64_t now_us) {
  if ((event.mask & IN_Q_OVERFLOW) != 0) {
    has_overflown_ = true;
    arrivals.forget();
    (void)mark_by(kAnotherFile);  // in the place of those that were lost
    return;
  }
  if (event.watch != folder_) {
    if ((event.mask & IN_IGNORED) == 0) return;  // of a folder of before
    if (!has_passed(event.watch)) passed_ = event.watch;
    return arrivals.mark();
  }
  if ((event.mask & kEndsOfFolder) != 0) {
    detach();
    arrivals.forget();
    return arrivals.mark();
  }
  if ((event.mask & IN_ISDIR) != 0) return;
  if ((event.mask & IN_CREATE) != 0) arrivals.created(event.name, now_us);
  if ((event.mask & IN_CLOSE_WRITE) != 0) arrivals.closed(event.name);
  if ((event.mask & IN_MOVED_FROM) != 0) arrivals.moved_out(event.name, event.cookie);
  if ((event.mask & IN_MOVED_TO) != 0) arrivals.moved_in(event.name, event.cookie, now_us);
  if ((event.mask & IN_DELETE) != 0) arrivals.removed(event.name);
}

// In numbers that wrap.
bool FolderWatch::has_passed(Mark mark) const noexcept {
  const std::uint32_t ahead =
      static_cast<std::uint32_t>(passed_) - static_cast<std::uint32_t>(mark);
  return passed_ != kNoMark && static_cast<std::int32_t>(ahead) >= 0;
}

bool FolderWatch::has_overflown() noexcept { return std::exchange(has_overflown_, false); }

}  // namespace flatpose::daemon
