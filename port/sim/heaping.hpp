#pragma once
// Lays out heaps: lets parts down one by one, each at a place of its own about the field's middle,
// to rest on what lies there already (settle.hpp). A place where a part would slide off, leave the
// field or hide what the scene must show is not taken.

#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "port/sim/layout.hpp"
#include "port/sim/settle.hpp"
#include "port/sim/visible.hpp"

namespace flatpose::sim {

/// What leans more slides down (friction 0.47).
inline constexpr double kSlideRad = 25.0 * kRadPerDeg;

/// Where parts are let down: about a middle, in an ellipse.
struct Spread {
  Vec2 middle_mm;
  double semi_x_mm = 0.0;
  double semi_y_mm = 0.0;
  bool toward_middle = false;  ///< Normally distributed with the semi-axes as sigmas; else evenly.
};

struct Item {
  std::shared_ptr<const Part> part;
  bool upside_down = false;
};

class Heaping {
 public:
  /// Whether a part that has come to rest may stay.
  using Judge = std::function<bool(const Rest& rest)>;

  explicit Heaping(Layout& layout);

  /// The ellipse, of the field's shape, in which the parts laid evenly would be `layers` deep.
  [[nodiscard]] Spread spread(const std::vector<Item>& items, double layers) const;

  /// Lets the part down here and there until it has found a place that will do.
  bool drop(const Item& item, const Spread& spread, const Judge& judge = {},
            double tilt_max_rad = kSlideRad);
  /// Lets it down at one place only.
  bool drop_at(const Item& item, Vec2 place_mm, double turn_rad, const Judge& judge = {},
               double tilt_max_rad = kSlideRad);

  /// The largest share seen of a part of this kind that lies with this side up.
  /// Cost: 0.5 us a sample and part, until one shows `enough`.
  [[nodiscard]] double shown(const Item& item, int samples, double enough);

  void clear();

 private:
  void remove_last();
  Instance top_of(const Instance& instance);
  Vec2 place(const Spread& spread);

  Layout& layout_;
  Heap heap_;
  VisibleShare visible_;
  std::map<std::shared_ptr<const Part>, std::shared_ptr<const Part>> undersides_;
};

}  // namespace flatpose::sim
