#include "bench/scenes/sensors.hpp"

#include <stdexcept>

namespace flatpose::bench {
namespace {

struct Entry {
  const char* name;
  void (*change)(sim::SensorConfig&);
};

constexpr Entry kEntries[] = {
    {"standard", [](sim::SensorConfig&) {}},
    {"noise",
     [](sim::SensorConfig& sensor) {
       sensor.laser_noise_mm = 1.0;
       sensor.camera_noise_mm = 0.3;
     }},
    {"lost", [](sim::SensorConfig& sensor) { sensor.lost_share = 0.2; }},
    {"half",
     [](sim::SensorConfig& sensor) {
       sensor.columns = 300;
       sensor.rows = 250;
     }},
};

}  // namespace

const std::vector<std::string>& sensor_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const Entry& entry : kEntries) list.emplace_back(entry.name);
    return list;
  }();
  return names;
}

sim::SensorConfig sensor_named(const std::string& name) {
  std::string known;
  for (const Entry& entry : kEntries) {
    sim::SensorConfig sensor;
    entry.change(sensor);
    if (name == entry.name) return sensor;
    known += (known.empty() ? "" : ", ") + std::string(entry.name);
  }
  throw std::invalid_argument("unknown sensor '" + name + "'; sensors: " + known);
}

}  // namespace flatpose::bench
