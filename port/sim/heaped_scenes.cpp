// Scenes whose parts lie on each other. Parts are let down one by one, each at a place of its own
// about the field's middle, and come to rest on what lies there already (settle.hpp). A place where
// a part would slide off, leave the field or hide what the scene must show is not taken.

#include <algorithm>
#include <cmath>

#include "port/sim/layout.hpp"
#include "port/sim/settle.hpp"
#include "port/sim/visible.hpp"

namespace flatpose::sim {
namespace {

constexpr double kSlideRad = 25.0 * kRadPerDeg;  // what leans more slides down (friction 0.47)
constexpr double kShownMin = 0.6;
constexpr double kQuickSamples = 500.0;
constexpr double kQuickError = 0.03;        // of a share that so many samples give
constexpr double kHeapHeightMaxMm = 130.0;  // what comes to rest higher falls off
constexpr int kPlacesTriedMax = 60;         // for a part
constexpr int kLayoutsTriedMax = 20;

/// Where parts are let down: about the middle, in an ellipse as wide for its depth as the field.
struct Spread {
  double semi_x_mm;
  double semi_y_mm;
  bool toward_middle;  ///< Normally distributed with the semi-axes as sigmas; else evenly.
};

class Heaping {
 public:
  explicit Heaping(Layout& layout) : layout_(layout) {
    for (const Instance& fixture : layout.result.fixtures) heap_.add(fixture);
  }

  /// The ellipse in which the parts, laid evenly, would lie `layers` deep.
  Spread spread(const std::vector<std::shared_ptr<const Part>>& parts, double layers) const {
    double area = 0.0;
    for (const auto& part : parts) area += area_mm2(*part);
    const SensorConfig& field = layout_.ruler.config();
    const double aspect = field.field_x_mm / field.field_y_mm;
    const double semi_y_mm = std::sqrt(area / layers / kPi / aspect);
    return {aspect * semi_y_mm, semi_y_mm, false};
  }

  /// Lets the part down until it has found a place that will do.
  template <class WillDo>
  bool drop(const std::shared_ptr<const Part>& part, const Spread& spread, WillDo will_do) {
    for (int i = 0; i < kPlacesTriedMax; ++i) {
      // Where the middle is full the heap grows wider.
      const Vec2 p_mm = (1.0 + static_cast<double>(i) / kPlacesTriedMax) * place(spread);
      const Drop drop{part, p_mm.x, p_mm.y, layout_.random.uniform(-kPi, kPi), false};
      const auto rest = settle(heap_, drop, kSlideRad);
      if (!rest) continue;
      const Instance instance{part, rest->scan_T_object};
      if (rest->center_of_mass_mm.z > kHeapHeightMaxMm || !layout_.inside(instance)) continue;
      add(instance);
      if (will_do()) return true;
      remove_last();
    }
    return false;
  }
  bool drop(const std::shared_ptr<const Part>& part, const Spread& spread) {
    return drop(part, spread, [] { return true; });
  }

  /// Whether a target shows as much as the scene promises.
  [[nodiscard]] bool shows_target(double samples, double share_min) const {
    return std::any_of(layout_.result.instances.begin(), layout_.result.instances.end(),
                       [&](const Instance& instance) {
                         return instance.part == layout_.target &&
                                visible_share(heap_.world(), layout_.ruler, instance, samples) >=
                                    share_min;
                       });
  }

  void clear() {
    while (!layout_.result.instances.empty()) remove_last();
  }

 private:
  void add(const Instance& instance) {
    heap_.add(instance);
    layout_.result.instances.push_back(instance);
  }
  void remove_last() {
    heap_.remove_last();
    layout_.result.instances.pop_back();
  }

  Vec2 place(const Spread& spread) {
    Random& random = layout_.random;
    if (spread.toward_middle) {
      const auto normal = random.normal_pair();
      return {spread.semi_x_mm * normal.first, spread.semi_y_mm * normal.second};
    }
    const double radius = std::sqrt(random.uniform());
    const auto [s, c] = sin_cos(random.uniform(-kPi, kPi));
    return {spread.semi_x_mm * radius * c, spread.semi_y_mm * radius * s};
  }

  Layout& layout_;
  Heap heap_;
};

/// Lays out again, from the next random numbers, until the scene holds what it promises.
template <class LayOut>
void lay_out(Layout& layout, LayOut once) {
  Heaping heaping(layout);
  for (int i = 0; i < kLayoutsTriedMax; ++i) {
    if (once(heaping) && heaping.shows_target(kTruthSamples, kShownMin)) {
      // Targets first, as in the other scenes.
      auto& instances = layout.result.instances;
      std::stable_partition(instances.begin(), instances.end(), [&](const Instance& instance) {
        return instance.part == layout.target;
      });
      return;
    }
    heaping.clear();
  }
  layout.no_room("a heap that shows the target");
}

/// `count` of what lies about the target, each as often as any other.
std::vector<std::shared_ptr<const Part>> others(Layout& layout, int count) {
  const std::vector<std::string> names = layout.other_names();
  std::vector<std::shared_ptr<const Part>> drawn;
  for (int i = 0; i < count; ++i) {
    drawn.push_back(layout.part(names[layout.random.index(static_cast<int>(names.size()))]));
  }
  return drawn;
}

/// `under` others, two targets among the last of them, then `over` others that leave a target in
/// sight.
bool clutter(Heaping& heaping, Layout& layout, int under, int over, double layers) {
  constexpr int kTargets = 2;
  auto parts = others(layout, under + over);
  for (int i = 0; i < kTargets; ++i) {
    const int last = under + i;
    const int first = std::max(0, last - 4);
    const int at = first + layout.random.index(last - first + 1);
    parts.insert(parts.begin() + at, layout.target);
  }
  const Spread spread = heaping.spread(parts, layers);
  int targets = 0;
  for (const auto& part : parts) {
    if (part == layout.target) ++targets;
    const bool placed = heaping.drop(part, spread, [&] {
      return targets < kTargets || heaping.shows_target(kQuickSamples, kShownMin + kQuickError);
    });
    if (!placed) return false;
  }
  return true;
}

}  // namespace

void build_medium(Layout& layout) {
  lay_out(layout, [&](Heaping& heaping) { return clutter(heaping, layout, 4, 3, 0.75); });
}

void build_high(Layout& layout) {
  lay_out(layout, [&](Heaping& heaping) {
    const int count = 18 + layout.random.index(5);
    return clutter(heaping, layout, count - 8, 8, 1.2);
  });
}

void build_pile(Layout& layout) {
  constexpr double kMiddleLayers = 2.6;
  lay_out(layout, [&](Heaping& heaping) {
    const int count = 18 + layout.random.index(5);
    const std::vector<std::shared_ptr<const Part>> parts(count, layout.target);
    Spread spread = heaping.spread(parts, 2.0 * kMiddleLayers);
    spread.toward_middle = true;
    for (const auto& part : parts) {
      if (!heaping.drop(part, spread)) return false;
    }
    return true;
  });
}

}  // namespace flatpose::sim
