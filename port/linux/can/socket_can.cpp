#include "port/linux/can/socket_can.hpp"

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <sys/socket.h>
#include <sys/uio.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "port/linux/can/interface.hpp"
#include "port/linux/files/input_error.hpp"

namespace flatpose::port {
namespace {

using can::BusState;
/// Frames passed over in one call at most: error frames that change nothing.
constexpr int kPassedOverMax = 64;

// What a node listens to; extended and remote frames are none of it.
bool set_filters(int socket, std::uint8_t node) noexcept {
  constexpr canid_t kExact = CAN_SFF_MASK | CAN_EFF_FLAG | CAN_RTR_FLAG;
  constexpr canid_t kAnyNode = 0x780 | CAN_EFF_FLAG | CAN_RTR_FLAG;
  const can_filter filters[] = {{can::kNmtId, kExact},
                                {can::kSyncId, kExact},
                                {can::kRpdoBase + node, kExact},
                                {can::kSdoRequestBase + node, kExact},
                                {can::kHeartbeatBase, kAnyNode}};
  constexpr can_err_mask_t kErrors = CAN_ERR_CRTL | CAN_ERR_BUSOFF | CAN_ERR_RESTARTED;
  constexpr int kOn = 1;
  return setsockopt(socket, SOL_CAN_RAW, CAN_RAW_FILTER, filters, sizeof filters) == 0 &&
         setsockopt(socket, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &kErrors, sizeof kErrors) == 0 &&
         setsockopt(socket, SOL_SOCKET, SO_RXQ_OVFL, &kOn, sizeof kOn) == 0;
}

bool bind_to(int socket, int index) noexcept {
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = index;
  return bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
}

std::uint32_t drops_in(msghdr& message, std::uint32_t before) noexcept {
  std::uint32_t drops = before;
  for (cmsghdr* part = CMSG_FIRSTHDR(&message); part != nullptr;
       part = CMSG_NXTHDR(&message, part)) {
    if (part->cmsg_level == SOL_SOCKET && part->cmsg_type == SO_RXQ_OVFL)
      std::memcpy(&drops, CMSG_DATA(part), sizeof drops);
  }
  return drops;
}

can::Frame frame_of(const can_frame& raw) noexcept {
  can::Frame frame;
  frame.is_extended = (raw.can_id & CAN_EFF_FLAG) != 0;
  frame.is_remote = (raw.can_id & CAN_RTR_FLAG) != 0;
  frame.id = raw.can_id & (frame.is_extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.size = std::min<std::uint8_t>(raw.can_dlc, can::kFrameBytesMax);
  std::copy_n(raw.data, frame.size, frame.data.begin());
  return frame;
}

// Down, or gone.
bool is_of_interface(int error) noexcept {
  return error == ENETDOWN || error == ENODEV || error == ENXIO;
}

}  // namespace

SocketCan::SocketCan(const std::string& subject, const std::string& interface, std::uint8_t node)
    : interface_(interface),
      node_(node),
      socket_(::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW)) {
  if (!socket_.is_open() && (errno == EAFNOSUPPORT || errno == EPROTONOSUPPORT))
    throw InputError(subject, "this kernel has no CAN", "load its module: modprobe can_raw");
  if (!socket_.is_open()) throw std::system_error(errno, std::generic_category(), "CAN socket");
  const CanInterface found = look_at_can(interface);
  check_can(subject, interface, found, 0);
  if (!set_filters(socket_.get(), node))
    throw std::system_error(errno, std::generic_category(), "CAN filters");
  if (!bind_to(socket_.get(), found.index))
    throw InputError(subject, interface + " cannot be used: " + std::strerror(errno),
                     "name a CAN interface");
  is_down_ = !found.is_up;
  if (is_down_ || found.is_bus_off) state_ = BusState::kOff;
  is_told_ = state_ == BusState::kActive;
}

can::Link::Received SocketCan::state(BusState state) noexcept {
  state_ = state;
  is_told_ = true;
  Received told;
  told.kind = Received::Kind::kBus;
  told.bus = {state, std::exchange(has_lost_frames_, false)};
  return told;
}

// An interface that went away with its adapter has taken the filters with it, and has another
// number when it is back. What the socket still has to say of before is dropped.
bool SocketCan::bind_again() noexcept {
  const CanInterface found = look_at_can(interface_);
  const bool is_bound = found.index != 0 && found.is_up && set_filters(socket_.get(), node_) &&
                        bind_to(socket_.get(), found.index);
  if (!is_bound) return false;
  int error = 0;
  socklen_t size = sizeof error;
  (void)getsockopt(socket_.get(), SOL_SOCKET, SO_ERROR, &error, &size);
  return true;
}

can::Link::Received SocketCan::failed(int error) noexcept {
  if (!is_of_interface(error)) return {};
  is_down_ = true;
  return state(BusState::kOff);
}

// Returns whether there is something to tell.
bool SocketCan::take_error_frame(std::uint32_t classes, std::uint8_t controller) noexcept {
  BusState fresh = state_;
  if ((classes & CAN_ERR_CRTL) != 0 && state_ != BusState::kOff) {
    constexpr int kPassive = CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE;
    constexpr int kBetter = CAN_ERR_CRTL_ACTIVE | CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING;
    if ((controller & kBetter) != 0) fresh = BusState::kActive;
    if ((controller & kPassive) != 0) fresh = BusState::kErrorPassive;
    if ((controller & CAN_ERR_CRTL_RX_OVERFLOW) != 0) has_lost_frames_ = true;
  }
  if ((classes & CAN_ERR_BUSOFF) != 0) fresh = BusState::kOff;
  if ((classes & CAN_ERR_RESTARTED) != 0) fresh = BusState::kActive;
  return std::exchange(state_, fresh) != fresh || has_lost_frames_;
}

can::Link::Received SocketCan::receive() noexcept {
  if (!is_told_) return state(state_);
  if (is_down_) {
    if (!bind_again()) return {};
    is_down_ = false;
    return state(BusState::kActive);
  }
  for (int i = 0; i < kPassedOverMax; ++i) {
    can_frame raw{};
    alignas(cmsghdr) std::uint8_t control[CMSG_SPACE(sizeof drop_count_)];
    iovec place{&raw, sizeof raw};
    msghdr message{};
    message.msg_iov = &place;
    message.msg_iovlen = 1;
    message.msg_control = control;
    message.msg_controllen = sizeof control;
    const ssize_t size = recvmsg(socket_.get(), &message, 0);
    if (size < 0) return failed(errno);
    const std::uint32_t drops = drops_in(message, drop_count_);
    if (drops != std::exchange(drop_count_, drops)) has_lost_frames_ = true;
    if (size != sizeof raw) continue;
    if ((raw.can_id & CAN_ERR_FLAG) == 0) {
      if (has_lost_frames_) is_told_ = false;  // with the next call
      return {Received::Kind::kFrame, frame_of(raw), {}};
    }
    if (take_error_frame(raw.can_id, raw.data[1])) return state(state_);
  }
  return {};
}

bool SocketCan::send(const can::Frame& frame) noexcept {
  if (is_down_) return false;
  can_frame raw{};
  raw.can_id = frame.id;
  raw.can_dlc = frame.size;
  std::copy_n(frame.data.begin(), frame.size, raw.data);
  if (::send(socket_.get(), &raw, sizeof raw, MSG_DONTWAIT) == sizeof raw) return true;
  if (!is_of_interface(errno)) return false;  // ENOBUFS: the queue of the interface is full
  is_down_ = true;
  state_ = BusState::kOff;
  is_told_ = false;
  return false;
}

}  // namespace flatpose::port
