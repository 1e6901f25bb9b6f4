#include "port/linux/can/socket_can.hpp"

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <linux/errqueue.h>
#include <linux/net_tstamp.h>
#include <sys/socket.h>
#include <sys/uio.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <system_error>
#include <utility>

#include "port/linux/can/interface.hpp"
#include "port/linux/clock/real_clock.hpp"
#include "port/linux/files/input_error.hpp"

namespace flatpose::port {
namespace {

using can::BusState;
/// Frames passed over in one call at most: error frames that change nothing, or what is dropped.
constexpr int kPassedOverMax = 64;
/// Two clocks read one after the other belong together when no more than this passed meanwhile.
constexpr std::int64_t kReading_us = 100;
constexpr int kReadingsMax = 3;

// Of hardware where there are some; without any a frame counts from when it is read.
void ask_for_stamps(int socket) noexcept {
  constexpr int kStamps = SOF_TIMESTAMPING_RX_SOFTWARE | SOF_TIMESTAMPING_SOFTWARE |
                          SOF_TIMESTAMPING_RX_HARDWARE | SOF_TIMESTAMPING_RAW_HARDWARE;
  (void)setsockopt(socket, SOL_SOCKET, SO_TIMESTAMPING, &kStamps, sizeof kStamps);
}

// What a node listens to; extended and remote frames are none of it. FD frames of others are
// nothing to a node either, but who is to send them gets them too.
bool set_filters(int socket, std::uint8_t node, bool carries_fd) noexcept {
  constexpr canid_t kExact = CAN_SFF_MASK | CAN_EFF_FLAG | CAN_RTR_FLAG;
  constexpr canid_t kAnyNode = 0x780 | CAN_EFF_FLAG | CAN_RTR_FLAG;
  const can_filter filters[] = {{can::kNmtId, kExact},
                                {can::kSyncId, kExact},
                                {can::kRpdoBase + node, kExact},
                                {can::kSdoRequestBase + node, kExact},
                                {can::kHeartbeatBase, kAnyNode}};
  constexpr can_err_mask_t kErrors = CAN_ERR_CRTL | CAN_ERR_BUSOFF | CAN_ERR_RESTARTED;
  constexpr int kOn = 1;
  const int fd = carries_fd ? 1 : 0;
  return setsockopt(socket, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &fd, sizeof fd) == 0 &&
         setsockopt(socket, SOL_CAN_RAW, CAN_RAW_FILTER, filters, sizeof filters) == 0 &&
         setsockopt(socket, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &kErrors, sizeof kErrors) == 0 &&
         setsockopt(socket, SOL_SOCKET, SO_RXQ_OVFL, &kOn, sizeof kOn) == 0;
}

bool bind_to(int socket, int index) noexcept {
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = index;
  return bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
}

/// What comes beside a frame.
struct Beside {
  std::uint32_t drops = 0;
  CanStamps stamps;
};
using Control = std::array<std::uint8_t, CMSG_SPACE(sizeof(std::uint32_t)) +
                                             CMSG_SPACE(sizeof(scm_timestamping))>;

Beside beside(msghdr& message, std::uint32_t drops_before) noexcept {
  Beside found{drops_before, {}};
  for (cmsghdr* part = CMSG_FIRSTHDR(&message); part != nullptr;
       part = CMSG_NXTHDR(&message, part)) {
    if (part->cmsg_level != SOL_SOCKET) continue;
    if (part->cmsg_type == SO_RXQ_OVFL)
      std::memcpy(&found.drops, CMSG_DATA(part), sizeof found.drops);
    if (part->cmsg_type != SO_TIMESTAMPING || part->cmsg_len < CMSG_LEN(sizeof(scm_timestamping)))
      continue;
    scm_timestamping stamps;
    std::memcpy(&stamps, CMSG_DATA(part), sizeof stamps);
    const timespec& software = stamps.ts[0];
    const timespec& hardware = stamps.ts[2];
    found.stamps = {us_of(software.tv_sec, software.tv_nsec),
                    us_of(hardware.tv_sec, hardware.tv_nsec)};
  }
  return found;
}

// A classic frame has the same layout, in its first 16 bytes.
static_assert(offsetof(can_frame, data) == offsetof(canfd_frame, data));

can::Frame frame_of(const canfd_frame& raw, bool is_fd) noexcept {
  can::Frame frame;
  frame.is_fd = is_fd;
  frame.has_bit_rate_switch = is_fd && (raw.flags & CANFD_BRS) != 0;
  frame.is_extended = (raw.can_id & CAN_EFF_FLAG) != 0;
  frame.is_remote = (raw.can_id & CAN_RTR_FLAG) != 0;
  frame.id = raw.can_id & (frame.is_extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.size = std::min<std::uint8_t>(raw.len, is_fd ? CANFD_MAX_DLEN : CAN_MAX_DLEN);
  std::copy_n(raw.data, frame.size, frame.data.begin());
  return frame;
}

// Down, or gone.
bool is_of_interface(int error) noexcept {
  return error == ENETDOWN || error == ENODEV || error == ENXIO;
}

}  // namespace

SocketCan::SocketCan(const std::string& subject, const std::string& interface, std::uint8_t node,
                     const CanNeed& need)
    : interface_(interface),
      node_(node),
      socket_(::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW)) {
  const int error = errno;
  const CanInterface found = look_at_can(interface);
  check_can(subject, interface, found, need);
  if (!socket_.is_open()) throw std::system_error(error, std::generic_category(), "CAN socket");
  carries_fd_ = found.carries_fd;
  if (!set_filters(socket_.get(), node, carries_fd_))
    throw std::system_error(errno, std::generic_category(), "CAN filters");
  if (!bind_to(socket_.get(), found.index))
    throw InputError(subject, interface + " cannot be used: " + std::strerror(errno),
                     "name a CAN interface");
  ask_for_stamps(socket_.get());
  is_down_ = !found.is_up;
  if (is_down_ || found.is_bus_off) state_ = BusState::kOff;
  is_told_ = state_ == BusState::kActive;
}

can::Link::Received SocketCan::state(BusState state) noexcept {
  state_ = state;
  is_told_ = true;
  Received told;
  told.kind = Received::Kind::kBus;
  told.bus = {state, std::exchange(has_lost_frames_, false), carries_fd_};
  told.received_us = arrived_us_;
  return told;
}

// What the socket still has to say of before: frames that nobody waits for any more, which would be
// taken for new ones, and an error. While there is some, who waits at the socket does not sleep.
// Returns whether that was all.
bool SocketCan::drop_unread() noexcept {
  char first = 0;
  for (int i = 0; i < kPassedOverMax; ++i) {
    if (recv(socket_.get(), &first, sizeof first, 0) < 0 && errno == EAGAIN) return true;
  }
  return false;
}

// An interface that went away with its adapter has taken the filters with it, and has another
// number when it is back.
bool SocketCan::bind_again() noexcept {
  const CanInterface found = look_at_can_link(interface_);
  const bool is_bound = found.index != 0 && found.is_up &&
                        set_filters(socket_.get(), node_, found.carries_fd) &&
                        bind_to(socket_.get(), found.index);
  if (!is_bound) return false;
  carries_fd_ = found.carries_fd;
  return true;
}

void SocketCan::go_down() noexcept {
  is_down_ = true;
  ++down_count_;
}

can::Link::Received SocketCan::failed(int error) noexcept {
  if (!is_of_interface(error)) return {};
  go_down();
  return state(BusState::kOff);
}

// Returns whether there is something to tell. Bus-off is over with RESTARTED, or where the adapter
// restarts by itself with ACTIVE; while it lasts nothing less says anything.
bool SocketCan::take_error_frame(std::uint32_t classes, std::uint8_t controller) noexcept {
  BusState fresh = state_;
  const bool is_active = (controller & CAN_ERR_CRTL_ACTIVE) != 0;
  if ((classes & CAN_ERR_CRTL) != 0 && (is_active || state_ != BusState::kOff)) {
    constexpr int kPassive = CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE;
    constexpr int kBetter = CAN_ERR_CRTL_ACTIVE | CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING;
    if ((controller & kBetter) != 0) fresh = BusState::kActive;
    if ((controller & kPassive) != 0) fresh = BusState::kErrorPassive;
    if ((controller & CAN_ERR_CRTL_RX_OVERFLOW) != 0) has_lost_frames_ = true;
  }
  if ((classes & CAN_ERR_BUSOFF) != 0) {
    if (state_ != BusState::kOff) ++off_count_;
    fresh = BusState::kOff;
  }
  if ((classes & CAN_ERR_RESTARTED) != 0) fresh = BusState::kActive;
  return std::exchange(state_, fresh) != fresh || has_lost_frames_;
}

void SocketCan::look_at_clocks() noexcept {
  std::int64_t now_us = clock_.now_us();
  std::int64_t real_us = 0;
  for (int i = 0; i < kReadingsMax; ++i) {
    const std::int64_t before_us = now_us;
    real_us = real_now_us();
    now_us = clock_.now_us();
    if (now_us - before_us <= kReading_us) break;
  }
  arrival_.look(now_us, real_us);
}

can::Link::Received SocketCan::receive() noexcept {
  if (!is_told_) return state(state_);
  if (is_down_) {
    if (!drop_unread() || !bind_again()) return {};
    is_down_ = false;
    return state(BusState::kActive);
  }
  for (int i = 0; i < kPassedOverMax; ++i) {
    canfd_frame raw{};
    alignas(cmsghdr) Control control;
    iovec place{&raw, sizeof raw};
    msghdr message{};
    message.msg_iov = &place;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = sizeof control;
    const ssize_t size = recvmsg(socket_.get(), &message, 0);
    if (size < 0) {
      const int error = errno;
      arrival_.drained();
      look_at_clocks();
      return failed(error);
    }
    const Beside found = beside(message, drop_count_);
    if (found.drops != std::exchange(drop_count_, found.drops)) has_lost_frames_ = true;
    look_at_clocks();
    arrived_us_ = arrival_.arrived_us(found.stamps);
    const bool is_fd = size == CANFD_MTU;
    if (!is_fd && size != CAN_MTU) continue;
    if ((raw.can_id & CAN_ERR_FLAG) == 0) {
      // Who hears the bus is on it, whatever word of that was lost. Told with the next call.
      const bool was_off = state_ == BusState::kOff;
      if (was_off) state_ = BusState::kActive;
      if (was_off || has_lost_frames_) is_told_ = false;
      return {Received::Kind::kFrame, frame_of(raw, is_fd), {}, arrived_us_};
    }
    if (take_error_frame(raw.can_id, raw.data[1])) return state(state_);
  }
  return state(state_);  // nothing new, but nothing says that the queue is empty
}

bool SocketCan::send(const can::Frame& frame) noexcept {
  if (is_down_) return false;
  canfd_frame raw{};
  raw.can_id = frame.id;
  raw.len = frame.size;
  raw.flags = frame.is_fd && frame.has_bit_rate_switch ? CANFD_BRS : 0;
  std::copy_n(frame.data.begin(), frame.size, raw.data);
  const ssize_t size = frame.is_fd ? CANFD_MTU : CAN_MTU;
  if (::send(socket_.get(), &raw, static_cast<std::size_t>(size), MSG_DONTWAIT) == size)
    return true;
  if (frame.is_fd && errno == EINVAL) return true;  // the interface has become a classic one
  if (!is_of_interface(errno)) return false;        // ENOBUFS: its queue is full
  go_down();
  state_ = BusState::kOff;
  is_told_ = false;
  return false;
}

}  // namespace flatpose::port
