#include "port/linux/tool/relief.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "flatpose/core/arena.hpp"
#include "flatpose/rectify/rectify.hpp"
#include "port/linux/tool/engine.hpp"
#include "port/linux/tool/scan_survey.hpp"
#include "port/linux/tool/status_error.hpp"

namespace flatpose::tool {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// Heights of a map, with NaN beyond its border.
struct Heights {
  int width_px = 0;
  int height_px = 0;
  std::vector<float> z_mm;

  [[nodiscard]] float at(int x, int y) const noexcept {
    if (x < 0 || y < 0 || x >= width_px || y >= height_px) return kNan;
    return z_mm[static_cast<std::size_t>(y) * width_px + x];
  }
};

// Binomial smoothing along one direction; missing cells neither count nor are filled.
Heights smoothed(const Heights& in, int dx, int dy) {
  constexpr float kWeights[] = {1.0F, 4.0F, 6.0F, 4.0F, 1.0F};
  Heights out = in;
  for (int y = 0; y < in.height_px; ++y) {
    for (int x = 0; x < in.width_px; ++x) {
      const float middle = in.at(x, y);
      if (std::isnan(middle)) continue;
      float sum = 0.0F;
      float weight = 0.0F;
      for (int i = -2; i <= 2; ++i) {
        const float z = in.at(x + i * dx, y + i * dy);
        if (std::isnan(z)) continue;
        sum += kWeights[i + 2] * (z - middle);
        weight += kWeights[i + 2];
      }
      out.z_mm[static_cast<std::size_t>(y) * in.width_px + x] = middle + sum / weight;
    }
  }
  return out;
}

double slope(float before, float middle, float after) noexcept {
  if (!std::isnan(before) && !std::isnan(after)) return 0.5 * static_cast<double>(after - before);
  if (!std::isnan(after)) return static_cast<double>(after - middle);
  if (!std::isnan(before)) return static_cast<double>(middle - before);
  return 0.0;
}

void find_range(const Heights& heights, double noise_mm, Relief& relief) {
  std::vector<float> seen;
  for (const float z : heights.z_mm) {
    if (!std::isnan(z)) seen.push_back(z);
  }
  if (seen.empty()) return;
  const auto quantile = [&seen](double share) {
    const auto at = seen.begin() +
                    static_cast<std::ptrdiff_t>(share * (static_cast<double>(seen.size()) - 1.0));
    std::nth_element(seen.begin(), at, seen.end());
    return static_cast<double>(*at);
  };
  relief.low_mm = quantile(0.01);
  relief.high_mm = quantile(0.99);
  // A bare floor is not stretched to a landscape of noise.
  const double span_min_mm = std::max(12.0 * noise_mm, 0.1);
  const double missing_mm = span_min_mm - (relief.high_mm - relief.low_mm);
  if (missing_mm > 0.0) relief.high_mm += missing_mm;
}

std::uint32_t packed(const Colour& colour) noexcept {
  const auto channel = [](double value) {
    return static_cast<std::uint32_t>(std::clamp(value, 0.0, 1.0) * 255.0 + 0.5);
  };
  return channel(colour.red) << 16 | channel(colour.green) << 8 | channel(colour.blue);
}

// Light from the upper left; slopes saturate softly, the sooner the less noise there is.
void shade(const Heights& heights, double noise_mm, Relief& relief) {
  const Heights smooth = smoothed(smoothed(heights, 1, 0), 0, 1);
  const double soft = 0.15 + 0.5 * noise_mm / relief.grid.cell_mm;
  const double span_mm = relief.high_mm - relief.low_mm;
  relief.xrgb.reserve(heights.z_mm.size());
  for (int y = heights.height_px - 1; y >= 0; --y) {
    for (int x = 0; x < heights.width_px; ++x) {
      const float z = smooth.at(x, y);
      if (std::isnan(z)) {
        relief.xrgb.push_back(packed(kMissing));
        continue;
      }
      const double gx = slope(smooth.at(x - 1, y), z, smooth.at(x + 1, y)) / relief.grid.cell_mm;
      const double gy = slope(smooth.at(x, y - 1), z, smooth.at(x, y + 1)) / relief.grid.cell_mm;
      const double toward_light = 0.7071 * (gx - gy);
      const double light =
          1.0 + 0.5 * toward_light / std::sqrt(toward_light * toward_light + soft * soft);
      const Colour c = tint((static_cast<double>(z) - relief.low_mm) / span_mm);
      relief.xrgb.push_back(packed({light * c.red, light * c.green, light * c.blue}));
    }
  }
}

}  // namespace

Colour tint(double share) noexcept {
  static constexpr Colour kStops[] = {{0.19, 0.25, 0.36}, {0.25, 0.39, 0.50}, {0.38, 0.54, 0.60},
                                      {0.60, 0.67, 0.63}, {0.80, 0.77, 0.66}, {0.92, 0.88, 0.80}};
  constexpr int kLast = static_cast<int>(std::size(kStops)) - 1;
  const double place = std::clamp(share, 0.0, 1.0) * kLast;
  const int below = std::min(static_cast<int>(place), kLast - 1);
  const double t = place - below;
  const Colour& a = kStops[below];
  const Colour& b = kStops[below + 1];
  return {a.red + t * (b.red - a.red), a.green + t * (b.green - a.green),
          a.blue + t * (b.blue - a.blue)};
}

Relief make_relief(const LoadedScan& loaded, int side_px) {
  const RangeImageView view = loaded.scan.view();
  const rectify::Survey survey = survey_of(loaded);
  Relief relief;
  if (survey.valid_count == 0) return relief;

  const double extent_mm =
      std::max(survey.max_mm.x - survey.min_mm.x, survey.max_mm.y - survey.min_mm.y);
  const double pitch_mm = std::max(survey.pitch_along_row_mm, survey.pitch_along_column_mm);
  rectify::GridConfig grid_config;
  grid_config.cell_mm = std::max({extent_mm / (side_px - 2), pitch_mm, 1e-3});
  const auto grid = rectify::choose_grid(survey, grid_config);
  if (!grid) fail(grid.status(), Doing::kSurvey, loaded.path);
  relief.grid = *grid;

  Heights heights{grid->width_px, grid->height_px, {}};
  const std::size_t cell_count =
      static_cast<std::size_t>(grid->width_px) * static_cast<std::size_t>(grid->height_px);
  heights.z_mm.resize(cell_count, kNan);
  std::vector<std::int32_t> source(cell_count);
  rectify::RectifyConfig config;
  config.paint = rectify::paint_config_for(survey);
  const rectify::HeightMap map{
      *grid,
      {heights.z_mm.data(), grid->width_px, grid->height_px, grid->width_px},
      {source.data(), grid->width_px, grid->height_px, grid->width_px}};
  Memory memory(rectify::required_bytes(config.method, view.width_px, view.height_px, *grid) +
                Arena::kAlignmentBytes);
  Arena arena(memory.span());
  const Status status = rectify::rectify(view, loaded.frames.work_T_scan, config, arena, map);
  if (status != Status::kOk) fail(status, Doing::kSurvey, loaded.path);
  find_range(heights, survey.noise_sigma_mm, relief);
  shade(heights, survey.noise_sigma_mm, relief);
  return relief;
}

}  // namespace flatpose::tool
