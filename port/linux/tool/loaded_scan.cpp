#include "port/linux/tool/loaded_scan.hpp"

#include "flatpose/geometry/range_image.hpp"
#include "port/linux/clock/steady_clock.hpp"
#include "port/linux/files/work_file.hpp"
#include "port/linux/tool/command.hpp"
#include "port/linux/tool/engine.hpp"
#include "port/linux/tool/options.hpp"

namespace flatpose::tool {
namespace {

void align(LoadedScan& loaded, const ScanOptions& options) {
  const port::WorkFile work = port::read_work_file(options.work_path);
  if (options.up && *options.up != work.up)
    throw port::InputError("--up",
                           std::string(port::to_string(*options.up)) + " contradicts " +
                               options.work_path + ", which was aligned with " +
                               port::to_string(work.up),
                           "leave --up out or align again with it");
  loaded.scan.up = work.up;
  if (!options.up) loaded.scan.up_reason = "work";
  loaded.frames = frames_of_work(work.work_T_scan);
  loaded.frame = job::FrameName::kWork;
}

}  // namespace

LoadedScan load_scan(const std::string& path, const ScanOptions& options) {
  const port::SteadyClock clock;
  const std::int64_t start_us = clock.now_us();
  LoadedScan loaded;
  loaded.path = path;
  loaded.scan = port::read_scan(path, options.limits, options.up);
  check_sides(path, loaded.scan);
  if (options.work_path.empty()) {
    loaded.frames = frames_of_scan(loaded.scan.up == port::Up::kPlusZ);
  } else {
    align(loaded, options);
  }
  loaded.load_us = clock.now_us() - start_us;
  return loaded;
}

void require_points(const LoadedScan& loaded) {
  const RangeImageView view = loaded.scan.view();
  for (int row = 0; row < view.height_px; ++row) {
    for (int column = 0; column < view.width_px; ++column) {
      if (is_valid(view(column, row))) return;
    }
  }
  throw NothingFound(loaded.path, "every point is missing (scan_poor)",
                     "check laser, exposure and what stands in the sensor's field");
}

}  // namespace flatpose::tool
