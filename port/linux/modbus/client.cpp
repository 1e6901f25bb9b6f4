#include "port/linux/modbus/client.hpp"

#include <sys/socket.h>

#include <cerrno>

namespace flatpose::port {
namespace {

bool is_only_later(int error) noexcept {
  return error == EAGAIN || error == EWOULDBLOCK || error == EINTR;
}

}  // namespace

bool Client::go_on(std::int64_t now_us, const ClientLimits& limits, Responder& responder) noexcept {
  if (is_sending()) {
    if (!send()) return false;
    if (is_sending()) return true;
    deadline_us_ = kNever_us;
  }
  if (!receive()) return false;
  // A buffer holds this many frames at most.
  constexpr int kFramesMax = modbus::kAduBytesMax / modbus::kHeaderBytes + 1;
  for (int i = 0; i < kFramesMax; ++i) {
    modbus::Adu adu;
    const auto step = reader_.next(adu);
    if (step == modbus::AduReader::Step::kClose) return false;
    if (step == modbus::AduReader::Step::kNeedsMore) break;
    has_sent_a_frame_ = true;
    heard_us_ = now_us;
    deadline_us_ = kNever_us;
    response_bytes_ = responder.respond(master_, adu, response_);
    sent_bytes_ = 0;
    if (response_bytes_ == 0 || !send()) return false;
    if (!is_sending()) continue;
    deadline_us_ = now_us + limits.send_us;
    return true;
  }
  if (!reader_.is_inside_frame()) {
    deadline_us_ = kNever_us;
  } else if (deadline_us_ == kNever_us) {
    deadline_us_ = now_us + limits.frame_us;
  }
  return true;
}

bool Client::receive() noexcept {
  const auto room = reader_.room();
  if (room.empty()) return true;  // whole frames wait in it
  const ssize_t size = recv(socket_.get(), room.data(), room.size(), 0);
  if (size < 0) return is_only_later(errno);
  reader_.filled(static_cast<std::size_t>(size));
  return size > 0;
}

bool Client::send() noexcept {
  const auto rest = std::span(response_).first(response_bytes_).subspan(sent_bytes_);
  const ssize_t size = ::send(socket_.get(), rest.data(), rest.size(), MSG_NOSIGNAL);
  if (size < 0) return is_only_later(errno);
  sent_bytes_ += static_cast<std::size_t>(size);
  return true;
}

}  // namespace flatpose::port
