// The loops over rows against the plainest form of each, on every path and at every width.

#include "flatpose/image/row_kernels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "tests/lib/image/image.hpp"
#include "tests/lib/search/vector_paths.hpp"

namespace flatpose::image {
namespace {

constexpr int kWidthMax_px = 70;

/// Calls body(kernels, width, z) with heights of five rows, some of them missing when asked for.
template <class Body>
void for_each_path_and_width(double missing_share, const Body& body) {
  for (const VectorPath path : vector_paths()) {
    for (int width_px = 1; width_px <= kWidthMax_px; ++width_px) {
      Image<float> z = random_image(width_px, 5, static_cast<unsigned>(width_px));
      std::mt19937 generator(7);
      std::uniform_real_distribution<double> u(0.0, 1.0);
      for (int i = 0; i < 5 * width_px; ++i) {
        if (u(generator) < missing_share) z(i % width_px, i / width_px) = kMissing;
      }
      body(row_kernels(path), width_px, z);
    }
  }
}

void expect_same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (std::isnan(a[i]) && std::isnan(b[i])) continue;  // whose payload is nobody's
    ASSERT_EQ(std::bit_cast<std::uint32_t>(a[i]), std::bit_cast<std::uint32_t>(b[i])) << i;
  }
}

using Floats = std::vector<float>;
using Bytes = std::vector<std::uint8_t>;

TEST(RowKernels, CarryWhatIsThereToWhatIsMissing) {
  for_each_path_and_width(0.3, [](const RowKernels& kernels, int w, Image<float>& z) {
    Floats carried(w, 99.0F), expected_carried(w, 99.0F), filled(w), expected(w);
    Floats lowest(w, 50.0F), expected_lowest(w, 50.0F);
    Bytes missing(w), expected_missing(w);
    for (int y = 0; y < 5; ++y) {
      bool any = false;
      for (int x = 0; x < w; ++x) {
        expected_missing[x] = std::isnan(z(x, y)) ? 1 : 0;
        any |= expected_missing[x] != 0;
        if (expected_missing[x] == 0) expected_carried[x] = z(x, y);
        expected[x] = expected_carried[x];
        expected_lowest[x] = std::min(expected_lowest[x], expected[x]);
      }
      ASSERT_EQ(kernels.carry_down(z.view().row(y), w, carried.data(), lowest.data(), filled.data(),
                                   missing.data()),
                any);
      expect_same_bits(filled, expected);
      expect_same_bits(carried, expected_carried);
      expect_same_bits(lowest, expected_lowest);
      ASSERT_EQ(missing, expected_missing);
      ASSERT_EQ(kernels.carry_down(z.view().row(y), w, carried.data(), lowest.data(),
                                   z.view().row(y), missing.data()),
                any);
      expect_same_bits(Floats(z.view().row(y), z.view().row(y) + w), expected);  // in place

      Floats up(w, 7.0F), expected_up(w, 7.0F);
      kernels.carry_up(missing.data(), filled.data(), w, up.data());
      for (int x = 0; x < w; ++x) {
        if (missing[x] == 0) expected_up[x] = filled[x];
      }
      expect_same_bits(up, expected_up);
    }
  });
}

TEST(RowKernels, SlopesAndNormalsAreThoseOfThePlainSums) {
  for_each_path_and_width(0.02, [](const RowKernels& kernels, int w, Image<float>& z) {
    Floats sx(w), sy(w), ex(w), ey(w);
    kernels.sobel(three_rows(z.view(), 2), w, sx.data(), sy.data());
    for (int x = 0; x < w; ++x) {
      const auto at = [&](int dx, int dy) { return z(std::clamp(x + dx, 0, w - 1), 2 + dy); };
      const auto sum = [](float a, float b, float c) { return a + 2.0F * b + c; };
      const float nan = 0.0F * (at(0, 0) + at(-1, 0) + at(1, 0) + at(0, -1) + at(0, 1) +
                                at(-1, -1) + at(1, -1) + at(-1, 1) + at(1, 1));
      ex[x] =
          0.125F * (sum(at(1, -1), at(1, 0), at(1, 1)) - sum(at(-1, -1), at(-1, 0), at(-1, 1))) +
          nan;
      ey[x] =
          0.125F * (sum(at(-1, 1), at(0, 1), at(1, 1)) - sum(at(-1, -1), at(0, -1), at(1, -1))) +
          nan;
    }
    for (int x = 0; x < w; ++x) ex[x] += 0.0F, ey[x] += 0.0F;
    expect_same_bits(sx, ex);
    expect_same_bits(sy, ey);
    kernels.normalise(0.5F, 2.0F, w, sx.data(), sy.data());
    for (int x = 0; x < w; ++x) {
      constexpr double kRoundings = 3e-7;
      const double a = ex[x] * 0.5F, b = ey[x] * 2.0F;
      const double length = std::sqrt(1.0 + a * a + b * b);
      ASSERT_EQ(std::isnan(ex[x]), std::isnan(sx[x]));
      if (std::isnan(ex[x])) continue;
      ASSERT_NEAR(sx[x], -a / length, kRoundings);
      ASSERT_NEAR(sy[x], -b / length, kRoundings);
    }
  });
}

