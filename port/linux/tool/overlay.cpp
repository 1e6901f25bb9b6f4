#include "port/linux/tool/overlay.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <span>

#include "port/linux/files/input_error.hpp"
#include "port/linux/tool/canvas.hpp"
#include "port/linux/tool/legend.hpp"

namespace flatpose::tool {
namespace {

constexpr int kSide_px = 1200;
constexpr int kWidthMin_px = 720;
constexpr int kHeightMin_px = 240;
constexpr std::size_t kTitleBytesMax = 200;

constexpr Colour kDark{0.04, 0.05, 0.06};
constexpr Colour kContour{1.0, 0.72, 0.10};
constexpr Colour kSurface{0.30, 0.85, 0.95};
constexpr Colour kAnchor{0.95, 0.35, 0.85};

struct Place {
  double x = 0.0;
  double y = 0.0;
};

/// Where the map stands on the paper.
struct Sheet {
  rectify::Grid grid;
  double scale = 1.0;  // pixels of the picture a cell
  double left = 0.0;
  double top = 0.0;
  double width = 0.0;
  double height = 0.0;

  [[nodiscard]] Place place(const Vec3& p_work_mm) const noexcept {
    return {left + (grid.column_of(p_work_mm.x) + 0.5) * scale,
            top + (grid.height_px - 0.5 - grid.row_of(p_work_mm.y)) * scale};
  }
  [[nodiscard]] double px_per_mm() const noexcept { return scale / grid.cell_mm; }
};

/// How far a contour point's dash reaches along its tangent, to either side.
struct Dash {
  double ahead_mm = 0.0;
  double behind_mm = 0.0;
};

double distance_mm(const model::ContourPoint& p, const model::ContourPoint& q) {
  return std::hypot(static_cast<double>(q.x_mm - p.x_mm), static_cast<double>(q.y_mm - p.y_mm));
}

// Where contours meet points crowd; the median is the distance along a contour.
double spacing_mm(std::span<const model::ContourPoint> points) {
  std::vector<double> nearest;
  for (const model::ContourPoint& p : points) {
    double least = std::numeric_limits<double>::max();
    for (const model::ContourPoint& q : points) {
      if (&p != &q) least = std::min(least, distance_mm(p, q));
    }
    nearest.push_back(least);
  }
  if (nearest.empty()) return 0.0;
  const auto middle = nearest.begin() + static_cast<std::ptrdiff_t>(nearest.size() / 2);
  std::nth_element(nearest.begin(), middle, nearest.end());
  return *middle;
}

// Contour points lie in no order along the contour. Each becomes a dash along its tangent that ends
// halfway to its neighbours, and a stub where there are none.
std::vector<Dash> dashes_of(const model::Template& part) {
  const auto points = part.contour_points();
  const double reach_mm = 3.0 * spacing_mm(points);
  const double stub_mm = 0.15 * reach_mm;
  std::vector<Dash> dashes;
  for (const model::ContourPoint& p : points) {
    double ahead_mm = reach_mm;
    double behind_mm = reach_mm;
    for (const model::ContourPoint& q : points) {
      if (static_cast<double>(p.nx * q.nx + p.ny * q.ny) < 0.8) continue;
      const double away_mm = distance_mm(p, q);
      const double along_mm =
          static_cast<double>(p.nx * (q.y_mm - p.y_mm) - p.ny * (q.x_mm - p.x_mm));
      if (std::fabs(along_mm) < 0.8 * away_mm || away_mm == 0.0) continue;
      double& side_mm = along_mm > 0.0 ? ahead_mm : behind_mm;
      side_mm = std::min(side_mm, away_mm);
    }
    const auto length = [&](double side_mm) {
      return side_mm < reach_mm ? 0.52 * side_mm : stub_mm;
    };
    dashes.push_back({length(ahead_mm), length(behind_mm)});
  }
  return dashes;
}

class Artist {
 public:
  Artist(Canvas& canvas, const Sheet& sheet, const model::Template& part)
      : canvas_(canvas), sheet_(sheet), part_(part), dashes_(dashes_of(part)) {
    cairo_set_line_cap(canvas_.get(), CAIRO_LINE_CAP_ROUND);
    cairo_set_line_join(canvas_.get(), CAIRO_LINE_JOIN_ROUND);
  }

  void contour(const Pose& work_T_object) {
    const struct {
      Colour colour;
      double alpha, width;
    } passes[] = {{kDark, 0.75, 5.0}, {kContour, 1.0, 2.4}};
    for (const auto& pass : passes) {
      canvas_.colour(pass.colour, pass.alpha);
      cairo_set_line_width(canvas_.get(), pass.width);
      for (int i = 0; i < part_.contour_count; ++i) dash(work_T_object, i);
      cairo_stroke(canvas_.get());  // one stroke, so that overlaps do not darken
    }
  }

