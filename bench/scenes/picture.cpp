#include "bench/scenes/picture.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "port/linux/tool/canvas.hpp"
#include "port/linux/tool/legend.hpp"
#include "port/linux/tool/relief.hpp"

namespace flatpose::bench {
namespace {

constexpr int kSide_px = 1200;
constexpr tool::Colour kDark{0.04, 0.05, 0.06};
constexpr tool::Colour kTruth{0.25, 0.95, 0.40};
constexpr tool::Colour kRight{1.0, 0.72, 0.10};
constexpr tool::Colour kWrong{1.0, 0.22, 0.20};

class Sheet {
 public:
  Sheet(tool::Canvas& canvas, const rectify::Grid& grid, const sim::Part& part)
      : canvas_(canvas), grid_(grid), part_(part) {
    scale_ = static_cast<double>(kSide_px) / std::max(grid.width_px, grid.height_px);
  }

  void outline(const Pose& scan_T_part, const tool::Colour& colour, double width_px) {
    path(scan_T_part);
    canvas_.colour(kDark, 0.7);
    cairo_set_line_width(canvas_.get(), width_px + 2.5);
    cairo_stroke_preserve(canvas_.get());
    canvas_.colour(colour);
    cairo_set_line_width(canvas_.get(), width_px);
    cairo_stroke(canvas_.get());
  }

  /// Beside the origin, `line` lines below it.
  void label(const Pose& scan_T_part, const std::string& text, const tool::Colour& colour,
             int line) {
    constexpr double kSize_px = 15.0;
    canvas_.font(kSize_px, true);
    const double x = x_of(scan_T_part.position_mm) + 6.0;
    const double y = y_of(scan_T_part.position_mm) + (kSize_px + 3.0) * line;
    canvas_.colour(kDark, 0.75);
    canvas_.rounded_box(x - 4.0, y - kSize_px, canvas_.text_width(text) + 8.0, kSize_px + 5.0, 4.0);
    canvas_.colour(colour);
    canvas_.text(x, y, text);
  }

  [[nodiscard]] double px_per_mm() const { return scale_ / grid_.cell_mm; }

 private:
  [[nodiscard]] double x_of(const Vec3& p_mm) const {
    return (grid_.column_of(p_mm.x) + 0.5) * scale_;
  }
  [[nodiscard]] double y_of(const Vec3& p_mm) const {
    return (grid_.height_px - 0.5 - grid_.row_of(p_mm.y)) * scale_;
  }

  void loop(const Pose& scan_T_part, const sim::Loop& points) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 p_mm = scan_T_part * Vec3{points[i].x, points[i].y, 0.0};
      (i == 0 ? cairo_move_to : cairo_line_to)(canvas_.get(), x_of(p_mm), y_of(p_mm));
    }
    cairo_close_path(canvas_.get());
  }
  /// The outline, its holes, and a line from the origin along the part's x.
  void path(const Pose& scan_T_part) {
    cairo_new_path(canvas_.get());
    loop(scan_T_part, part_.outline.outer);
    for (const sim::Loop& hole : part_.outline.holes) loop(scan_T_part, hole);
    const Vec3 tip_mm = scan_T_part * Vec3{0.4 * sim::radius_mm(part_), 0.0, 0.0};
    cairo_move_to(canvas_.get(), x_of(scan_T_part.position_mm), y_of(scan_T_part.position_mm));
    cairo_line_to(canvas_.get(), x_of(tip_mm), y_of(tip_mm));
  }

  tool::Canvas& canvas_;
  const rectify::Grid& grid_;
  const sim::Part& part_;
  double scale_ = 1.0;
};

std::string formatted(const char* form, int number, double share) {
  char text[64];
  std::snprintf(text, sizeof text, form, number, share);
  return text;
}

void draw_truths(Sheet& sheet, const Shot& shot) {
  int number = 0;
  for (const Truth& truth : shot.truths) {
    const bool counts = truth.visible >= kVisibleOfTarget;
    sheet.outline(truth.scan_T_part, kTruth, counts ? 3.0 : 1.0);
    sheet.label(truth.scan_T_part, formatted("T%d  %.2f", number++, truth.visible), kTruth, 0);
  }
}

void draw_matches(Sheet& sheet, const Trial& trial) {
  const auto& wrong = trial.all.wrong_matches;
  for (int i = 0; i < static_cast<int>(trial.scan_T_found.size()); ++i) {
    const bool is_wrong = std::find(wrong.begin(), wrong.end(), i) != wrong.end();
    const tool::Colour& colour = is_wrong ? kWrong : kRight;
    sheet.outline(trial.scan_T_found[i], colour, 1.8);
    sheet.label(trial.scan_T_found[i], formatted("#%d  %.2f", i + 1, trial.result.matches[i].score),
                colour, 1);
  }
}

}  // namespace

std::vector<std::byte> draw_trial(const Shot& shot, const Trial& trial, const std::string& title) {
  const tool::Relief relief = tool::make_relief(shot.loaded, kSide_px);
  const sim::Part part = sim::catalogue_part(shot.part);
  const double scale =
      static_cast<double>(kSide_px) / std::max(relief.grid.width_px, relief.grid.height_px);
  const double width_px = scale * relief.grid.width_px;
  const double height_px = scale * relief.grid.height_px;
  tool::Canvas canvas(static_cast<int>(std::ceil(width_px)),
                      static_cast<int>(std::ceil(height_px) + tool::kLegend_px));
  canvas.picture(relief.xrgb, relief.grid.width_px, relief.grid.height_px, 0.0, 0.0, width_px,
                 height_px);
  Sheet sheet(canvas, relief.grid, part);
  draw_truths(sheet, shot);
  draw_matches(sheet, trial);
  tool::draw_legend(canvas, sheet.px_per_mm(), relief, title, shot.loaded);
  return canvas.png();
}

}  // namespace flatpose::bench