TEST(RowKernels, NormalsAreTheSameOnEveryPath) {
  for (int w = 1; w <= kWidthMax_px; ++w) {
    Image<float> slopes = random_image(w, 2, static_cast<unsigned>(w));
    if (w > 4) slopes(2, 0) = 3e19F, slopes(3, 1) = kMissing;
    Floats x(slopes.view().row(0), slopes.view().row(0) + w);
    Floats y(slopes.view().row(1), slopes.view().row(1) + w);
    row_kernels(VectorPath::kPortable).normalise(0.7F, 1.3F, w, x.data(), y.data());
    for (const VectorPath path : vector_paths()) {
      Image<float> other = slopes;
      row_kernels(path).normalise(0.7F, 1.3F, w, other.view().row(0), other.view().row(1));
      expect_same_bits(Floats(other.view().row(0), other.view().row(0) + w), x);
      expect_same_bits(Floats(other.view().row(1), other.view().row(1) + w), y);
    }
  }
}

TEST(RowKernels, MarkWhereTheSlopeStandsOut) {
  int marked_count = 0;
  for_each_path_and_width(0.0, [&](const RowKernels& kernels, int w, Image<float>& s) {
    if (w < 3) return;
    Bytes marks(w, 9);
    const ThreeRows rows{s.view().row(0), s.view().row(2), s.view().row(4)};
    kernels.mark_jumps(s.view().row(3), rows, w, 9.0F, marks.data());
    const auto agreed = [](float a, float b) {
      if (!(a * b > 0.0F)) return 0.0F;
      return std::fabs(a) < std::fabs(b) ? a : b;
    };
    for (int x = 0; x < w; ++x) {
      const auto at = [&](int column) { return s(std::clamp(column, 1, w - 2), 3); };
      const float rest_x = at(x) - agreed(at(x - kBeside_px), at(x + kBeside_px));
      const float rest_y = s(x, 2) - agreed(s(x, 0), s(x, 4));
      const bool marked = x > 0 && x < w - 1 && rest_x * rest_x + rest_y * rest_y >= 81.0F;
      ASSERT_EQ(marks[x], marked ? kMaybeJump : 0) << x << " of " << w;
      marked_count += marked ? 1 : 0;
    }
  });
  EXPECT_GT(marked_count, 500);
}

TEST(RowKernels, FindWhatIsMissingAloneOrWide) {
  std::mt19937 generator(3);
  for (const VectorPath path : vector_paths()) {
    for (int w = 1; w <= kWidthMax_px; ++w) {
      Bytes rows[3];
      for (Bytes& row : rows) {
        for (int x = 0; x < w; ++x) row.push_back(generator() % 4 == 0 ? 0 : 1 + generator() % 2);
      }
      const Bytes& here = rows[1];
      int single_count = 0;
      for (int x = 1; x + 1 < w; ++x) {
        const bool beside = ((here[x - 1] | here[x + 1] | rows[0][x] | rows[2][x]) & 1) != 0;
        single_count += (here[x] & 1) != 0 && !beside ? 1 : 0;
      }
      ASSERT_EQ(row_kernels(path).count_single(rows[0].data(), here.data(), rows[2].data(), w),
                single_count);
      for (int least = 3; least <= 8; ++least) {
        Bytes wide(w, 9), expected(w);
        bool any = false;
        for (int x = 0; x < w; ++x) {
          bool all = x + least <= w;
          for (int i = 0; all && i < least; ++i) all = here[x + i] != 0;
          expected[x] = all ? 1 : 0;
          any |= all;
        }
        const bool found = row_kernels(path).find_wide(here.data(), w, least, wide.data());
        // It may see three where more are asked for.
        ASSERT_TRUE(found || !any);
        if (found) {
          ASSERT_EQ(wide, expected);
        }
      }
    }
  }
}

