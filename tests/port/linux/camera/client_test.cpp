// The drivers' side of the protocol against a daemon made by hand, that says what it likes.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>
#include <random>
#include <thread>
#include <vector>

#include "flatpose/camera.h"

namespace {

constexpr std::size_t kBytes = 8192;

flatpose_camera_head head_of(std::uint16_t kind, std::size_t bytes, std::uint32_t ticket = 0) {
  return {FLATPOSE_CAMERA_MAGIC, FLATPOSE_CAMERA_VERSION, kind, static_cast<std::uint32_t>(bytes),
          ticket};
}

class FakeDaemon : public testing::Test {
 protected:
  FakeDaemon() {
    std::strcpy(folder_, "/tmp/flatpose-test-XXXXXX");
    EXPECT_NE(mkdtemp(folder_), nullptr);
    path_ = std::string(folder_) + "/s";
    sockaddr_un name{};
    name.sun_family = AF_UNIX;
    path_.copy(name.sun_path, sizeof name.sun_path - 1);
    listener_ = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
    EXPECT_EQ(bind(listener_, reinterpret_cast<sockaddr*>(&name), sizeof name), 0);
    EXPECT_EQ(listen(listener_, 4), 0);
    memory_ = memfd_create("test", MFD_CLOEXEC | MFD_ALLOW_SEALING);
    EXPECT_EQ(ftruncate(memory_, kBytes), 0);
  }
  ~FakeDaemon() override {
    flatpose_camera_close(&camera_);
    for (const int file : {listener_, line_, memory_}) close(file);
    unlink(path_.c_str());
    rmdir(folder_);
  }

  void seal() const { EXPECT_EQ(fcntl(memory_, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW), 0); }
  void say(const void* bytes, std::size_t count, int file = -1) const {
    alignas(cmsghdr) char control[CMSG_SPACE(sizeof file)] = {};
    iovec part{const_cast<void*>(bytes), count};
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
    EXPECT_EQ(sendmsg(line_, &packet, MSG_NOSIGNAL), static_cast<ssize_t>(count));
  }
  static flatpose_camera_welcome_message welcome() {
    return {head_of(FLATPOSE_CAMERA_KIND_WELCOME, sizeof(flatpose_camera_welcome_message)), kBytes,
            20, 30};
  }
  void ask(std::uint32_t ticket, std::int64_t answer_by_us = INT64_MAX) const {
    flatpose_camera_capture_message capture{};
    capture.head = head_of(FLATPOSE_CAMERA_KIND_CAPTURE, sizeof capture, ticket);
    capture.number = static_cast<std::uint16_t>(100 + ticket);
    capture.answer_by_us = answer_by_us;
    say(&capture, sizeof capture);
  }
  void stop(std::uint32_t ticket) const {
    const flatpose_camera_head head = head_of(FLATPOSE_CAMERA_KIND_STOP, sizeof head, ticket);
    say(&head, sizeof head);
  }
  /// Connects while `greeting` is said.
  template <class Greeting>
  flatpose_camera_status connect(Greeting greeting, const char* name = "test") {
    std::jthread daemon([&] {
      line_ = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
      EXPECT_EQ(recv(line_, &hello_, sizeof hello_, 0), static_cast<ssize_t>(sizeof hello_));
      greeting();
    });
    return flatpose_camera_connect(&camera_, path_.c_str(), name, 1);
  }
  void connect_well() {
    seal();
    ASSERT_EQ(connect([&] {
                const auto message = welcome();
                say(&message, sizeof message, memory_);
              }),
              FLATPOSE_CAMERA_OK);
  }

