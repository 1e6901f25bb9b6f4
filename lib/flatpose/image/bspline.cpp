#include "flatpose/image/bspline.hpp"

#include <cstddef>

namespace flatpose::image {
namespace {

constexpr float kPole = -0.26794919243112270F;  // sqrt(3) - 2
constexpr float kGain = 6.0F;                   // (1 - p) (1 - 1/p)
constexpr int kHorizon = 16;                    // p^16 is 7e-10, below the float's last bit

// Filters `lane_count` lines side by side: value i of line k at data[i * step + k * lane_step].
struct Lines {
  float* data;
  int size;
  std::ptrdiff_t step;
  int lane_count;
  std::ptrdiff_t lane_step;

  [[nodiscard]] float& at(int i, int lane) const noexcept {
    return data[i * step + lane * lane_step];
  }
};

// The forward filter's value at the first cell of the line that goes on mirrored: the sum of p^k
// s(k) over the mirrored line, cut off where it no longer counts, or in closed form when the line
// is short.
void start_forward(const Lines& lines) noexcept {
  const int n = lines.size;
  const bool is_short = n <= kHorizon;
  const int count = is_short ? n : kHorizon;
  float full_turn = 1.0F;  // p^(2n - 2)
  for (int i = 0; is_short && i < 2 * n - 2; ++i) full_turn *= kPole;
  float power = 1.0F;
  for (int i = 1; i < count; ++i) {
    power *= kPole;
    // Seen from the first cell every inner one comes twice in a period, at i and at 2n - 2 - i.
    const float mirrored_power = is_short && i < n - 1 ? full_turn / power : 0.0F;
    for (int k = 0; k < lines.lane_count; ++k) {
      lines.at(0, k) += (power + mirrored_power) * lines.at(i, k);
    }
  }
  if (!is_short) return;
  for (int k = 0; k < lines.lane_count; ++k) lines.at(0, k) /= 1.0F - full_turn;
}

void filter(const Lines& lines) noexcept {
  const int n = lines.size;
  if (n < 2) return;
  start_forward(lines);
  for (int i = 1; i < n; ++i) {
    for (int k = 0; k < lines.lane_count; ++k) lines.at(i, k) += kPole * lines.at(i - 1, k);
  }
  constexpr float kStart = kGain * kPole / (kPole * kPole - 1.0F);
  for (int k = 0; k < lines.lane_count; ++k) {
    lines.at(n - 1, k) = kStart * (lines.at(n - 1, k) + kPole * lines.at(n - 2, k));
  }
  for (int i = n - 2; i >= 0; --i) {
    for (int k = 0; k < lines.lane_count; ++k) {
      lines.at(i, k) = kPole * (lines.at(i + 1, k) - kGain * lines.at(i, k));
    }
  }
}

}  // namespace

void bspline_prefilter(ImageView<float> image) noexcept {
  if (image.empty()) return;
  for (int y = 0; y < image.height_px; ++y) filter({image.row(y), image.width_px, 1, 1, 0});
  filter({image.data, image.height_px, image.stride_px, image.width_px, 1});
}

}  // namespace flatpose::image
