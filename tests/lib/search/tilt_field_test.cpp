#include "flatpose/search/tilt_field.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>

#include "tests/lib/image/image.hpp"
#include "tests/lib/search/memory.hpp"
#include "tests/lib/search/vector_paths.hpp"

namespace flatpose::search {
namespace {

struct Fit {
  Memory memory{1 << 21};
  TiltField field;
  Status status;

  Fit(const image::Image<float>& map, double cell_mm, int radius_px)
      : field(take_tilt_field(memory.arena, map.width(), map.height())) {
    const std::size_t used_bytes = memory.arena.used_bytes();
    status = fit_tilt_field(map.view(), cell_mm, radius_px, memory.arena, field);
    EXPECT_EQ(memory.arena.used_bytes(), used_bytes) << "the scratch is given back";
  }
};

std::array<ImageView<float>, 4> images_of(const TiltField& field) {
  return {field.slope_x, field.slope_y, field.plane_mm, field.rms_mm};
}

bool has_window(const image::Image<float>& map, int x, int y, int r) {
  return x >= r && y >= r && x < map.width() - r && y < map.height() - r;
}

struct Plane {
  double slope_x, slope_y, height_mm, rms_mm;
};

/// Least squares of z = a i + b j + c over the window, by Gauss on the full normal equations.
Plane fitted(const image::Image<float>& map, int x, int y, int r, double cell_mm) {
  std::array<std::array<double, 4>, 3> m{};
  const auto each = [&](const auto& visit) {
    for (int j = -r; j <= r; ++j) {
      for (int i = -r; i <= r; ++i)
        visit(std::array<double, 3>{i * cell_mm, j * cell_mm, 1.0}, 1.0 * map(x + i, y + j));
    }
  };
  each([&](const std::array<double, 3>& row, double z) {
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = 0; b < 3; ++b) m[a][b] += row[a] * row[b];
      m[a][3] += row[a] * z;
    }
  });
  for (std::size_t p = 0; p < 3; ++p) {
    for (std::size_t a = 0; a < 3; ++a) {
      if (a == p) continue;
      const double f = m[a][p] / m[p][p];
      for (std::size_t b = 0; b < 4; ++b) m[a][b] -= f * m[p][b];
    }
  }
  const std::array<double, 3> s{m[0][3] / m[0][0], m[1][3] / m[1][1], m[2][3] / m[2][2]};
  double squares = 0.0;
  each([&](const std::array<double, 3>& row, double z) {
    const double off = z - row[0] * s[0] - row[1] * s[1] - s[2];
    squares += off * off;
  });
  return {s[0], s[1], s[2], std::sqrt(squares / ((2 * r + 1) * (2 * r + 1)))};
}

TEST(TiltField, EqualsLeastSquaresOnAnyMap) {
  const image::Image<float> map = image::random_image(31, 29, 5);
  for (const int r : {1, 2, 5, kTiltWindowRadiusMax_px}) {
    const Fit fit(map, 0.7, r);
    ASSERT_EQ(fit.status, Status::kOk);
    for (int y = r; y < map.height() - r; ++y) {
      for (int x = r; x < map.width() - r; ++x) {
        const Plane plane = fitted(map, x, y, r, 0.7);
        ASSERT_NEAR(fit.field.slope_x(x, y), plane.slope_x, 1e-5);
        ASSERT_NEAR(fit.field.slope_y(x, y), plane.slope_y, 1e-5);
        ASSERT_NEAR(fit.field.plane_mm(x, y), plane.height_mm, 1e-5);
        ASSERT_NEAR(fit.field.rms_mm(x, y), plane.rms_mm, 1e-5);
      }
    }
  }
}

