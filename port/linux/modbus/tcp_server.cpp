#include "port/linux/modbus/tcp_server.hpp"

#include <sys/epoll.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

namespace flatpose::port {
namespace {

constexpr int kListenerSlot = kClientCountMax;
constexpr int kWakeSlot = kClientCountMax + 1;
constexpr int kEventsMax = kClientCountMax + 2;
constexpr int kNewcomersPerTurn = 16;
constexpr std::int64_t kUsPerMs = 1000;

}  // namespace

TcpServer::TcpServer(const std::string& subject, const std::string& address, int port, int wake,
                     AllowList allowed, const ClientLimits& limits)
    : listener_(listen_on(subject, address, port)),
      epoll_(epoll_create1(EPOLL_CLOEXEC)),
      wake_(wake),
      allowed_(std::move(allowed)),
      limits_(limits) {
  const bool is_ready = epoll_.is_open() &&
                        watch(EPOLL_CTL_ADD, listener_.socket.get(), EPOLLIN, kListenerSlot) &&
                        (wake_ < 0 || watch(EPOLL_CTL_ADD, wake_, EPOLLIN, kWakeSlot));
  if (!is_ready) throw std::system_error(errno, std::generic_category(), "epoll");
}

std::string TcpServer::name() const {
  return listener_.address + ":" + std::to_string(listener_.port);
}

bool TcpServer::watch(int operation, int socket, std::uint32_t events, int slot) noexcept {
  epoll_event event{};
  event.events = events;
  event.data.u32 = static_cast<std::uint32_t>(slot);
  return epoll_ctl(epoll_.get(), operation, socket, &event) == 0;
}

void TcpServer::wait(std::int64_t time_us) noexcept {
  std::array<epoll_event, kEventsMax> events{};
  const std::int64_t time_ms = (std::max<std::int64_t>(time_us, 0) + kUsPerMs - 1) / kUsPerMs;
  const int timeout_ms = static_cast<int>(std::min<std::int64_t>(time_ms, 3'600'000));
  const int count = epoll_wait(epoll_.get(), events.data(), kEventsMax, timeout_ms);
  for (int i = 0; i < count; ++i) {
    const auto slot = static_cast<int>(events[static_cast<std::size_t>(i)].data.u32);
    if (slot == kListenerSlot) {
      has_newcomers_ = true;
    } else if (slot == kWakeSlot) {
      std::uint64_t times = 0;
      (void)!::read(wake_, &times, sizeof times);
    } else {
      is_due_[static_cast<std::size_t>(slot)] = true;
    }
  }
}

void TcpServer::serve(std::int64_t now_us, Responder& responder) noexcept {
  for (int i = 0; i < kClientCountMax; ++i) {
    if (std::exchange(is_due_[i], false) && clients_[i]) serve_client(i, now_us, responder);
  }
  close_slow(now_us);
  if (std::exchange(has_newcomers_, false)) let_in(now_us, responder);
}

void TcpServer::serve_client(int index, std::int64_t now_us, Responder& responder) noexcept {
  Client& client = *clients_[index];
  if (!client.go_on(now_us, limits_, responder)) {
    clients_[index].reset();  // closing takes it out of the set
    return;
  }
  if (client.is_sending() == is_watched_for_room_[index]) return;
  is_watched_for_room_[index] = client.is_sending();
  const std::uint32_t events = client.is_sending() ? EPOLLOUT : EPOLLIN;
  if (!watch(EPOLL_CTL_MOD, client.socket(), events, index)) clients_[index].reset();
}

void TcpServer::close_slow(std::int64_t now_us) noexcept {
  for (std::optional<Client>& client : clients_) {
    if (client && client->deadline_us() <= now_us) client.reset();
  }
}

void TcpServer::let_in(std::int64_t now_us, const Responder& responder) noexcept {
  for (int i = 0; i < kNewcomersPerTurn; ++i) {
    job::Address peer = job::kNobody;
    FileDescriptor socket = accept_from(listener_.socket.get(), peer);
    if (!socket.is_open()) return;
    if (!allowed_.admits(peer)) continue;
    const int index = choose_seat(now_us, responder);
    if (index >= 0) seat(index, std::move(socket), {peer, ++connection_count_}, now_us);
  }
}

void TcpServer::seat(int index, FileDescriptor socket, const job::Master& master,
                     std::int64_t now_us) noexcept {
  clients_[index].reset();
  is_watched_for_room_[index] = false;
  if (watch(EPOLL_CTL_ADD, socket.get(), EPOLLIN, index))
    clients_[index].emplace(std::move(socket), master, now_us);
}

int TcpServer::choose_seat(std::int64_t now_us, const Responder& responder) const noexcept {
  std::array<Seat, kClientCountMax> seats{};
  for (int i = 0; i < kClientCountMax; ++i) {
    if (!clients_[i]) continue;
    seats[i] = {true, clients_[i]->has_sent_a_frame(), clients_[i]->master().address,
                clients_[i]->heard_us()};
  }
  return seat_for_newcomer(seats, responder.owner(), now_us);
}

std::int64_t TcpServer::deadline_us() const noexcept {
  std::int64_t least = Client::kNever_us;
  for (const std::optional<Client>& client : clients_) {
    if (client) least = std::min(least, client->deadline_us());
  }
  return least;
}

int TcpServer::client_count() const noexcept {
  return static_cast<int>(std::count_if(clients_.begin(), clients_.end(),
                                        [](const auto& client) { return client.has_value(); }));
}

}  // namespace flatpose::port