TEST(RowKernels, PutNumbersSideBySide) {
  for_each_path_and_width(0.0, [](const RowKernels& kernels, int w, Image<float>& z) {
    Floats pairs(2 * w);
    kernels.interleave(z.view().row(0), z.view().row(1), w, pairs.data());
    for (int x = 0; x < w; ++x) {
      ASSERT_EQ(pairs[2 * x], z(x, 0));
      ASSERT_EQ(pairs[2 * x + 1], z(x, 1));
    }
  });
}

TEST(RowKernels, HalveAsOneCellAtATime) {
  for_each_path_and_width(0.4, [](const RowKernels& kernels, int w, Image<float>& z) {
    Floats halved((w + 1) / 2), expected(halved.size());
    kernels.halve(z.view().row(0), z.view().row(1), w, 6.0F, halved.data());
    for (int x = 0; x < w; x += 2) {
      std::vector<float> valid;
      for (const int c : {x, x + 1}) {
        for (const int r : {0, 1}) {
          if (c < w && !std::isnan(z(c, r))) valid.push_back(z(c, r));
        }
      }
      if (valid.empty()) {
        ASSERT_TRUE(std::isnan(halved[x / 2]));
        continue;
      }
      const float top = *std::max_element(valid.begin(), valid.end());
      double sum = 0.0;
      int count = 0;
      for (const float height : valid) {
        if (height >= top - 6.0F) sum += static_cast<double>(height), ++count;
      }
      ASSERT_NEAR(halved[x / 2], sum / count, 1e-5);
    }
    row_kernels(VectorPath::kPortable)
        .halve(z.view().row(0), z.view().row(1), w, 6.0F, expected.data());
    expect_same_bits(halved, expected);
  });
}

std::uint8_t plus(int a, int b) { return static_cast<std::uint8_t>(std::min(a + b, 255)); }

/// One cell after the other, `step` being 1 or -1.
void shorten_slowly(const std::vector<OctantCell>& previous, int step,
                    std::vector<OctantCell>& row) {
  const int w = static_cast<int>(row.size());
  for (std::size_t k = 0; k < kOctantCount; ++k) {
    std::uint8_t carried = 255;
    for (int x = step > 0 ? 0 : w - 1; x >= 0 && x < w; x += step) {
      const auto at = [&](int i) { return previous[std::clamp(i, 0, w - 1)].of[k]; };
      const std::uint8_t above = std::min({plus(at(x - 1), 4), plus(at(x), 3), plus(at(x + 1), 4)});
      carried = std::min({above, row[x].of[k], plus(carried, 3)});
      row[x].of[k] = carried;
    }
  }
}

TEST(RowKernels, ShortenDistancesAsCellAfterCell) {
  std::mt19937 generator(3);
  for (const VectorPath path : vector_paths()) {
    for (int w = 1; w <= kWidthMax_px; ++w) {
      for (int round = 0; round < 4; ++round) {
        std::vector<OctantCell> previous(w), row(w);
        for (int x = 0; x < w; ++x) {
          for (std::size_t k = 0; k < kOctantCount; ++k) {
            // Far from everything for the most part, also as far as a byte reaches.
            previous[x].of[k] = generator() % 5 == 0 ? static_cast<std::uint8_t>(generator()) : 240;
            row[x].of[k] = generator() % 9 == 0 ? 0 : (round % 2 == 0 ? 240 : 255);
          }
        }
        for (const int step : {1, -1}) {
          std::vector<OctantCell> expected = row, got = row;
          shorten_slowly(previous, step, expected);
          const RowKernels& kernels = row_kernels(path);
          (step > 0 ? kernels.shorten_forward : kernels.shorten_backward)(previous.data(), w,
                                                                          got.data());
          for (int x = 0; x < w; ++x) ASSERT_EQ(got[x].of, expected[x].of) << x << " of " << w;
        }
      }
    }
  }
}

}  // namespace
}  // namespace flatpose::image
