#pragma once
// The daemon as a process, on a port that was free, and a PLC that talks to it byte by byte.

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdint>
#include <functional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "flatpose/job/order.hpp"
#include "flatpose/job/snapshot.hpp"
#include "flatpose/result_map/table.hpp"

namespace flatpose::daemon {

/// Far more than anything here takes.
inline constexpr std::chrono::seconds kPatience(60);

inline bool comes_true(const std::function<bool()>& condition) {
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (std::chrono::steady_clock::now() < end) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return false;
}

class RunningDaemon {
 public:
  explicit RunningDaemon(std::vector<std::string> args) {
    args.insert(args.begin(), "flatposed");
    int ends[2] = {-1, -1};
    EXPECT_EQ(pipe(ends), 0);
    pid_ = fork();
    if (pid_ == 0) {
      dup2(ends[1], STDERR_FILENO);
      close(ends[0]);
      close(ends[1]);
      std::vector<char*> words;
      for (std::string& arg : args) words.push_back(arg.data());
      words.push_back(nullptr);
      execv(FLATPOSED_PROGRAM, words.data());
      _exit(127);
    }
    close(ends[1]);
    log_end_ = ends[0];
    while (log_.find("ready: ") == std::string::npos && read_some()) {
    }
    const std::size_t at = log_.find("Modbus TCP on ");
    const std::size_t colon = log_.find(':', at == std::string::npos ? log_.size() : at);
    EXPECT_NE(colon, std::string::npos) << log_;
    if (colon != std::string::npos) port_ = std::stoi(log_.substr(colon + 1));
  }
  ~RunningDaemon() {
    stop(SIGKILL);
    close(log_end_);
  }
  RunningDaemon(const RunningDaemon&) = delete;
  RunningDaemon& operator=(const RunningDaemon&) = delete;

