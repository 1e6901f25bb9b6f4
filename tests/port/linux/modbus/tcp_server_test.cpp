// The server's sockets over loopback, with an echo for an answer and a clock of the test's own.

#include "port/linux/modbus/tcp_server.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/eventfd.h>
#include <sys/socket.h>

#include <algorithm>
#include <vector>

#include "port/linux/files/input_error.hpp"

namespace flatpose::port {
namespace {

using Bytes = std::vector<std::uint8_t>;

class Echo final : public Responder {
 public:
  std::size_t respond(const job::Master& master, const modbus::Adu& adu,
                      std::span<std::uint8_t, modbus::kAduBytesMax> response) noexcept override {
    masters.push_back(master);
    Bytes pdu(adu.pdu.begin(), adu.pdu.end());
    pdu.resize(std::max(pdu.size(), least_pdu_bytes), 7);
    return modbus::compose(adu.transaction, adu.unit, pdu, response);
  }
  job::Address owner() const noexcept override { return owner_address; }

  std::vector<job::Master> masters;
  job::Address owner_address = job::kNobody;
  std::size_t least_pdu_bytes = 0;  ///< Of a response.
};

class Peer {
 public:
  explicit Peer(int port, int receive_bytes = 0) {
    socket_ = FileDescriptor(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    if (receive_bytes > 0)
      setsockopt(socket_.get(), SOL_SOCKET, SO_RCVBUF, &receive_bytes, sizeof receive_bytes);
    sockaddr_in name{};
    name.sin_family = AF_INET;
    name.sin_port = htons(static_cast<std::uint16_t>(port));
    name.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(connect(socket_.get(), reinterpret_cast<sockaddr*>(&name), sizeof name), 0);
  }
  /// How much the system took.
  std::size_t send(const Bytes& bytes) const {
    const ssize_t size =
        ::send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    return size < 0 ? 0 : static_cast<std::size_t>(size);
  }
  [[nodiscard]] Bytes received() const {
    Bytes bytes(4096);
    const ssize_t size = recv(socket_.get(), bytes.data(), bytes.size(), MSG_DONTWAIT);
    bytes.resize(size < 0 ? 0 : static_cast<std::size_t>(size));
    return bytes;
  }
  [[nodiscard]] bool is_closed() const {
    char byte = 0;
    const ssize_t size = recv(socket_.get(), &byte, 1, MSG_DONTWAIT | MSG_PEEK);
    return size == 0 || (size < 0 && errno == ECONNRESET);
  }
  void close() { socket_.reset(); }

 private:
  FileDescriptor socket_;
};

Bytes frame(std::uint8_t transaction, std::size_t pdu_bytes = 5) {
  Bytes bytes{0, transaction, 0, 0, 0, static_cast<std::uint8_t>(pdu_bytes + 1), 1};
  bytes.resize(7 + pdu_bytes, 3);
  return bytes;
}

struct TcpServerTest : testing::Test {
  /// Some turns of the server, at the test's time.
  void turn(int times = 3) {
    for (int i = 0; i < times; ++i) {
      server.wait(20'000);
      server.serve(now_us, echo);
    }
  }
  Bytes answer(const Peer& peer, std::size_t bytes) {
    Bytes all;
    for (int i = 0; i < 1000 && all.size() < bytes && !peer.is_closed(); ++i) {
      turn(1);
      const Bytes more = peer.received();
      all.insert(all.end(), more.begin(), more.end());
    }
    return all;
  }
  /// Until the server has seen so many.
  void let_in(int count) {
    for (int i = 0; i < 1000 && server.client_count() != count; ++i) turn(1);
    ASSERT_EQ(server.client_count(), count);
  }

  FileDescriptor wake{eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)};
  TcpServer server{"test", "127.0.0.1", 0, wake.get()};
  Echo echo;
  std::int64_t now_us = 1'000'000;
};

TEST_F(TcpServerTest, AnswersAFrameInWhateverPiecesItComes) {
  const Bytes whole = frame(1);
  for (std::size_t cut = 1; cut < whole.size(); ++cut) {
    Peer peer(server.port());
    peer.send({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(cut)});
    turn();
    EXPECT_TRUE(peer.received().empty());
    peer.send({whole.begin() + static_cast<std::ptrdiff_t>(cut), whole.end()});
    EXPECT_EQ(answer(peer, whole.size()), whole);
  }
}

TEST_F(TcpServerTest, AnswersManyFramesOfOneSegmentInTheirOrder) {
  Peer peer(server.port());
  Bytes all;
  for (std::uint8_t i = 0; i < 200; ++i) {
    const Bytes one = frame(i, 1 + i % 60);
    all.insert(all.end(), one.begin(), one.end());
  }
  EXPECT_EQ(peer.send(all), all.size());
  EXPECT_EQ(answer(peer, all.size()), all);
}

TEST_F(TcpServerTest, FrameThatDribblesIsCutOffAtItsDeadlineAndAnIdleClientIsNot) {
  Peer slow(server.port());
  Peer idle(server.port());
  let_in(2);
  const Bytes whole = frame(1);
  for (std::size_t i = 0; i < 5; ++i) {  // each byte alone does not renew it
    slow.send({whole[i]});
    turn();
    EXPECT_FALSE(slow.is_closed());
    now_us += 190'000;
  }
  EXPECT_LE(server.deadline_us(), now_us + 60'000);
  now_us += 60'000;
  turn();
  EXPECT_TRUE(slow.is_closed());
  now_us += 3'600'000'000;
  turn();
  EXPECT_FALSE(idle.is_closed());
  idle.send(whole);
  EXPECT_EQ(answer(idle, whole.size()), whole);
}

TEST_F(TcpServerTest, StreamThatIsNoModbusIsClosed) {
  for (const Bytes& bytes : {Bytes{0, 1, 0, 1, 0, 2, 1, 3}, Bytes{0, 1, 0, 0, 1, 0, 1, 3},
                             Bytes{0, 1, 0, 0, 0, 1, 1, 3}, Bytes{'G', 'E', 'T', ' ', '/', ' '}}) {
    Peer peer(server.port());
    peer.send(bytes);
    let_in(1);
    let_in(0);
    EXPECT_TRUE(peer.is_closed());
  }
  EXPECT_TRUE(echo.masters.empty());
}

/// Whole frames, until the system takes no more of them and the server's own sending has to stop.
std::size_t stuff(const Peer& peer, const Bytes& one, TcpServer& server, Echo& echo,
                  std::int64_t now_us) {
  std::size_t sent = 0;
  for (int i = 0; i < 100'000 && server.deadline_us() == Client::kNever_us; ++i) {
    sent += peer.send({one.begin() + static_cast<std::ptrdiff_t>(sent % one.size()), one.end()});
    server.wait(0);
    server.serve(now_us, echo);
  }
  EXPECT_NE(server.deadline_us(), Client::kNever_us);
  return sent;
}

TEST_F(TcpServerTest, ClientThatReadsNoAnswersCostsItselfAlone) {
  Peer deaf(server.port(), 2048);
  Peer good(server.port());
  const Bytes small = frame(2);
  stuff(deaf, frame(1, modbus::kPduBytesMax), server, echo, now_us);
  good.send(small);
  EXPECT_EQ(answer(good, small.size()), small);
  for (int i = 0; i < 20 && server.client_count() == 2; ++i) {
    now_us += 1'100'000;
    turn(1);
  }
  EXPECT_EQ(server.client_count(), 1);
  good.send(small);
  EXPECT_EQ(answer(good, small.size()), small);
}

TEST_F(TcpServerTest, ClientThatReadsLateGetsAllAnswers) {
  Peer late(server.port(), 2048);
  const Bytes one = frame(1, modbus::kPduBytesMax);
  const std::size_t sent = stuff(late, one, server, echo, now_us);
  std::size_t got = 0;
  std::size_t wrong = 0;
  const std::size_t whole = sent - sent % one.size();
  for (int i = 0; i < 1'000'000 && got < whole && !late.is_closed(); ++i) {
    server.wait(0);
    server.serve(now_us, echo);
    for (const std::uint8_t byte : late.received()) wrong += byte != one[got++ % one.size()];
  }
  EXPECT_EQ(got, whole);
  EXPECT_EQ(wrong, 0U);
}

// All requests are read, and what is left is a response that found no room.
TEST_F(TcpServerTest, ResponseThatFoundNoRoomIsSentThoughNothingMoreIsAsked) {
  echo.least_pdu_bytes = modbus::kPduBytesMax;
  Peer late(server.port(), 2048);
  const Bytes request = frame(1, 1);
  std::size_t asked = 0;
  for (int i = 0; i < 100'000 && server.deadline_us() == Client::kNever_us; ++i) {
    ASSERT_EQ(late.send(request), request.size());
    ++asked;
    while (echo.masters.size() < asked) turn(1);
  }
  ASSERT_NE(server.deadline_us(), Client::kNever_us);
  const std::size_t whole = asked * modbus::kAduBytesMax;
  std::size_t got = 0;
  for (int i = 0; i < 1'000'000 && got < whole; ++i) {
    server.wait(0);
    server.serve(now_us, echo);
    got += late.received().size();
  }
  EXPECT_EQ(got, whole);
  EXPECT_EQ(server.deadline_us(), Client::kNever_us);
  echo.least_pdu_bytes = 0;
  late.send(request);  // and it is listened to again
  EXPECT_EQ(answer(late, request.size()), request);
}

TEST_F(TcpServerTest, SeventeenthTakesTheSeatOfOneThatNeverSpoke) {
  const Bytes whole = frame(1);
  std::vector<Peer> peers;
  for (int i = 0; i < kClientCountMax; ++i) {
    peers.emplace_back(server.port());
    let_in(i + 1);
    if (i == 5) continue;
    peers.back().send(whole);
    EXPECT_EQ(answer(peers.back(), whole.size()), whole);
  }
  Peer newcomer(server.port());
  newcomer.send(whole);
  EXPECT_EQ(answer(newcomer, whole.size()), whole);
  for (int i = 0; i < kClientCountMax; ++i) EXPECT_EQ(peers[i].is_closed(), i == 5) << i;
  Peer refused(server.port());
  for (int i = 0; i < 1000 && !refused.is_closed(); ++i) turn(1);
  EXPECT_TRUE(refused.is_closed());
  EXPECT_EQ(server.client_count(), kClientCountMax);
}

TEST_F(TcpServerTest, TwoHundredAttemptsAtOnceLeaveAGoodClientItsAnswers) {
  Peer good(server.port());
  const Bytes whole = frame(1);
  good.send(whole);
  EXPECT_EQ(answer(good, whole.size()), whole);
  std::vector<Peer> crowd;
  for (int i = 0; i < 200; ++i) {
    crowd.emplace_back(server.port());
    if (i % 10 != 0) continue;
    turn(1);
    good.send(whole);
    EXPECT_EQ(answer(good, whole.size()), whole) << i;
  }
  crowd.clear();
  let_in(1);
  EXPECT_FALSE(good.is_closed());
}

TEST_F(TcpServerTest, ConnectionsCountUpAndBearTheirAddress) {
  const Bytes whole = frame(1);
  for (int i = 0; i < 3; ++i) {
    Peer peer(server.port());
    peer.send(whole);
    EXPECT_EQ(answer(peer, whole.size()), whole);
  }
  ASSERT_EQ(echo.masters.size(), 3U);
  EXPECT_LT(echo.masters[0].connection, echo.masters[1].connection);
  EXPECT_LT(echo.masters[1].connection, echo.masters[2].connection);
  EXPECT_EQ(echo.masters[0].address, 0x7f000001U);
}

TEST_F(TcpServerTest, ClosingAtEveryByteLeavesNothingBehind) {
  const Bytes whole = frame(1, 30);
  for (std::size_t cut = 0; cut <= whole.size(); ++cut) {
    Peer peer(server.port());
    peer.send({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(cut)});
    let_in(1);
    peer.close();
    let_in(0);
  }
}

TEST(TcpServerAllow, ClosesWhoIsNotOnTheListAndServesWhoIs) {
  Echo echo;
  const Bytes whole = frame(1);
  for (const char* const text :
       {"127.0.0.1", "127.0.0.0/8", "0.0.0.0/0", "127.0.0.2", "10.0.0.0/8"}) {
    TcpServer server("test", "127.0.0.1", 0, -1, {{*parse_network(text)}});
    const bool is_listed = parse_network(text)->contains(0x7f000001);
    Peer peer(server.port());
    peer.send(whole);
    Bytes got;
    for (int i = 0; i < 1000 && got.empty() && !peer.is_closed(); ++i) {
      server.wait(20'000);
      server.serve(1, echo);
      got = peer.received();
    }
    EXPECT_EQ(got, is_listed ? whole : Bytes()) << text;
    EXPECT_EQ(server.client_count(), is_listed ? 1 : 0) << text;
  }
}

TEST(AllowList, HoldsNetworksAndSingleAddresses) {
  const auto admits = [](const char* text, std::uint32_t address) {
    return AllowList{{*parse_network("192.0.2.7"), *parse_network(text)}}.admits(address);
  };
  EXPECT_TRUE(admits("10.0.0.0/8", 0xc0000207));
  EXPECT_FALSE(admits("10.0.0.0/8", 0xc0000208));
  EXPECT_TRUE(admits("10.0.0.0/8", 0x0affffff));
  EXPECT_FALSE(admits("10.0.0.0/8", 0x0b000000));
  EXPECT_TRUE(admits("198.51.100.0/31", 0xc6336401));
  EXPECT_FALSE(admits("198.51.100.0/31", 0xc6336402));
  EXPECT_TRUE(AllowList{}.admits(0x01020304));
}

TEST(AllowList, RefusesWhatIsNoNetwork) {
  for (const char* const text :
       {"", "nonsense", "192.0.2.0/", "192.0.2.0/33", "192.0.2.0/-1", "192.0.2.0/ 8",
        "192.0.2.0/24x", "192.0.2.1/24", "1.2.3", "::1", "/8", "192.0.2.0/24/8"})
    EXPECT_FALSE(parse_network(text)) << text;
}

TEST(Listener, SaysWhatCannotBeListenedOn) {
  const Listener taken = listen_on("f.toml:3", "127.0.0.1", 0);
  const auto refused = [](const std::string& address, int port) -> std::string {
    try {
      (void)listen_on("f.toml:3", address, port);
    } catch (const InputError& error) {
      return error.line();
    }
    return {};
  };
  EXPECT_NE(refused("127.0.0.1", taken.port).find("another port"), std::string::npos);
  EXPECT_NE(refused("192.0.2.1", 0).find("0.0.0.0 for all"), std::string::npos);
  EXPECT_NE(refused("nonsense", 0).find("no IPv4 address"), std::string::npos);
}

}  // namespace
}  // namespace flatpose::port
