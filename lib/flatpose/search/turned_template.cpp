#include "flatpose/search/turned_template.hpp"

#include <algorithm>
#include <array>

#include "flatpose/core/maths.hpp"
#include "flatpose/search/places.hpp"

namespace flatpose::search {
namespace {

// As many neighbouring angles as move the farthest point by less than the nodes' slack.
int group_size(const NodeImages& nodes, double reach_px, int angle_count, int most) noexcept {
  if (nodes.side == 0 || nodes.slack == 0 || angle_count < 2) return 1;
  const double step_px = 2.0 * kPi * reach_px / angle_count;  // at most
  return std::clamp(1 + static_cast<int>(nodes.slack / step_px), 1, most);
}

}  // namespace

Turner::Turner(const SearchImages& images, const Projector& projector, const Turns& turns) noexcept
    : images_(images),
      projector_(projector),
      turns_(turns),
      offsets_(images.lattice),
      node_offsets_(images.nodes.side > 0 ? images.nodes.lattice : images.lattice),
      group_size_(search::group_size(images.nodes, projector.reach_px(),
                                     static_cast<int>(turns.of_angle.size()), kGroupSizeMax)) {}

void Turner::turn(int bin, TurnedTemplate& out) const noexcept {
  const Tilt tilt = tilt_of(slope_x_of_bin(bin), slope_y_of_bin(bin));
  const int angle_count = static_cast<int>(turns_.of_angle.size());
  std::int32_t worst = 0;
  int group_count = 0;
  for (int first = 0; first < angle_count; first += group_size_) {
    std::array<ProjectedTemplate, kGroupSizeMax> projected;
    const int count = std::min(group_size_, angle_count - first);
    for (int i = 0; i < count; ++i) {
      projected[i] = projector_.at(tilt, turns_.of_angle[first + i]);
      shift(projected[i], images_, offsets_, out.angles[first + i]);
      worst = std::max(worst, cost_max(images_, projected[i]));
    }
    if (images_.nodes.side > 0)
      group({projected.data(), static_cast<std::size_t>(count)}, out.groups[group_count++]);
  }
  out.angles = {out.angles.data(), static_cast<std::size_t>(angle_count)};
  out.groups = {out.groups.data(), static_cast<std::size_t>(group_count)};
  out.group_size = group_size_;
  out.rises = rise_range(out.angles);
  const std::int32_t share = static_cast<std::int32_t>(worst * turns_.cost_share_max);
  const std::int32_t cutoff = std::min({share, turns_.threshold + 1, kCostMax});
  out.is_limited = cutoff < std::min(share, kCostMax);
  const std::int32_t factor_q8 = angle_count > 0 ? out.angles[0].edge_factor_q8 : 256;
  out.cutoff = static_cast<std::uint8_t>(cutoff);
  out.edge_limit = static_cast<std::uint8_t>((cutoff * 256 + factor_q8 - 1) / factor_q8);
}

// The i-th points of the angles, whichever of the template's they are, lie in one window of the
// node images; where they do not, or in several images, the group goes without.
void Turner::group(std::span<const ProjectedTemplate> angles, GroupTemplate& out) const noexcept {
  const auto image_bytes = static_cast<std::int32_t>(images_.nodes.lattice.image_bytes());
  int count = kContourCountMax;
  for (const ProjectedTemplate& t : angles) count = std::min(count, t.contour_count);
  out.contour_count = 0;
  for (int i = 0; i < count; ++i) {
    ProjectedTemplate::Contour low = angles[0].contour[i];
    ProjectedTemplate::Contour high = low;
    bool is_one_image = true;
    for (const ProjectedTemplate& t : angles) {
      const ProjectedTemplate::Contour& p = t.contour[i];
      low.dx = std::min(low.dx, p.dx);
      low.dy = std::min(low.dy, p.dy);
      low.rise_unit = std::min(low.rise_unit, p.rise_unit);
      high.dx = std::max(high.dx, p.dx);
      high.dy = std::max(high.dy, p.dy);
      is_one_image = is_one_image && (p.octant == low.octant || !images_.config.use_directions);
    }
    const int slack = images_.nodes.slack;
    if (!is_one_image || high.dx - low.dx > slack || high.dy - low.dy > slack) continue;
    const std::int32_t shift = node_offsets_.offset_bytes(low.dx, low.dy);
    ShiftedPoint& to = out.contour[out.contour_count++];
    to.offset_bytes = (images_.config.use_directions ? low.octant : 0) * image_bytes + shift;
    to.second_offset_bytes = NodeImages::kHeightImage * image_bytes + shift;
    to.rise_row_bytes = rise_row_bytes(low.rise_unit);
  }
}

}  // namespace flatpose::search