  void surface(const Pose& work_T_object) {
    canvas_.colour(kSurface, 0.85);
    for (const model::SurfacePoint& p : part_.surface_points()) {
      const Place at = sheet_.place(work_T_object * Vec3{p.x_mm, p.y_mm, p.z_mm});
      disc(at, 1.7);
    }
    for (int i = 0; i < part_.anchor_count; ++i) anchor(work_T_object, part_.anchors[i]);
  }

  void axes(const Pose& work_T_object) {
    const double length_mm =
        std::clamp(0.45 * part_.radius_mm, 24.0 / sheet_.px_per_mm(), 90.0 / sheet_.px_per_mm());
    const Place origin = sheet_.place(work_T_object.position_mm);
    for (int axis = 0; axis < 2; ++axis) {
      const Vec3 tip = work_T_object.position_mm + length_mm * work_T_object.rotation.column(axis);
      arrow(origin, sheet_.place(tip), kAxes[axis]);
    }
    // z points at the viewer: a ring, and a line as long as it leans.
    const Vec3 z_tip = work_T_object.position_mm + length_mm * work_T_object.rotation.column(2);
    const Place lean = sheet_.place(z_tip);
    if (std::hypot(lean.x - origin.x, lean.y - origin.y) > 6.0) arrow(origin, lean, kAxes[2]);
    canvas_.colour(kDark, 0.8);
    disc(origin, 6.5);
    canvas_.colour(kAxes[2]);
    disc(origin, 5.0);
    canvas_.colour(kInk);
    disc(origin, 1.8);
  }

  void label(const Pose& work_T_object, const std::string& text) {
    constexpr double kSize_px = 15.0;
    constexpr double kHeight_px = 23.0;
    canvas_.font(kSize_px, true);
    const double width = canvas_.text_width(text) + 14.0;
    // On the side of the origin where no axis is.
    const Place at = sheet_.place(work_T_object.position_mm);
    const Rotation& r = work_T_object.rotation;
    const Vec3 between = r.column(0) + r.column(1) + 2.0 * r.column(2);
    const Vec3 away = -normalized({between.x, -between.y, 0.0});
    const double x_middle = at.x + away.x * (14.0 + 0.5 * width);
    const double y_middle = at.y + away.y * (14.0 + 0.5 * kHeight_px);
    const double x = kept(x_middle - 0.5 * width, sheet_.left, sheet_.width - width);
    const double y = kept(y_middle - 0.5 * kHeight_px, sheet_.top, sheet_.height - kHeight_px);
    canvas_.colour(kDark, 0.78);
    canvas_.rounded_box(x, y, width, kHeight_px, 5.0);
    canvas_.colour(kInk);
    canvas_.text(x + 7.0, y + 16.8, text);
  }

 private:
  static double kept(double value, double low, double room) {
    return std::clamp(value, low + 2.0, std::max(low + 2.0, low + room - 2.0));
  }

  void dash(const Pose& work_T_object, int i) {
    const model::ContourPoint& p = part_.contour[i];
    const Vec3 middle{p.x_mm, p.y_mm, p.z_mm};
    const Vec3 tangent{-static_cast<double>(p.ny), p.nx, 0.0};
    const Place a = sheet_.place(work_T_object * (middle - dashes_[i].behind_mm * tangent));
    const Place b = sheet_.place(work_T_object * (middle + dashes_[i].ahead_mm * tangent));
    cairo_move_to(canvas_.get(), a.x, a.y);
    cairo_line_to(canvas_.get(), b.x, b.y);
  }

  void anchor(const Pose& work_T_object, const model::Anchor& a) {
    const Place at = sheet_.place(work_T_object * Vec3{a.x_mm, a.y_mm, 0.0});
    canvas_.colour(kAnchor);
    cairo_set_line_width(canvas_.get(), 1.8);
    cairo_new_sub_path(canvas_.get());
    cairo_arc(canvas_.get(), at.x, at.y,
              std::max(3.0, static_cast<double>(a.clearance_mm) * sheet_.px_per_mm()), 0.0,
              2.0 * std::numbers::pi);
    cairo_stroke(canvas_.get());
    canvas_.line(at.x - 6.0, at.y, at.x + 6.0, at.y);
    canvas_.line(at.x, at.y - 6.0, at.x, at.y + 6.0);
  }

