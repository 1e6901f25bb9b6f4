// Prints, for a scan of 0.3 and one of 2 megapixels, what memory a locator and a teacher ask for,
// and what teaching a part and locating it took of that and of the stack; a line of JSON each.
//
//   flatpose_footprint [small | large | both]

#include <cstdio>
#include <string>
#include <vector>

#include "bench/footprint/painted_stack.hpp"
#include "flatpose/locate/locator.hpp"
#include "flatpose/teach/teacher.hpp"
#include "port/linux/cpu/vector_path.hpp"
#include "port/sim/simulate.hpp"

namespace {

using namespace flatpose;

constexpr std::size_t kStackBytes = 1 << 20;

struct Size {
  int width_px, height_px, cell_count;
};
constexpr Size kSmall{600, 500, 400'000};
constexpr Size kLarge{1536, 1280, 4'000'000};

sim::SimulatedScan simulated(const char* scene, const Size& size, std::uint64_t seed) {
  sim::SensorConfig sensor;
  sensor.columns = size.width_px;
  sensor.rows = size.height_px;
  sim::SceneConfig config;
  config.scene = scene;
  config.part = "pad";
  return sim::simulate(config, sensor, seed);
}

bool measure(const Size& size) {
  const locate::Limits limits{size.width_px, size.height_px, size.cell_count,
                              port::best_vector_path()};
  std::vector<std::byte> memory(teach::Teacher::required_bytes(limits));
  const sim::SimulatedScan lone = simulated("single", size, 1);
  const sim::SimulatedScan pile = simulated("pile", size, 7);
  model::Template part;
  teach::TeachReport report;
  Status taught = Status::kNoPart;
  Status located = Status::kNoPart;
  locate::LocateResult result;

  const teach::TeachScan scan{lone.view(), frames_of_scan(true)};
  teach::Teacher teacher;
  if (teacher.init(limits, memory) != Status::kOk) return false;
  const std::size_t teach_stack_bytes = bench::stack_taken(kStackBytes, [&] {
    taught = teacher.teach({&scan, 1}, {}, part, report);
  });

  locate::LocateConfig config;
  config.max_matches = locate::kMatchCountMax;
  const RangeImageView view = pile.view();
  const Frames frames = frames_of_scan(true);
  locate::Locator locator;
  if (locator.init(limits, memory) != Status::kOk) return false;
  const std::size_t locate_stack_bytes = bench::stack_taken(kStackBytes, [&] {
    located = locator.locate(part, view, frames, config, StoppedClock{}, result);
  });
  if (taught != Status::kOk || located != Status::kOk || result.match_count == 0) return false;
  std::printf(
      R"({"scan":"%dx%d","cell_count":%d,"locator_bytes":%zu,"teacher_bytes":%zu,"peak_bytes":%zu,)"
      R"("teach_stack_bytes":%zu,"locate_stack_bytes":%zu})"
      "\n",
      size.width_px, size.height_px, size.cell_count, locate::Locator::required_bytes(limits),
      memory.size(), result.peak_bytes, teach_stack_bytes, locate_stack_bytes);
  return true;
}

}  // namespace

int main(int count, char** words) {
  const std::string which = count > 1 ? words[1] : "both";
  if ((which != "large" && !measure(kSmall)) || (which != "small" && !measure(kLarge))) {
    std::fprintf(stderr, "flatpose_footprint: nothing was taught or found\n");
    return 1;
  }
}
