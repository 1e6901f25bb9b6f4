#include "bench/scenes/lesson.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

#include "port/linux/tool/engine.hpp"

namespace flatpose::bench {

tool::LoadedScan as_loaded(sim::SimulatedScan&& scan) {
  tool::LoadedScan loaded;
  loaded.path = scan.scene + ", seed " + std::to_string(scan.seed);
  loaded.scan.xyz_mm = std::move(scan.xyz_mm);
  loaded.scan.width_px = scan.width_px;
  loaded.scan.height_px = scan.height_px;
  loaded.scan.up = port::Up::kPlusZ;
  loaded.scan.up_reason = "viewpoint";
  loaded.scan.viewpoint_mm = scan.viewpoint_mm;
  loaded.frames = frames_of_scan(true);
  return loaded;
}

Taught teach_part(const std::string& part, const sim::SensorConfig& sensor,
                  std::span<const std::uint64_t> seeds) {
  sim::SceneConfig scene;
  scene.scene = "single";
  scene.part = part;
  std::vector<tool::LoadedScan> loaded;
  Pose scan_T_part;
  for (const std::uint64_t seed : seeds) {
    sim::SimulatedScan scan = sim::simulate(scene, sensor, seed);
    if (loaded.empty()) scan_T_part = scan.instances.front().scan_T_object;
    loaded.push_back(as_loaded(std::move(scan)));
  }
  std::vector<teach::TeachScan> scans;
  for (const tool::LoadedScan& one : loaded) scans.push_back({one.scan.view(), one.frames});

  Taught taught;
  taught.fold = sim::catalogue_part(part).symmetry_fold;
  teach::TeachConfig config;
  part.copy(config.name.data(), model::kNameBytesMax);
  config.symmetry_order = taught.fold == 0 ? model::kFullSymmetry : taught.fold;
  const locate::Limits limits = tool::limits_for(loaded.front().scan);
  tool::Memory memory(teach::Teacher::required_bytes(limits));
  teach::Teacher teacher;
  Status status = teacher.init(limits, memory.span());
  if (status == Status::kOk) status = teacher.teach(scans, config, taught.part, taught.report);
  if (status != Status::kOk) throw std::runtime_error("teach '" + part + "': " + to_string(status));
  taught.object_T_part = taught.part.scan_T_object.inverse() * scan_T_part;
  return taught;
}

}  // namespace flatpose::bench
