// Prints a digest of each step of some whole searches: the scan made, the template taught from it,
// what is located. The same lines come out of every build, on every machine and vector path, and
// however many threads share the work; table.txt holds them.
//
//   flatpose_digests [portable | avx2 | avx512 | best] [THREADS] [PART]

#include <cstdio>
#include <cstdlib>
#include <span>
#include <string>
#include <vector>

#include "flatpose/core/fnv.hpp"
#include "flatpose/locate/locator.hpp"
#include "flatpose/model/template_file.hpp"
#include "flatpose/teach/teacher.hpp"
#include "port/linux/cpu/vector_path.hpp"
#include "port/linux/threads/worker_pool.hpp"
#include "port/sim/simulate.hpp"

namespace {

using namespace flatpose;

struct Case {
  const char* part;
  std::vector<const char*> scenes;
};
const std::vector<Case> kCases{{"pad", {"high"}}, {"cylinder", {"cyl_grid"}}};
constexpr std::uint64_t kTeachSeeds[] = {9001, 9002};
constexpr std::uint64_t kSeed = 3;
constexpr int kMatchesMax = 12;

/// Half the usual resolution: an emulated processor is slow.
sim::SensorConfig coarse_sensor() {
  sim::SensorConfig sensor;
  sensor.columns = 300;
  sensor.rows = 250;
  return sensor;
}

sim::SimulatedScan simulated(const char* scene, const char* part, std::uint64_t seed) {
  sim::SceneConfig config;
  config.scene = scene;
  config.part = part;
  sim::SimulatedScan scan = sim::simulate(config, coarse_sensor(), seed);
  Fnv1a64 hash;
  hash.add(std::as_bytes(std::span(scan.xyz_mm)));
  std::printf("scan     %-9s %-9s %4d  %016llx\n", part, scene, static_cast<int>(seed),
              static_cast<unsigned long long>(hash.value()));
  return scan;
}

class Machine {
 public:
  Machine(VectorPath path, int thread_count)
      : memory_(teach::Teacher::required_bytes(limits_)), workers_(thread_count) {
    limits_.vector_path = path;
  }

  bool run(const Case& of) {
    model::Template part;
    if (!teach(of.part, part)) return false;
    for (const char* scene : of.scenes) {
      if (!locate(part, of.part, simulated(scene, of.part, kSeed))) return false;
    }
    return true;
  }

 private:
  bool teach(const char* name, model::Template& part) {
    std::vector<sim::SimulatedScan> scans;
    for (const std::uint64_t seed : kTeachSeeds) scans.push_back(simulated("single", name, seed));
    std::vector<teach::TeachScan> views;
    for (const sim::SimulatedScan& scan : scans)
      views.push_back({scan.view(), frames_of_scan(true)});
    teach::Teacher teacher;
    teach::TeachReport report;
    std::vector<std::byte> bytes(model::kTemplateFileBytesMax);
    if (teacher.init(limits_, memory_) != Status::kOk ||
        teacher.teach(views, {}, part, report) != Status::kOk)
      return false;
    const auto size_bytes = model::write_template(part, bytes);
    if (!size_bytes) return false;
    Fnv1a64 hash;
    hash.add(std::span<const std::byte>(bytes).first(*size_bytes));
    std::printf("template %-9s %d scans        %016llx\n", name, report.scan_count_used,
                static_cast<unsigned long long>(hash.value()));
    return true;
  }

  bool locate(const model::Template& part, const char* name, const sim::SimulatedScan& scan) {
    locate::LocateConfig config;
    config.max_matches = kMatchesMax;
    locate::Locator locator;
    locate::LocateResult result;
    if (locator.init(limits_, memory_) != Status::kOk ||
        locator.locate(part, scan.view(), frames_of_scan(true), config, Host{clock_, workers_},
                       result) != Status::kOk)
      return false;
    std::printf("located  %-9s %2d of %7lld hypotheses  %016llx\n", name, result.match_count,
                static_cast<long long>(result.hypothesis_count),
                static_cast<unsigned long long>(locate::digest(result)));
    return true;
  }

  locate::Limits limits_{300, 250, 400'000};
  std::vector<std::byte> memory_;
  StoppedClock clock_;
  port::WorkerPool workers_;
};

}  // namespace

int main(int count, char** words) {
  std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);
  const std::string word = count > 1 ? words[1] : "best";
  const int thread_count = count > 2 ? std::atoi(words[2]) : 1;
  const std::string only = count > 3 ? words[3] : "";
  VectorPath path = port::best_vector_path();
  if (word == "portable") path = VectorPath::kPortable;
  if (word == "avx2") path = VectorPath::kAvx2;
  if (word == "avx512") path = VectorPath::kAvx512;
  Machine machine(path, thread_count);
  for (const Case& one : kCases) {
    if ((!only.empty() && only != one.part) || machine.run(one)) continue;
    std::fprintf(stderr, "flatpose_digests: '%s' failed\n", one.part);
    return 1;
  }
}
