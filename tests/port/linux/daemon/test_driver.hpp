#pragma once
// Camera drivers for tests: the example as a process, and one that is led by the hand.

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <string>
#include <utility>
#include <vector>

#include "flatpose/camera.h"
#include "port/linux/files/scan.hpp"
#include "tests/port/linux/daemon/running_daemon.hpp"

namespace flatpose::daemon {

/// A program and its words, until it is stopped.
class RunningProgram {
 public:
  explicit RunningProgram(std::vector<std::string> words) {
    pid_ = fork();
    if (pid_ == 0) {
      std::vector<char*> arguments;
      for (std::string& word : words) arguments.push_back(word.data());
      arguments.push_back(nullptr);
      execv(arguments[0], arguments.data());
      _exit(127);
    }
  }
  ~RunningProgram() { stop(SIGKILL); }
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;

  void stop(int signal) {
    if (pid_ <= 0) return;
    kill(pid_, signal);
    waitpid(std::exchange(pid_, 0), nullptr, 0);
  }

 private:
  pid_t pid_ = 0;
};

/// flatpose-camera-replay.
class RunningDriver : public RunningProgram {
 public:
  RunningDriver(const std::string& socket, const std::string& scan)
      : RunningProgram({FLATPOSE_CAMERA_REPLAY, "--socket", socket, "--scan", scan}) {}
};

/// One connection by the client's library.
class TestDriver {
 public:
  explicit TestDriver(const std::string& socket, std::uint32_t flags = FLATPOSE_CAMERA_IS_SIMULATED,
                      const char* name = "test") {
    status = flatpose_camera_connect(&camera, socket.c_str(), name, flags);
  }
  ~TestDriver() { leave(); }
  TestDriver(const TestDriver&) = delete;
  TestDriver& operator=(const TestDriver&) = delete;

  void leave() { flatpose_camera_close(&camera); }
  [[nodiscard]] bool is_asked() {
    status = flatpose_camera_wait(&camera, 60'000, &request);
    return status == FLATPOSE_CAMERA_OK;
  }
  /// Into the memory, one point after the other; acquired now.
  flatpose_camera_scan put(const port::Scan& scan) const {
    std::copy(scan.xyz_mm.begin(), scan.xyz_mm.end(), floats());
    flatpose_camera_scan put = flatpose_camera_interleaved(scan.width_px, scan.height_px);
    put.up = scan.up == port::Up::kPlusZ ? FLATPOSE_CAMERA_UP_PLUS_Z : FLATPOSE_CAMERA_UP_MINUS_Z;
    put.start_us = flatpose_camera_now_us();
    put.end_us = put.start_us;
    return put;
  }
  void answer(const flatpose_camera_scan& scan) {
    EXPECT_EQ(flatpose_camera_done(&camera, &request, &scan), FLATPOSE_CAMERA_OK);
  }
  void answer(const port::Scan& scan) { answer(put(scan)); }

  /// What the client's library would not send.
  static flatpose_camera_head head(std::uint16_t kind, std::size_t bytes, std::uint32_t ticket) {
    return {FLATPOSE_CAMERA_MAGIC, FLATPOSE_CAMERA_VERSION, kind, static_cast<std::uint32_t>(bytes),
            ticket};
  }
  [[nodiscard]] flatpose_camera_done_message message_of(const flatpose_camera_scan& scan) const {
    return {head(FLATPOSE_CAMERA_KIND_DONE, sizeof(flatpose_camera_done_message), request.ticket),
            scan.width_px,
            scan.height_px,
            scan.flags,
            scan.up,
            scan.x_offset_bytes,
            scan.y_offset_bytes,
            scan.z_offset_bytes,
            scan.pixel_stride_bytes,
            scan.row_stride_bytes,
            scan.start_us,
            scan.end_us};
  }
  bool send(const void* bytes, std::size_t count) const {
    return ::send(camera.socket, bytes, count, MSG_NOSIGNAL) == static_cast<ssize_t>(count);
  }
  [[nodiscard]] float* floats() const { return reinterpret_cast<float*>(camera.memory); }
  /// Whether the daemon has closed the connection, or does so now.
  [[nodiscard]] bool is_closed() const {
    const timeval limit{60, 0};
    setsockopt(camera.socket, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
    char bytes[512];
    ssize_t size = 0;
    while ((size = recv(camera.socket, bytes, sizeof bytes, 0)) > 0) {
    }
    return size == 0 || errno == ECONNRESET;
  }

  flatpose_camera camera{};
  flatpose_camera_request request{};
  flatpose_camera_status status = FLATPOSE_CAMERA_OK;
};

}  // namespace flatpose::daemon