  void disc(const Place& at, double radius_px) {
    cairo_new_sub_path(canvas_.get());
    cairo_arc(canvas_.get(), at.x, at.y, radius_px, 0.0, 2.0 * std::numbers::pi);
    cairo_fill(canvas_.get());
  }

  void arrow(const Place& from, const Place& to, const Colour& colour) {
    const double length = std::hypot(to.x - from.x, to.y - from.y);
    if (length < 1.0) return;
    const Place along{(to.x - from.x) / length, (to.y - from.y) / length};
    const double head = std::min(12.0, 0.6 * length);
    const Place neck{to.x - head * along.x, to.y - head * along.y};
    const struct {
      Colour colour;
      double alpha, width, grow;
    } passes[] = {{kDark, 0.8, 6.0, 2.0}, {colour, 1.0, 3.2, 0.0}};
    for (const auto& pass : passes) {
      canvas_.colour(pass.colour, pass.alpha);
      cairo_set_line_width(canvas_.get(), pass.width);
      canvas_.line(from.x, from.y, neck.x, neck.y);
      const double half = 0.42 * head + pass.grow;
      cairo_move_to(canvas_.get(), to.x + pass.grow * along.x, to.y + pass.grow * along.y);
      cairo_line_to(canvas_.get(), neck.x - half * along.y - pass.grow * along.x,
                    neck.y + half * along.x - pass.grow * along.y);
      cairo_line_to(canvas_.get(), neck.x + half * along.y - pass.grow * along.x,
                    neck.y - half * along.x - pass.grow * along.y);
      cairo_close_path(canvas_.get());
      cairo_fill(canvas_.get());
    }
  }

  Canvas& canvas_;
  const Sheet& sheet_;
  const model::Template& part_;
  std::vector<Dash> dashes_;
};

Sheet lay_out(const Relief& relief) {
  Sheet sheet;
  sheet.grid = relief.grid;
  const int longer_px = std::max(relief.grid.width_px, relief.grid.height_px);
  if (longer_px <= 0) return sheet;
  sheet.scale = static_cast<double>(kSide_px) / longer_px;
  sheet.width = sheet.scale * relief.grid.width_px;
  sheet.height = sheet.scale * relief.grid.height_px;
  return sheet;
}

// All contours first, that none covers an axis or a label.
void draw_marks(Canvas& canvas, const Sheet& sheet, const Overlay& overlay,
                const model::Template& part, const Pose& work_T_face) {
  std::map<const model::Template*, Artist> artists;
  const auto artist_of = [&](const Mark& mark) -> Artist& {
    const model::Template& own = mark.part == nullptr ? part : *mark.part;
    return artists.try_emplace(&own, canvas, sheet, own).first->second;
  };
  for (const Mark& mark : overlay.marks) {
    if (overlay.shows_template) artist_of(mark).surface(work_T_face * mark.face_T_object);
    artist_of(mark).contour(work_T_face * mark.face_T_object);
  }
  for (const Mark& mark : overlay.marks) artist_of(mark).axes(work_T_face * mark.face_T_object);
  for (const Mark& mark : overlay.marks)
    artist_of(mark).label(work_T_face * mark.face_T_object,
                          port::printable(mark.label, kTitleBytesMax));
}

}  // namespace

std::vector<std::byte> draw_overlay(const Overlay& overlay, const model::Template& part,
                                    const LoadedScan& loaded) {
  const Relief relief = make_relief(loaded, kSide_px);
  Sheet sheet = lay_out(relief);
  const int width_px = std::max(kWidthMin_px, static_cast<int>(std::ceil(sheet.width)));
  const int map_px = std::max(kHeightMin_px, static_cast<int>(std::ceil(sheet.height)));
  sheet.left = 0.5 * (width_px - sheet.width);
  sheet.top = 0.5 * (map_px - sheet.height);

  Canvas canvas(width_px, map_px + static_cast<int>(kLegend_px));
  canvas.colour(kMissing);
  canvas.box(0.0, 0.0, width_px, map_px);
  if (relief.xrgb.empty()) {
    canvas.font(18.0);
    canvas.colour(kFaint);
    canvas.text(24.0, 40.0, "every point is missing");
  } else {
    canvas.picture(relief.xrgb, relief.grid.width_px, relief.grid.height_px, sheet.left, sheet.top,
                   sheet.width, sheet.height);
    draw_marks(canvas, sheet, overlay, part, loaded.frames.work_T_face());
  }
  // cairo refuses text that is no UTF-8.
  draw_legend(canvas, sheet.px_per_mm(), relief, port::printable(overlay.title, kTitleBytesMax),
              loaded);
  return canvas.png();
}

}  // namespace flatpose::tool
