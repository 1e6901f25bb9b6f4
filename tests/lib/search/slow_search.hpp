#pragma once
// Every place of every bin, every angle, with the scalar cost, and the local minima of that: what
// the grid search must give, candidate by candidate.

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <vector>

#include "flatpose/search/grid_search.hpp"

namespace flatpose::search {

class SlowSearch {
 public:
  SlowSearch(const SearchImages& images, const TiltField& field, const Places& places,
             const model::Template& part, const GridSearchConfig& config)
      : images_(images),
        field_(field),
        places_(places),
        part_(part),
        config_(config),
        range_rad_(angle_range_rad(part.symmetry, part.anchors[0])),
        angles_(angle_count(range_rad_, config.angle_step_rad)) {
    for (int row = 0; row < places.height; ++row) {
      for (int column = 0; column < places.width; ++column) {
        if (places.is_place(column, row)) evaluate(column, row);
      }
    }
  }

  /// Without their poses; best first.
  [[nodiscard]] std::vector<Candidate> candidates() const {
    std::vector<Candidate> all;
    for (const Best& best : best_) {
      if (is_local_minimum(best)) all.push_back(candidate(best));
    }
    std::sort(all.begin(), all.end(), [](const Candidate& a, const Candidate& b) {
      return std::tie(a.cost_q10, a.row, a.column, a.angle_index) <
             std::tie(b.cost_q10, b.row, b.column, b.angle_index);
    });
    for (Candidate& c : all) c.cost_q10 = share_q10(c);
    return all;
  }
  [[nodiscard]] int angles() const { return angles_; }

 private:
  struct Best {
    std::int32_t cost;
    int row, column, angle;
  };

  const std::vector<ProjectedTemplate>& turned_to(int bin) {
    std::vector<ProjectedTemplate>& turned = by_bin_[bin];
    for (int angle = static_cast<int>(turned.size()); angle < angles_; ++angle)
      turned.push_back(turned_to(slope_x_of_bin(bin), slope_y_of_bin(bin), angle));
    return turned;
  }
  [[nodiscard]] ProjectedTemplate turned_to(double slope_x, double slope_y, int angle) const {
    return project(part_, part_.anchors[0], slope_x, slope_y, range_rad_ * angle / angles_, images_,
                   config_.score);
  }

  /// The best of each quarter of the angles, the first of equals, if below the share of the worst.
  void evaluate(int column, int row) {
    const std::size_t place = places_.index(column, row);
    const auto& turned = turned_to(places_.bin[place]);
    std::int32_t worst = 0;
    for (const auto& t : turned) worst = std::max(worst, cost_max(images_, t));
    const auto limit = static_cast<std::int32_t>(worst * config_.cost_share_max);
    std::vector<Best> best(4, Best{std::min(255, limit), row, column, -1});
    for (int angle = 0; angle < angles_; ++angle) {
      Best& so_far = best[static_cast<std::size_t>(4 * angle / angles_)];
      const std::int32_t now =
          cost(images_, turned[static_cast<std::size_t>(angle)], column * stride_px(),
               row * stride_px(), places_.height_unit[place]);
      if (now < so_far.cost) so_far = {now, row, column, angle};
    }
    for (const Best& b : best) {
      if (b.angle >= 0) best_.push_back(b);
    }
  }

  [[nodiscard]] bool is_local_minimum(const Best& best) const {
    return std::none_of(best_.begin(), best_.end(), [&](const Best& rival) {
      const int turn = std::abs(rival.angle - best.angle);
      if (std::abs(rival.row - best.row) > 2 || std::abs(rival.column - best.column) > 2 ||
          std::min(turn, angles_ - turn) > 2)
        return false;
      return std::tie(rival.cost, rival.row, rival.column, rival.angle) <
             std::tie(best.cost, best.row, best.column, best.angle);
    });
  }

  [[nodiscard]] Candidate candidate(const Best& best) const {
    Candidate c;
    c.cost_q10 = best.cost;
    c.angle_index = best.angle;
    c.column = static_cast<std::int16_t>(best.column * stride_px());
    c.row = static_cast<std::int16_t>(best.row * stride_px());
    return c;
  }
  /// Of the worst at the place's own tilt, which is not its bin's.
  [[nodiscard]] std::int32_t share_q10(const Candidate& c) const {
    const ProjectedTemplate own =
        turned_to(field_.slope_x(c.column, c.row), field_.slope_y(c.column, c.row), c.angle_index);
    return c.cost_q10 * 1024 / std::max(1, cost_max(images_, own));
  }
  [[nodiscard]] int stride_px() const { return images_.lattice.stride_px; }

  const SearchImages& images_;
  const TiltField& field_;
  const Places& places_;
  const model::Template& part_;
  const GridSearchConfig& config_;
  double range_rad_;
  int angles_;
  std::map<int, std::vector<ProjectedTemplate>> by_bin_;
  std::vector<Best> best_;
};

}  // namespace flatpose::search