TEST(TiltField, IsExactOnPlanesOfAnySlopeAtAnyHeight) {
  for (const auto& [sx, sy, z_mm] : {std::array{0.0, 0.0, 0.0},
                                     {0.5, 0.0, 800.0},
                                     {0.0, -2.25, -100.0},
                                     {1.75, -1.25, 2000.0},
                                     {-0.0625, 0.03125, 5.5}}) {
    const double cell_mm = 0.5;
    const auto map = image::Image<float>::of(24, 20, [&, a = sx, b = sy, c = z_mm](int x, int y) {
      return c + cell_mm * (a * x + b * y);
    });
    const Fit fit(map, cell_mm, 3);
    ASSERT_EQ(fit.status, Status::kOk);
    for (int y = 3; y < 17; ++y) {
      for (int x = 3; x < 21; ++x) {
        EXPECT_NEAR(fit.field.slope_x(x, y), sx, 1e-5);
        EXPECT_NEAR(fit.field.slope_y(x, y), sy, 1e-5);
        EXPECT_NEAR(fit.field.plane_mm(x, y), map(x, y), 1e-3);
        EXPECT_NEAR(fit.field.rms_mm(x, y), 0.0, 1e-3);
      }
    }
  }
}

TEST(TiltField, ResidualTellsAStepFromAPlane) {
  const auto map = image::Image<float>::of(30, 20, [](int x, int) { return x < 15 ? 4.0 : 0.0; });
  const Fit fit(map, 1.0, 2);
  EXPECT_NEAR(fit.field.rms_mm(5, 10), 0.0, 1e-6);
  EXPECT_NEAR(fit.field.rms_mm(12, 10), 0.0, 1e-6) << "the window ends before the step";
  for (int x = 13; x <= 16; ++x) EXPECT_GT(fit.field.rms_mm(x, 10), 0.5) << x;
  EXPECT_NEAR(fit.field.rms_mm(17, 10), 0.0, 1e-6);
}

TEST(TiltField, IsNaNWithinTheRadiusOfTheBorderAndNowhereElse) {
  const image::Image<float> map = image::random_image(27, 26, 6);
  for (int r = 1; r <= kTiltWindowRadiusMax_px; ++r) {
    const Fit fit(map, 1.0, r);
    ASSERT_EQ(fit.status, Status::kOk);
    for (int y = 0; y < map.height(); ++y) {
      for (int x = 0; x < map.width(); ++x) {
        const bool expected = !has_window(map, x, y, r);
        for (const auto& image :
             {fit.field.slope_x, fit.field.slope_y, fit.field.plane_mm, fit.field.rms_mm}) {
          ASSERT_EQ(std::isnan(image(x, y)), expected) << x << ' ' << y;
        }
      }
    }
  }
}

TEST(TiltField, OfAMapSmallerThanTheWindowIsAllNaN) {
  for (const auto& [w, h] : {std::pair{1, 1}, {4, 30}, {30, 4}, {5, 4}}) {
    const image::Image<float> map = image::random_image(w, h, 7);
    const Fit fit(map, 1.0, 2);
    ASSERT_EQ(fit.status, Status::kOk);
    for (int y = 0; y < h; ++y) {
      for (int x = 0; x < w; ++x) EXPECT_TRUE(std::isnan(fit.field.rms_mm(x, y)));
    }
  }
}

TEST(TiltField, IsTheSameOnEveryPath) {
  const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value); };
  for (const auto& [w, h] : {std::pair{53, 31}, {8, 30}, {30, 8}}) {
    const image::Image<float> map = image::random_image(w, h, 9);
    for (const int stride_px : {1, 2, 3}) {
      for (const int r : {1, 3, kTiltWindowRadiusMax_px}) {
        const Fit portable(map, 0.7, r);
        for (const VectorPath path : vector_paths()) {
          Fit fit(map, 0.7, r);
          ASSERT_EQ(
              fit_tilt_field(map.view(), 0.7, r, fit.memory.arena, fit.field, stride_px, path),
              Status::kOk);
          for (std::size_t i = 0; i < 4; ++i) {
            for (int y = 0; y < h; ++y) {
              for (int x = 0; x < w; ++x) {
                ASSERT_EQ(bits(images_of(fit.field)[i](x, y)),
                          bits(images_of(portable.field)[i](x, y)));
              }
            }
          }
        }
      }
    }
  }
}

