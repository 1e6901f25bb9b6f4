#include "bench/speed/shots.hpp"

#include <future>
#include <map>

namespace flatpose::bench {
namespace {

Shot take(const std::string& scene, const std::string& part, const ScanSize& size, int seed) {
  ShotConfig config;
  config.scene.scene = scene;
  config.scene.part = part;
  config.sensor.columns = size.columns;
  config.sensor.rows = size.rows;
  config.seed = static_cast<std::uint64_t>(seed);
  return take_shot(config);
}

}  // namespace

const std::vector<Shot>& shots_of(const std::string& scene, const std::string& part,
                                  const ScanSize& size, int count) {
  static std::map<std::string, std::vector<Shot>> kept;
  std::vector<Shot>& shots = kept[scene + "/" + part + "/" + size.name];
  while (static_cast<int>(shots.size()) < count) {
    const int seed = static_cast<int>(shots.size());
    auto other =
        std::async(std::launch::async, [&, seed] { return take(scene, part, size, seed + 1); });
    shots.push_back(take(scene, part, size, seed));
    shots.push_back(other.get());
  }
  return shots;
}

const Taught& taught(const std::string& part) {
  static std::map<std::string, Taught> kept;
  const auto found = kept.find(part);
  if (found != kept.end()) return found->second;
  return kept.emplace(part, teach_part(part, {})).first->second;
}

std::string part_in(const std::string& scene) {
  return scene.rfind("cyl_", 0) == 0 ? "cylinder" : "pad";
}

}  // namespace flatpose::bench
