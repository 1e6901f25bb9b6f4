// Scenes whose parts lie on each other.

#include <algorithm>

#include "port/sim/heaping.hpp"
#include "port/sim/layout.hpp"
#include "port/sim/underside.hpp"
#include "port/sim/visible.hpp"

namespace flatpose::sim {
namespace {

constexpr double kShownMin = 0.6;
constexpr int kQuickSamples = 500;
constexpr double kQuickError = 0.03;  // of a share that so many samples give
constexpr int kLayoutsTriedMax = 20;

/// Clutter: how many others, how many of them on top of what the scene must show, and how deep all
/// would lie if laid evenly.
struct Density {
  int others;
  int over;
  double layers;
};
constexpr Density kMedium{7, 3, 0.75};
Density high(Random& random) { return {18 + random.index(5), 8, 1.2}; }

/// Lays out again, from the next random numbers, until the scene holds what it promises.
template <class LayOut>
void lay_out(Layout& layout, LayOut once) {
  Heaping heaping(layout);
  for (int i = 0; i < kLayoutsTriedMax; ++i) {
    if (once(heaping)) {
      // Targets first, as in the other scenes.
      auto& instances = layout.result.instances;
      std::stable_partition(instances.begin(), instances.end(), [&](const Instance& instance) {
        return instance.part == layout.target;
      });
      return;
    }
    heaping.clear();
  }
  layout.no_room("a heap that shows what it must");
}

/// `count` of what lies about the target, each as often as any other.
std::vector<Item> others(Layout& layout, int count) {
  const std::vector<std::string> names = layout.other_names();
  std::vector<Item> drawn;
  for (int i = 0; i < count; ++i) {
    const int pick = layout.random.index(static_cast<int>(names.size()));
    drawn.push_back({layout.part(names[pick])});
  }
  return drawn;
}

/// Whether all of the kinds show enough, each by one of its instances.
bool shows(Heaping& heaping, const std::vector<Item>& kinds, int samples, double share_min) {
  return std::all_of(kinds.begin(), kinds.end(), [&](const Item& kind) {
    return heaping.shown(kind, samples, share_min) >= share_min;
  });
}

/// Clutter with two of each of `kinds` among it, the last of which has others on top; one of each
/// kind shows at least kShownMin.
bool clutter(Heaping& heaping, Layout& layout, const Density& density,
             const std::vector<Item>& kinds) {
  constexpr int kOfEach = 2;
  constexpr int kAmongLast = 5;
  std::vector<Item> items = others(layout, density.others);
  int after = density.others - density.over;  // of the last of the kinds
  for (const Item& kind : kinds) {
    for (int i = 0; i < kOfEach; ++i) {
      const int first = std::max(0, after - kAmongLast + 1);
      items.insert(items.begin() + first + layout.random.index(after - first + 1), kind);
      ++after;
    }
  }
  const Spread spread = heaping.spread(items, density.layers);
  const auto count = static_cast<int>(items.size());
  for (int i = 0; i < count; ++i) {
    const bool all_in = i + 1 >= after;
    const auto judge = [&](const Rest&) {
      return !all_in || shows(heaping, kinds, kQuickSamples, kShownMin + kQuickError);
    };
    if (!heaping.drop(items[i], spread, judge)) return false;
  }
  return shows(heaping, kinds, kTruthSamples, kShownMin);
}

/// What one could take for the target: the pad of another car, and the target on its face.
std::vector<Item> decoys(Layout& layout) {
  std::vector<Item> kinds;
  if (layout.target->name == "pad") kinds.push_back({layout.part("lookalike")});
  if (layout.target->name == "lookalike") kinds.push_back({layout.part("pad")});
  if (!same_upside_down(*layout.target)) kinds.push_back({layout.target, true});
  return kinds;
}

/// A stack of equal others at least `height_mm` high, for something to lean on.
std::optional<Instance> stack(Heaping& heaping, Layout& layout, double height_mm) {
  constexpr int kLevelsMax = 16;
  constexpr double kLevelRad = 8.0 * kRadPerDeg;
  constexpr double kThinMm = 5.0;
  std::vector<std::string> names = layout.other_names();
  std::erase_if(names, [&](const std::string& name) {
    return layout.part(name)->thickness_mm < kThinMm || !layout.part(name)->areas.empty();
  });
  Random& random = layout.random;
  const Item item{layout.part(names[random.index(static_cast<int>(names.size()))])};
  const Spread anywhere = heaping.spread({item}, 0.3);
  if (!heaping.drop(item, anywhere, {}, kLevelRad)) return std::nullopt;
  const Instance lowest = layout.result.instances.back();
  const Vec3 place_mm = lowest.scan_T_object.position_mm;
  const Vec3 x = lowest.scan_T_object.rotation.column(0);
  for (int level = 1; level < kLevelsMax; ++level) {
    const Instance top = layout.result.instances.back();
    if (top.scan_T_object.position_mm.z >= height_mm) return top;
    const double turn_rad = arc_tangent(x.y, x.x) + random.uniform(-0.08, 0.08);
    const Vec2 p_mm{place_mm.x + random.uniform(-2.0, 2.0), place_mm.y + random.uniform(-2.0, 2.0)};
    if (!heaping.drop_at(item, p_mm, turn_rad, {}, kLevelRad)) return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace

void build_medium(Layout& layout) {
  lay_out(layout,
          [&](Heaping& heaping) { return clutter(heaping, layout, kMedium, {{layout.target}}); });
}

void build_high(Layout& layout) {
  lay_out(layout, [&](Heaping& heaping) {
    return clutter(heaping, layout, high(layout.random), {{layout.target}});
  });
}

void build_pile(Layout& layout) {
  constexpr double kMiddleLayers = 2.6;
  lay_out(layout, [&](Heaping& heaping) {
    const std::vector<Item> items(18 + layout.random.index(5), Item{layout.target});
    Spread spread = heaping.spread(items, 2.0 * kMiddleLayers);
    spread.toward_middle = true;
    return std::all_of(items.begin(), items.end(),
                       [&](const Item& item) { return heaping.drop(item, spread); }) &&
           shows(heaping, {items[0]}, kTruthSamples, kShownMin);
  });
}

void build_absent(Layout& layout) {
  const std::vector<Item> kinds = decoys(layout);
  lay_out(layout, [&](Heaping& heaping) {
    const Density density = layout.random.index(2) == 0 ? kMedium : high(layout.random);
    return clutter(heaping, layout, density, kinds);
  });
}

void build_steep(Layout& layout) {
  constexpr double kLeanMinRad = 20.0 * kRadPerDeg;
  constexpr double kLeanMaxRad = 45.0 * kRadPerDeg;
  const Item target{layout.target};
  lay_out(layout, [&](Heaping& heaping) {
    if (!clutter(heaping, layout, kMedium, {})) return false;
    const auto block = stack(heaping, layout, layout.random.uniform(30.0, 65.0));
    if (!block) return false;
    const double reach_mm = radius_mm(*block->part) + 0.7 * radius_mm(*target.part);
    const Spread about_block{
        {block->scan_T_object.position_mm.x, block->scan_T_object.position_mm.y},
        0.7 * reach_mm,
        0.7 * reach_mm,
        false};
    const auto leans_and_shows = [&](const Rest& rest) {
      return rest.tilt_rad >= kLeanMinRad &&
             heaping.shown(target, kQuickSamples, 1.0) >= kShownMin + kQuickError;
    };
    return heaping.drop(target, about_block, leans_and_shows, kLeanMaxRad) &&
           shows(heaping, {target}, kTruthSamples, kShownMin);
  });
}

void build_buried(Layout& layout) {
  constexpr double kBuriedMin = 0.5;
  constexpr double kBuriedMax = 0.8;
  constexpr int kCoversMax = 8;
  const Item target{layout.target};
  lay_out(layout, [&](Heaping& heaping) {
    if (!clutter(heaping, layout, kMedium, {})) return false;
    if (!heaping.drop(target, heaping.spread(others(layout, 7), 1.2))) return false;
    const Vec3 target_mm = layout.result.instances.back().scan_T_object.position_mm;
    const double goal =
        layout.random.uniform(kBuriedMin + 2.0 * kQuickError, kBuriedMax - kQuickError);
    const auto shown = [&] { return heaping.shown(target, kQuickSamples, 1.0); };
    const auto leaves_enough = [&](const Rest&) { return shown() >= kBuriedMin + kQuickError; };
    for (int i = 0; i < kCoversMax && shown() > goal; ++i) {
      const Item cover = others(layout, 1).front();
      const double reach_mm = radius_mm(*target.part) + 0.5 * radius_mm(*cover.part);
      const Spread about{{target_mm.x, target_mm.y}, reach_mm, reach_mm, false};
      if (!heaping.drop(cover, about, leaves_enough)) return false;
    }
    const double share = heaping.shown(target, kTruthSamples, 1.0);
    return share >= kBuriedMin && share <= kBuriedMax;
  });
}

}  // namespace flatpose::sim
