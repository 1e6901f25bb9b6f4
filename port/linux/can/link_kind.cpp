#include "port/linux/can/link_kind.hpp"

#include <linux/if_link.h>
#include <linux/rtnetlink.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <span>

#include "port/linux/modbus/file_descriptor.hpp"

namespace flatpose::port {
namespace {

/// More than the kernel says of one link.
constexpr std::size_t kAnswerBytesMax = 32'768;

using Bytes = std::span<const std::byte>;

/// The attribute of this type among `attributes`; empty: there is none.
Bytes attribute_of(Bytes attributes, int type) {
  while (attributes.size() >= sizeof(rtattr)) {
    rtattr head;
    std::memcpy(&head, attributes.data(), sizeof head);
    if (head.rta_len < sizeof head || head.rta_len > attributes.size()) return {};
    if ((head.rta_type & NLA_TYPE_MASK) == type)
      return attributes.subspan(RTA_LENGTH(0), head.rta_len - RTA_LENGTH(0));
    attributes =
        attributes.subspan(std::min<std::size_t>(RTA_ALIGN(head.rta_len), attributes.size()));
  }
  return {};
}

bool ask(int socket, int index) {
  struct {
    nlmsghdr head{};
    ifinfomsg link{};
  } question;
  question.head.nlmsg_len = sizeof question;
  question.head.nlmsg_type = RTM_GETLINK;
  question.head.nlmsg_flags = NLM_F_REQUEST;
  question.link.ifi_index = index;
  return send(socket, &question, sizeof question, 0) == ssize_t{sizeof question};
}

}  // namespace

std::string link_kind_of(int index) {
  constexpr std::size_t kHeadBytes = NLMSG_LENGTH(NLMSG_ALIGN(sizeof(ifinfomsg)));
  const FileDescriptor socket(::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE));
  if (!socket.is_open() || !ask(socket.get(), index)) return {};
  std::array<std::byte, kAnswerBytesMax> answer{};
  const ssize_t size = recv(socket.get(), answer.data(), answer.size(), 0);
  nlmsghdr head{};
  if (size < ssize_t{kHeadBytes}) return {};
  std::memcpy(&head, answer.data(), sizeof head);
  if (head.nlmsg_type != RTM_NEWLINK) return {};
  const Bytes attributes = Bytes(answer).first(static_cast<std::size_t>(size)).subspan(kHeadBytes);
  const Bytes kind = attribute_of(attribute_of(attributes, IFLA_LINKINFO), IFLA_INFO_KIND);
  const auto* const text = reinterpret_cast<const char*>(kind.data());
  return kind.empty() ? std::string() : std::string(text, strnlen(text, kind.size()));
}

}  // namespace flatpose::port
