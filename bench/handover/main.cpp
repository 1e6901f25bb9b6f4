// How long a scan takes from a camera driver's answer to the searching thread: the message, the
// checks, the copy with its comparison, the wake-up. The driver is a thread here and otherwise what
// drivers are: the client's library at the daemon's socket. Beside it the machine's own memcpy of
// the same points, which is what the copy could take at best.

#include <fcntl.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "flatpose/camera.h"
#include "port/linux/daemon/config.hpp"
#include "port/linux/daemon/driver_source.hpp"

namespace {

using namespace flatpose::daemon;

constexpr int kRounds = 300;

enum class Layout { kInterleaved, kPlanes, kPadded };

constexpr const char* kLayoutNames[] = {"interleaved", "planes", "points of 16 bytes"};

flatpose_camera_scan scan_of(Layout layout, int width_px, int height_px) {
  if (layout == Layout::kPlanes) return flatpose_camera_planes(width_px, height_px);
  flatpose_camera_scan scan = flatpose_camera_interleaved(width_px, height_px);
  if (layout == Layout::kPadded) {
    scan.pixel_stride_bytes = 16;
    scan.row_stride_bytes = 16 * static_cast<std::size_t>(width_px);
  }
  return scan;
}

struct Times {
  std::vector<std::int64_t> asked_us;   ///< From the request to the driver.
  std::vector<std::int64_t> handed_us;  ///< From its answer to the search.
};

/// One driver, and one round after the other; half of the scans are the last one again.
class Rig {
 public:
  Rig(int width_px, int height_px)
      : width_px_(width_px),
        height_px_(height_px),
        buffers_{std::vector<float>(3 * pixels()), std::vector<float>(3 * pixels())},
        log_(std::cerr) {
    char name[] = "/tmp/flatpose-handover-XXXXXX";
    folder_ = mkdtemp(name);
    const Config config =
        parse_config(folder_ + "/f.toml", "[search]\nscan_width_px = " + std::to_string(width_px) +
                                              "\nscan_height_px = " + std::to_string(height_px) +
                                              "\n[source]\ndriver = \"s\"\n");
    const ScanBuffers buffers{std::span(buffers_[0]), std::span(buffers_[1])};
    event_ = std::make_unique<flatpose::port::FileDescriptor>(::open("/dev/null", O_WRONLY));
    source_ = std::make_unique<DriverSource>(config, buffers, bell_, event_->get(), log_);
    source_->start();
  }
  ~Rig() {
    source_.reset();
    std::filesystem::remove_all(folder_);
  }
  Rig(const Rig&) = delete;
  Rig& operator=(const Rig&) = delete;

  Times measure(Layout layout) {
    std::atomic<bool> is_over{false};
    std::atomic<bool> is_connected{false};
    std::atomic<std::int64_t> asked_us{0};
    std::atomic<std::int64_t> answered_us{0};
    std::thread driver([&] {
      flatpose_camera camera;
      if (flatpose_camera_connect(&camera, (folder_ + "/s").c_str(), "bench", 1) !=
          FLATPOSE_CAMERA_OK)
        std::abort();
      std::mt19937 random(1);
      auto* const floats = reinterpret_cast<float*>(camera.memory);
      for (std::size_t i = 0; i < 4 * pixels(); ++i) floats[i] = static_cast<float>(random() % 99);
      is_connected.store(true);
      flatpose_camera_request request;
      int round = 0;
      while (!is_over.load()) {
        if (flatpose_camera_wait(&camera, 20, &request) != FLATPOSE_CAMERA_OK) continue;
        asked_us.store(flatpose_camera_now_us());
        flatpose_camera_scan scan = scan_of(layout, width_px_, height_px_);
        scan.start_us = flatpose_camera_now_us();
        if (++round % 2 == 0) floats[0] = static_cast<float>(round);
        scan.end_us = flatpose_camera_now_us();
        answered_us.store(scan.end_us);
        (void)flatpose_camera_done(&camera, &request, &scan);
      }
      flatpose_camera_close(&camera);
    });
    while (!is_connected.load()) std::this_thread::yield();
    Times times;
    for (int round = 0; round < kRounds; ++round) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      const std::int64_t start_us = flatpose_camera_now_us();
      source_->request({++ticket_, 1, 1, start_us, start_us + 60'000'000});
      const HeldScan* scan = nullptr;
      while (scan == nullptr) {
        const std::uint32_t seen = bell_.seen();
        scan = source_->take(flatpose_camera_now_us());
        if (scan == nullptr) bell_.wait(seen);
      }
      const std::int64_t end_us = flatpose_camera_now_us();
      if (!scan->failure.empty()) {
        std::fprintf(stderr, "%s\n", scan->failure.c_str());
        std::abort();
      }
      times.asked_us.push_back(asked_us.load() - start_us);
      times.handed_us.push_back(end_us - answered_us.load());
    }
    is_over.store(true);
    driver.join();
    return times;
  }

  std::vector<std::int64_t> copy_us() {
    std::vector<std::int64_t> times;
    for (int round = 0; round < kRounds; ++round) {
      const std::int64_t start_us = flatpose_camera_now_us();
      std::memcpy(buffers_[round % 2].data(), buffers_[1 - round % 2].data(),
                  buffers_[0].size() * sizeof(float));
      times.push_back(flatpose_camera_now_us() - start_us);
    }
    return times;
  }

 private:
  [[nodiscard]] std::size_t pixels() const {
    return static_cast<std::size_t>(width_px_) * static_cast<std::size_t>(height_px_);
  }

  int width_px_;
  int height_px_;
  std::array<std::vector<float>, 2> buffers_;
  Log log_;
  Doorbell bell_;
  std::string folder_;
  std::unique_ptr<flatpose::port::FileDescriptor> event_;
  std::unique_ptr<DriverSource> source_;
  std::uint32_t ticket_ = 0;
};

void print(const std::string& name, std::vector<std::int64_t> times_us) {
  std::sort(times_us.begin(), times_us.end());
  std::printf("  %-32s %8.2f %8.2f %8.2f\n", name.c_str(),
              static_cast<double>(times_us[times_us.size() / 2]) / 1000.0,
              static_cast<double>(times_us[times_us.size() * 99 / 100]) / 1000.0,
              static_cast<double>(times_us.back()) / 1000.0);
}

}  // namespace

int main() {
  for (const auto& [width_px, height_px] :
       {std::pair{400, 333}, std::pair{600, 500}, std::pair{1536, 1280}}) {
    Rig rig(width_px, height_px);
    std::printf("%d x %d points, %d rounds, ms:  median      p99      max\n", width_px, height_px,
                kRounds);
    for (const Layout layout : {Layout::kInterleaved, Layout::kPlanes, Layout::kPadded}) {
      const Times times = rig.measure(layout);
      if (layout == Layout::kInterleaved) print("request to driver", times.asked_us);
      print(std::string("answer to search, ") + kLayoutNames[static_cast<int>(layout)],
            times.handed_us);
    }
    print("memcpy of the points", rig.copy_us());
  }
}