  char folder_[32];
  std::string path_;
  int listener_ = -1;
  int line_ = -1;
  int memory_ = -1;
  flatpose_camera_hello_message hello_{};
  flatpose_camera camera_{-1, nullptr, 0, 0, 0, 0, {}};
  flatpose_camera_request request_{};
};

TEST_F(FakeDaemon, IsGreetedAndSharesItsMemory) {
  connect_well();
  EXPECT_STREQ(hello_.name, "test");
  EXPECT_EQ(hello_.flags, 1U);
  EXPECT_EQ(camera_.width_px_max, 20);
  EXPECT_EQ(camera_.height_px_max, 30);
  ASSERT_EQ(camera_.memory_bytes, kBytes);
  camera_.memory[kBytes - 1] = 9;
  unsigned char last = 0;
  EXPECT_EQ(pread(memory_, &last, 1, kBytes - 1), 1);
  EXPECT_EQ(last, 9);
}

TEST_F(FakeDaemon, IsNotBelievedWhatIsNotSo) {
  const auto status_with = [&](const flatpose_camera_welcome_message& message, int file) {
    const flatpose_camera_status status = connect([&] { say(&message, sizeof message, file); });
    flatpose_camera_close(&camera_);
    close(line_);
    return status;
  };
  EXPECT_EQ(status_with(welcome(), memory_), FLATPOSE_CAMERA_BAD_DAEMON);  // could be cut short
  seal();
  EXPECT_EQ(status_with(welcome(), memory_), FLATPOSE_CAMERA_OK);
  EXPECT_EQ(status_with(welcome(), -1), FLATPOSE_CAMERA_BAD_DAEMON);
  EXPECT_EQ(status_with(welcome(), listener_), FLATPOSE_CAMERA_BAD_DAEMON);
  auto wrong = welcome();
  wrong.memory_bytes = kBytes + 1;
  EXPECT_EQ(status_with(wrong, memory_), FLATPOSE_CAMERA_BAD_DAEMON);
  wrong = welcome();
  wrong.head.version = 2;
  EXPECT_EQ(status_with(wrong, memory_), FLATPOSE_CAMERA_BAD_DAEMON);
  wrong = welcome();
  wrong.head.kind = FLATPOSE_CAMERA_KIND_CAPTURE;
  EXPECT_EQ(status_with(wrong, memory_), FLATPOSE_CAMERA_BAD_DAEMON);
  std::mt19937 random(3);
  for (std::size_t size = 1; size < 300; ++size) {
    std::vector<char> garbage(size);
    for (char& byte : garbage) byte = static_cast<char>(random());
    EXPECT_EQ(connect([&] { say(garbage.data(), garbage.size()); }), FLATPOSE_CAMERA_BAD_DAEMON);
    flatpose_camera_close(&camera_);
    close(line_);
  }
}

TEST_F(FakeDaemon, GivesItsReasonForARefusal) {
  flatpose_camera_reason_message refused{};
  refused.head = head_of(FLATPOSE_CAMERA_KIND_REFUSED, sizeof refused);
  std::memset(refused.reason, 'x', sizeof refused.reason);  // without an end
  EXPECT_EQ(connect([&] { say(&refused, sizeof refused); }), FLATPOSE_CAMERA_TURNED_AWAY);
  EXPECT_EQ(std::strlen(camera_.reason), sizeof camera_.reason - 1);
}

TEST_F(FakeDaemon, AsksForTheNewestThatIsStillWanted) {
  connect_well();
  EXPECT_EQ(flatpose_camera_wait(&camera_, 0, &request_), FLATPOSE_CAMERA_TIMEOUT);
  ask(1);
  ASSERT_EQ(flatpose_camera_wait(&camera_, 60'000, &request_), FLATPOSE_CAMERA_OK);
  EXPECT_EQ(request_.ticket, 1U);
  EXPECT_EQ(request_.number, 101);
  EXPECT_TRUE(flatpose_camera_is_wanted(&camera_, &request_));
  stop(7);  // of another
  EXPECT_TRUE(flatpose_camera_is_wanted(&camera_, &request_));
  stop(1);
  EXPECT_FALSE(flatpose_camera_is_wanted(&camera_, &request_));
  ask(2);
  stop(2);
  ask(3);
  ask(4);
  ASSERT_EQ(flatpose_camera_wait(&camera_, 60'000, &request_), FLATPOSE_CAMERA_OK);
  EXPECT_EQ(request_.ticket, 4U);
  ask(5, 0);  // its time is over
  EXPECT_EQ(flatpose_camera_wait(&camera_, 50, &request_), FLATPOSE_CAMERA_TIMEOUT);
}

TEST_F(FakeDaemon, HearsThatTheDriverLivesWhileItWaits) {
  connect_well();
  EXPECT_EQ(flatpose_camera_wait(&camera_, FLATPOSE_CAMERA_ALIVE_PERIOD_MS + 50, &request_),
            FLATPOSE_CAMERA_TIMEOUT);
  flatpose_camera_head alive{};
  ASSERT_EQ(recv(line_, &alive, sizeof alive, MSG_DONTWAIT), static_cast<ssize_t>(sizeof alive));
  EXPECT_EQ(alive.kind, FLATPOSE_CAMERA_KIND_ALIVE);
}

TEST_F(FakeDaemon, ThatEndsIsNoticed) {
  connect_well();
  ask(1);
  ASSERT_EQ(flatpose_camera_wait(&camera_, 60'000, &request_), FLATPOSE_CAMERA_OK);
  close(std::exchange(line_, -1));
  EXPECT_FALSE(flatpose_camera_is_wanted(&camera_, &request_));
  const flatpose_camera_scan scan = flatpose_camera_interleaved(2, 2);
  EXPECT_EQ(flatpose_camera_done(&camera_, &request_, &scan), FLATPOSE_CAMERA_LOST);
  EXPECT_EQ(flatpose_camera_failed(&camera_, &request_, "why"), FLATPOSE_CAMERA_LOST);
  EXPECT_EQ(flatpose_camera_wait(&camera_, 60'000, &request_), FLATPOSE_CAMERA_LOST);
}

TEST_F(FakeDaemon, IsSentWhatFitsAlone) {
  connect_well();
  const auto status_of = [&](flatpose_camera_scan scan) {
    return flatpose_camera_done(&camera_, &request_, &scan);
  };
  flatpose_camera_scan sound = flatpose_camera_interleaved(20, 30);
  sound.end_us = 5;
  EXPECT_EQ(status_of(sound), FLATPOSE_CAMERA_OK);
  flatpose_camera_done_message done{};
  ASSERT_EQ(recv(line_, &done, sizeof done, 0), static_cast<ssize_t>(sizeof done));
  EXPECT_EQ(done.width_px, 20);
  EXPECT_EQ(done.row_stride_bytes, 240U);
  EXPECT_EQ(done.end_us, 5);
  EXPECT_EQ(status_of(flatpose_camera_planes(20, 30)), FLATPOSE_CAMERA_OK);
  EXPECT_EQ(status_of(flatpose_camera_interleaved(21, 2)), FLATPOSE_CAMERA_BAD_ARGUMENT);
  EXPECT_EQ(status_of(flatpose_camera_interleaved(2, 31)), FLATPOSE_CAMERA_BAD_ARGUMENT);
  EXPECT_EQ(status_of(flatpose_camera_interleaved(1, 2)), FLATPOSE_CAMERA_BAD_ARGUMENT);
  flatpose_camera_scan wrong = sound;
  wrong.row_stride_bytes = 300;
  EXPECT_EQ(status_of(wrong), FLATPOSE_CAMERA_BAD_ARGUMENT);
  wrong = sound;
  wrong.z_offset_bytes = SIZE_MAX - 3;
  EXPECT_EQ(status_of(wrong), FLATPOSE_CAMERA_BAD_ARGUMENT);
  wrong = sound;
  wrong.x_offset_bytes = 2;
  EXPECT_EQ(status_of(wrong), FLATPOSE_CAMERA_BAD_ARGUMENT);
}

TEST(Camera, NamesWhatCannotBeConnectedTo) {
  flatpose_camera camera;
  EXPECT_EQ(flatpose_camera_connect(&camera, "/nowhere/s", "test", 0), FLATPOSE_CAMERA_NO_DAEMON);
  flatpose_camera_close(&camera);
  EXPECT_EQ(flatpose_camera_connect(&camera, std::string(108, 'x').c_str(), "test", 0),
            FLATPOSE_CAMERA_BAD_ARGUMENT);
  EXPECT_EQ(flatpose_camera_connect(&camera, "/nowhere/s", std::string(64, 'x').c_str(), 0),
            FLATPOSE_CAMERA_BAD_ARGUMENT);
  EXPECT_EQ(flatpose_camera_connect(&camera, nullptr, "test", 0), FLATPOSE_CAMERA_BAD_ARGUMENT);
  flatpose_camera_close(&camera);
  for (int i = 0; i < 8; ++i)
    EXPECT_NE(flatpose_camera_status_text(static_cast<flatpose_camera_status>(i)), nullptr);
}

}  // namespace