TEST(TiltField, WithAStrideFitsItsCellsAsBeforeAndTouchesNoOther) {
  const image::Image<float> map = image::random_image(31, 29, 8);
  const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value); };
  for (int stride_px = 1; stride_px <= 5; ++stride_px) {
    for (const int r : {1, 4, 7}) {
      const Fit whole(map, 0.7, r);
      Fit some(map, 0.7, r);
      constexpr float kUntouched = 1234.5F;
      for (const auto& image : images_of(some.field)) {
        for (int y = 0; y < map.height(); ++y) std::fill_n(image.row(y), map.width(), kUntouched);
      }
      ASSERT_EQ(fit_tilt_field(map.view(), 0.7, r, some.memory.arena, some.field, stride_px),
                Status::kOk);
      for (std::size_t i = 0; i < 4; ++i) {
        const ImageView<float> expected = images_of(whole.field)[i];
        const ImageView<float> image = images_of(some.field)[i];
        for (int y = 0; y < map.height(); ++y) {
          for (int x = 0; x < map.width(); ++x) {
            const bool fitted = x % stride_px == 0 && y % stride_px == 0;
            ASSERT_EQ(bits(image(x, y)), bits(fitted ? expected(x, y) : kUntouched))
                << stride_px << " image " << i << " at " << x << ' ' << y;
          }
        }
      }
    }
  }
  Fit fit(map, 1.0, 2);
  EXPECT_EQ(fit_tilt_field(map.view(), 1.0, 2, fit.memory.arena, fit.field, 0),
            Status::kInvalidArgument);
}

TEST(TiltField, OfAMapWithoutCellsIsNothing) {
  const image::Image<float> map(0, 0);
  EXPECT_EQ(Fit(map, 1.0, 2).status, Status::kOk);
}

TEST(TiltField, RefusesBadArguments) {
  const image::Image<float> map(40, 40);
  for (const int r : {0, -1, kTiltWindowRadiusMax_px + 1, 1 << 30}) {
    EXPECT_EQ(Fit(map, 1.0, r).status, Status::kInvalidArgument) << r;
  }
  for (const double cell_mm : {0.0, -1.0, std::nan("")}) {
    EXPECT_EQ(Fit(map, cell_mm, 2).status, Status::kInvalidArgument) << cell_mm;
  }
}

TEST(TiltField, RefusesImagesOfAnotherShape) {
  Memory memory(1 << 20);
  const image::Image<float> map(20, 20);
  const TiltField good = take_tilt_field(memory.arena, 20, 20);
  const ImageView<float> other = memory.arena.take_image<float>(20, 19);
  for (ImageView<float> TiltField::*image :
       {&TiltField::slope_x, &TiltField::slope_y, &TiltField::plane_mm, &TiltField::rms_mm}) {
    TiltField field = good;
    field.*image = other;
    EXPECT_EQ(fit_tilt_field(map.view(), 1.0, 2, memory.arena, field), Status::kShapeMismatch);
  }
}

TEST(TiltField, RefusesTooLittleScratch) {
  Memory images(1 << 20);
  const image::Image<float> map(20, 20);
  TiltField field = take_tilt_field(images.arena, 20, 20);
  int refused = 0;
  for (std::size_t size_bytes = 0; size_bytes < 3 * 20 * 20 * 8 + 300; size_bytes += 64) {
    Memory scratch(size_bytes);
    const Status status = fit_tilt_field(map.view(), 1.0, 2, scratch.arena, field);
    if (size_bytes < 3 * 20 * 20 * 4) {
      EXPECT_EQ(status, Status::kOutOfMemory);
      ++refused;
    } else {
      EXPECT_TRUE(status == Status::kOutOfMemory || status == Status::kOk);
    }
  }
  EXPECT_GT(refused, 10);
}

}  // namespace
}  // namespace flatpose::search
