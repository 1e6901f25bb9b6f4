// flatpose-camera-replay: an example of a camera driver. What other drivers take from a camera it
// reads from a file, or from a folder's files by name, one for each request; it calls that
// simulated, for it is not what lies before the sensor. Connects again whenever the daemon is gone.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstring>
#include <iostream>
#include <string>
#include <thread>

#include "flatpose/camera.h"
#include "port/linux/files/input_error.hpp"
#include "port/linux/files/replay_folder.hpp"
#include "port/linux/files/scan.hpp"

namespace {

using flatpose::port::InputError;

constexpr int kExitUsage = 2;
constexpr std::chrono::milliseconds kRetry(200);

struct Options {
  std::string socket;
  std::string scan;
  std::string name = "replay";
};

void say(const std::string& line) {
  std::cerr << "flatpose-camera-replay: " << flatpose::port::printable(line, 1000) << std::endl;
}

/// What a camera does here: it takes the picture after it was asked, and says when.
flatpose_camera_scan capture(const flatpose_camera& camera, const std::string& path) {
  const std::int64_t start_us = flatpose_camera_now_us();
  if (path.empty()) throw InputError("--scan", "there is no scan", "put one there");
  const flatpose::port::Scan scan = flatpose::port::read_scan(path);
  if (scan.width_px > camera.width_px_max || scan.height_px > camera.height_px_max)
    throw InputError(path, "it is larger than the daemon takes",
                     "raise scan_width_px and scan_height_px in its config");
  std::memcpy(camera.memory, scan.xyz_mm.data(), scan.xyz_mm.size() * sizeof(float));
  flatpose_camera_scan layout = flatpose_camera_interleaved(scan.width_px, scan.height_px);
  layout.flags = FLATPOSE_CAMERA_IS_SIMULATED;
  layout.up = scan.up == flatpose::port::Up::kPlusZ ? FLATPOSE_CAMERA_UP_PLUS_Z
                                                    : FLATPOSE_CAMERA_UP_MINUS_Z;
  layout.start_us = start_us;
  layout.end_us = flatpose_camera_now_us();
  return layout;
}

/// Until the daemon is gone.
void serve(flatpose_camera& camera, flatpose::port::ReplayFolder& files) {
  flatpose_camera_request request;
  while (flatpose_camera_wait(&camera, -1, &request) == FLATPOSE_CAMERA_OK) {
    try {
      const flatpose_camera_scan scan = capture(camera, files.next());
      if (flatpose_camera_done(&camera, &request, &scan) == FLATPOSE_CAMERA_OK) continue;
      say("the scan could not be handed over");
    } catch (const std::exception& error) {
      say(error.what());
      (void)flatpose_camera_failed(&camera, &request, error.what());
    }
  }
}

[[noreturn]] void serve_for_ever(const Options& options) {
  flatpose::port::ReplayFolder files(options.scan);
  flatpose_camera_status before = FLATPOSE_CAMERA_TIMEOUT;
  while (true) {
    flatpose_camera camera;
    const flatpose_camera_status status = flatpose_camera_connect(
        &camera, options.socket.c_str(), options.name.c_str(), FLATPOSE_CAMERA_IS_SIMULATED);
    if (status == FLATPOSE_CAMERA_OK) {
      say("connected to " + options.socket);
      serve(camera, files);
      say("the daemon is gone; waiting for it");
    } else if (status != before) {  // one line, not one a try
      say(options.socket + ": " + flatpose_camera_status_text(status) +
          (camera.reason[0] != 0 ? std::string(": ") + camera.reason : std::string()));
    }
    before = status;
    flatpose_camera_close(&camera);
    std::this_thread::sleep_for(kRetry);
  }
}

}  // namespace

int main(int argument_count, char** arguments) {
  CLI::App app("An example of a camera driver: replays scans to flatposed.",
               "flatpose-camera-replay");
  Options options;
  app.add_option("--socket", options.socket, "the daemon's, as [source] driver names it")
      ->type_name("SOCKET")
      ->required();
  app.add_option("--scan", options.scan, "this file for every request, or a folder's by name")
      ->type_name("FILE|DIR")
      ->required();
  app.add_option("--name", options.name, "for the daemon's log");
  try {
    app.parse(argument_count, arguments);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    std::string why = error.what();
    std::replace(why.begin(), why.end(), '\n', ' ');
    say(InputError("command line", why, "see flatpose-camera-replay --help").line());
    return kExitUsage;
  }
  serve_for_ever(options);
}
