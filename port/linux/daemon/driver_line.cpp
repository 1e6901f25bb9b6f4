#include "port/linux/daemon/driver_line.hpp"

#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "port/linux/files/input_error.hpp"

namespace flatpose::daemon {
namespace {

constexpr std::int64_t kSecond_us = 1'000'000;

std::size_t bytes_of_kind(std::uint16_t kind) noexcept {
  switch (kind) {
    case FLATPOSE_CAMERA_KIND_HELLO: return sizeof(flatpose_camera_hello_message);
    case FLATPOSE_CAMERA_KIND_ALIVE: return sizeof(flatpose_camera_head);
    case FLATPOSE_CAMERA_KIND_DONE: return sizeof(flatpose_camera_done_message);
    case FLATPOSE_CAMERA_KIND_FAILED: return sizeof(flatpose_camera_reason_message);
    default: return 0;
  }
}

bool is_sound(const flatpose_camera_head& head, std::size_t bytes) noexcept {
  return bytes >= sizeof head && head.magic == FLATPOSE_CAMERA_MAGIC &&
         head.version == FLATPOSE_CAMERA_VERSION && head.size_bytes == bytes &&
         bytes_of_kind(head.kind) == bytes;
}

}  // namespace

Heard DriverLine::hear(DriverMessage& message, std::int64_t now_us) noexcept {
  const ssize_t got = recv(socket(), &message, sizeof message, MSG_DONTWAIT);
  if (got < 0 && (errno == EAGAIN || errno == EINTR)) return Heard::kNothing;
  if (got <= 0) return Heard::kClosed;
  if (!is_sound(message.head, static_cast<std::size_t>(got))) return Heard::kGarbage;
  heard_us_ = now_us;
  if (now_us - second_us_ >= kSecond_us) {
    second_us_ = now_us;
    count_ = 0;
  }
  return ++count_ > FLATPOSE_CAMERA_MESSAGES_PER_SECOND_MAX ? Heard::kFlood : Heard::kMessage;
}

bool DriverLine::say(const void* message, std::size_t bytes, int file) const noexcept {
  alignas(cmsghdr) char control[CMSG_SPACE(sizeof file)] = {};
  iovec part{const_cast<void*>(message), bytes};
  msghdr packet{};
  packet.msg_iov = &part;
  packet.msg_iovlen = 1;
  if (file >= 0) {
    packet.msg_control = control;
    packet.msg_controllen = sizeof control;
    cmsghdr* const with = CMSG_FIRSTHDR(&packet);
    with->cmsg_level = SOL_SOCKET;
    with->cmsg_type = SCM_RIGHTS;
    with->cmsg_len = CMSG_LEN(sizeof file);
    std::memcpy(CMSG_DATA(with), &file, sizeof file);
  }
  return sendmsg(socket(), &packet, MSG_DONTWAIT | MSG_NOSIGNAL) == static_cast<ssize_t>(bytes);
}

bool DriverLine::say_refused(std::string_view reason) const noexcept {
  flatpose_camera_reason_message refused{};
  refused.head = camera_head(FLATPOSE_CAMERA_KIND_REFUSED, sizeof refused, 0);
  reason.copy(refused.reason, sizeof refused.reason - 1);
  return say(&refused, sizeof refused);
}

flatpose_camera_head camera_head(flatpose_camera_kind kind, std::size_t bytes,
                                 std::uint32_t ticket) noexcept {
  return {FLATPOSE_CAMERA_MAGIC, FLATPOSE_CAMERA_VERSION, static_cast<std::uint16_t>(kind),
          static_cast<std::uint32_t>(bytes), ticket};
}

std::string camera_text(const char* text, std::size_t bytes) {
  const char* const end = std::find(text, text + bytes, '\0');
  return port::printable({text, static_cast<std::size_t>(end - text)}, bytes);
}

}  // namespace flatpose::daemon
