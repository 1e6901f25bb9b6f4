#include "port/sim/heaping.hpp"

#include <algorithm>
#include <cmath>

#include "port/sim/underside.hpp"

namespace flatpose::sim {
namespace {

constexpr double kHeapHeightMaxMm = 130.0;  // what comes to rest higher falls off
constexpr int kPlacesTriedMax = 60;         // for a part

bool lies_on_face(const Instance& instance) {
  return instance.scan_T_object.rotation.column(2).z < 0.0;
}

}  // namespace

Heaping::Heaping(Layout& layout) : layout_(layout), visible_(heap_.world(), layout.ruler) {
  for (const Instance& fixture : layout.result.fixtures) heap_.add(fixture);
}

Spread Heaping::spread(const std::vector<Item>& items, double layers) const {
  double area = 0.0;
  for (const Item& item : items) area += area_mm2(*item.part);
  const SensorConfig& field = layout_.ruler.config();
  const double aspect = field.field_x_mm / field.field_y_mm;
  const double semi_y_mm = std::sqrt(area / layers / kPi / aspect);
  return {{}, aspect * semi_y_mm, semi_y_mm, false};
}

bool Heaping::drop(const Item& item, const Spread& spread, const Judge& judge,
                   double tilt_max_rad) {
  for (int i = 0; i < kPlacesTriedMax; ++i) {
    // Where the middle is full the heap grows wider.
    const double wider = 1.0 + static_cast<double>(i) / kPlacesTriedMax;
    const Vec2 place_mm = spread.middle_mm + wider * place(spread);
    const double turn_rad = layout_.random.uniform(-kPi, kPi);
    if (drop_at(item, place_mm, turn_rad, judge, tilt_max_rad)) return true;
  }
  return false;
}

bool Heaping::drop_at(const Item& item, Vec2 place_mm, double turn_rad, const Judge& judge,
                      double tilt_max_rad) {
  const Drop drop{item.part, place_mm.x, place_mm.y, turn_rad, item.upside_down};
  const auto rest = settle(heap_, drop, tilt_max_rad);
  if (!rest) return false;
  const Instance instance{item.part, rest->scan_T_object};
  if (rest->center_of_mass_mm.z > kHeapHeightMaxMm || !layout_.inside(instance)) return false;
  heap_.add(instance);
  layout_.result.instances.push_back(instance);
  if (!judge || judge(*rest)) return true;
  remove_last();
  return false;
}

double Heaping::shown(const Item& item, int samples, double enough) {
  double most = 0.0;
  // From the last one, which is the likeliest.
  const auto& instances = layout_.result.instances;
  for (auto i = instances.rbegin(); i != instances.rend() && most < enough; ++i) {
    if (i->part != item.part || lies_on_face(*i) != item.upside_down) continue;
    most = std::max(most, visible_.of(top_of(*i), samples));
  }
  return most;
}

/// What of it looks up, as a part of its own; the same one for the same part.
Instance Heaping::top_of(const Instance& instance) {
  if (!lies_on_face(instance)) return instance;
  Instance top = underside(instance);
  auto& part = undersides_[instance.part];
  if (!part) part = top.part;
  top.part = part;
  return top;
}

void Heaping::clear() {
  while (!layout_.result.instances.empty()) remove_last();
}

void Heaping::remove_last() {
  heap_.remove_last();
  layout_.result.instances.pop_back();
}

Vec2 Heaping::place(const Spread& spread) {
  Random& random = layout_.random;
  if (spread.toward_middle) {
    const auto normal = random.normal_pair();
    return {spread.semi_x_mm * normal.first, spread.semi_y_mm * normal.second};
  }
  const double radius = std::sqrt(random.uniform());
  const auto [s, c] = sin_cos(random.uniform(-kPi, kPi));
  return {spread.semi_x_mm * radius * c, spread.semi_y_mm * radius * s};
}

}  // namespace flatpose::sim