  [[nodiscard]] int port() const { return port_; }
  [[nodiscard]] pid_t pid() const { return pid_; }
  /// Its exit code; -1 when the signal killed it.
  int stop(int signal) {
    if (pid_ <= 0) return -1;
    kill(pid_, signal);
    while (read_some()) {
    }
    int status = 0;
    waitpid(std::exchange(pid_, 0), &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  void signal(int signal) const { kill(pid_, signal); }
  /// All of it after stop().
  [[nodiscard]] const std::string& log() const { return log_; }

 private:
  bool read_some() {
    char text[512];
    const ssize_t size = read(log_end_, text, sizeof text);
    if (size > 0) log_.append(text, static_cast<std::size_t>(size));
    return size > 0;
  }

  pid_t pid_ = 0;
  int log_end_ = -1;
  int port_ = 0;
  std::string log_;
};

using Bytes = std::vector<std::uint8_t>;

class Plc {
 public:
  explicit Plc(int port, const char* own_address = "127.0.0.1") {
    socket_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const timeval limit{60, 0};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
    sockaddr_in own{};
    own.sin_family = AF_INET;
    inet_pton(AF_INET, own_address, &own.sin_addr);
    EXPECT_EQ(bind(socket_, reinterpret_cast<sockaddr*>(&own), sizeof own), 0);
    sockaddr_in name = own;
    inet_pton(AF_INET, "127.0.0.1", &name.sin_addr);
    name.sin_port = htons(static_cast<std::uint16_t>(port));
    EXPECT_EQ(connect(socket_, reinterpret_cast<sockaddr*>(&name), sizeof name), 0);
  }
  ~Plc() { close(socket_); }
  Plc(const Plc&) = delete;
  Plc& operator=(const Plc&) = delete;

  void send(const Bytes& bytes) const {
    EXPECT_EQ(::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(bytes.size()));
  }
  /// As much as is taken before the other side closes.
  void send_some(const Bytes& bytes) const {
    (void)!::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  }
  /// The next byte of the stream; -1: it was closed.
  [[nodiscard]] int byte() const {
    std::uint8_t got = 0;
    return recv(socket_, &got, 1, 0) == 1 ? got : -1;
  }
  static Bytes frame(std::uint16_t transaction, const Bytes& pdu) {
    Bytes bytes{static_cast<std::uint8_t>(transaction >> 8),
                static_cast<std::uint8_t>(transaction),
                0,
                0,
                0,
                static_cast<std::uint8_t>(pdu.size() + 1),
                1};
    bytes.insert(bytes.end(), pdu.begin(), pdu.end());
    return bytes;
  }
  /// The PDU of the response; empty: the connection was closed.
  [[nodiscard]] Bytes answer(std::uint16_t transaction) const {
    Bytes head;
    for (int i = 0; i < 7; ++i) {
      const int next = byte();
      if (next < 0) return {};
      head.push_back(static_cast<std::uint8_t>(next));
    }
    EXPECT_EQ(head[0] * 256 + head[1], transaction);
    Bytes pdu(static_cast<std::size_t>(head[4] * 256 + head[5] - 1));
    for (std::uint8_t& part : pdu) part = static_cast<std::uint8_t>(byte());
    return pdu;
  }
  Bytes ask(const Bytes& pdu) {
    send(frame(++transaction_, pdu));
    return answer(transaction_);
  }
  std::vector<std::uint16_t> read(int address, int count) {
    const Bytes pdu =
        ask({3, static_cast<std::uint8_t>(address >> 8), static_cast<std::uint8_t>(address), 0,
             static_cast<std::uint8_t>(count)});
    std::vector<std::uint16_t> words;
    EXPECT_EQ(pdu.size(), static_cast<std::size_t>(2 + 2 * count));
    for (std::size_t i = 2; i + 1 < pdu.size(); i += 2)
      words.push_back(static_cast<std::uint16_t>(pdu[i] * 256 + pdu[i + 1]));
    words.resize(static_cast<std::size_t>(count));
    return words;
  }
  /// Writes registers from 0 on; returns whether that was granted.
  bool write(const std::vector<std::uint16_t>& words) {
    Bytes pdu{16,
              0,
              0,
              0,
              static_cast<std::uint8_t>(words.size()),
              static_cast<std::uint8_t>(2 * words.size())};
    for (const std::uint16_t word : words) {
      pdu.push_back(static_cast<std::uint8_t>(word >> 8));
      pdu.push_back(static_cast<std::uint8_t>(word));
    }
    const Bytes response = ask(pdu);
    return !response.empty() && response[0] == 16;
  }

  /// The result block, by fields.
  struct Block {
    std::vector<std::uint16_t> words;
    [[nodiscard]] std::int64_t operator[](result_map::Field field) const {
      const result_map::Entry& entry = *result_map::find(field);
      const auto at = static_cast<std::size_t>(entry.address - result_map::kResultAddress);
      const std::uint32_t two =
          entry.words() == 1 ? words.at(at)
                             : static_cast<std::uint32_t>(words.at(at) << 16 | words.at(at + 1));
      if (entry.type == result_map::Type::kInt16) return static_cast<std::int16_t>(two);
      if (entry.type == result_map::Type::kInt32) return static_cast<std::int32_t>(two);
      return two;
    }
    [[nodiscard]] bool has(job::Bit bit) const {
      return ((*this)[result_map::Field::kBits] & bit) != 0;
    }
  };
  Block block() { return {read(result_map::kResultAddress, result_map::kResultWords)}; }

  bool waits_until_ready() {
    return comes_true([&] { return block().has(job::kReady); });
  }
  /// Writes and waits until the number is done, or refused.
  Block trigger(std::uint16_t number, std::uint16_t session = 0, std::uint16_t command = 1,
                std::uint16_t job = 1) {
    EXPECT_TRUE(write({number, session, command, job, 0, 1}));  // a pick that went well
    Block seen;
    EXPECT_TRUE(comes_true([&] {
      seen = block();
      return seen[result_map::Field::kDoneNumber] == number ||
             seen[result_map::Field::kRefusedNumber] == number;
    }));
    return seen;
  }

 private:
  int socket_ = -1;
  std::uint16_t transaction_ = 0;
};

}  // namespace flatpose::daemon
