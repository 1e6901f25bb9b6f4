#include "flatpose/geometry/rigid_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "flatpose/core/sort.hpp"

namespace flatpose {
namespace {

template <int N>
struct Symmetric {
  std::array<std::array<double, N>, N> m{};
};

template <int N>
struct Spectrum {
  std::array<double, N> value{};
  std::array<std::array<double, N>, N> vector{};  ///< By columns.
};

// Turns away one element beside the diagonal (Golub and Van Loan, 8.5).
template <int N>
void turn(Symmetric<N>& a, Spectrum<N>& out, int p, int q) noexcept {
  if (a.m[p][q] == 0.0) return;
  const double theta = (a.m[q][q] - a.m[p][p]) / (2.0 * a.m[p][q]);
  const double root = std::sqrt(theta * theta + 1.0);
  const double t = theta >= 0.0 ? 1.0 / (theta + root) : 1.0 / (theta - root);
  const double c = 1.0 / std::sqrt(t * t + 1.0);
  const double s = t * c;
  for (int k = 0; k < N; ++k) {
    const double kp = a.m[k][p], kq = a.m[k][q];
    a.m[k][p] = c * kp - s * kq;
    a.m[k][q] = s * kp + c * kq;
  }
  for (int k = 0; k < N; ++k) {
    const double pk = a.m[p][k], qk = a.m[q][k];
    a.m[p][k] = c * pk - s * qk;
    a.m[q][k] = s * pk + c * qk;
  }
  for (int k = 0; k < N; ++k) {
    const double kp = out.vector[k][p], kq = out.vector[k][q];
    out.vector[k][p] = c * kp - s * kq;
    out.vector[k][q] = s * kp + c * kq;
  }
}

// Jacobi's method: each sweep squares what is left beside the diagonal.
template <int N>
Spectrum<N> eigen(Symmetric<N> a) noexcept {
  constexpr int kSweeps = 12;
  Spectrum<N> out;
  for (int i = 0; i < N; ++i) out.vector[i][i] = 1.0;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (int p = 0; p < N; ++p)
      for (int q = p + 1; q < N; ++q) turn(a, out, p, q);
  }
  for (int i = 0; i < N; ++i) out.value[i] = a.m[i][i];
  return out;
}

Vec3 middle_of(std::span<const Vec3> points) noexcept {
  Vec3 sum;
  for (const Vec3& p : points) sum = sum + p;
  return (1.0 / static_cast<double>(points.size())) * sum;
}

bool are_finite(std::span<const Vec3> points) noexcept {
  for (const Vec3& p : points) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) return false;
  }
  return true;
}

std::array<double, 3> elements(const Vec3& v) noexcept { return {v.x, v.y, v.z}; }

void measure_spread(std::span<const Vec3> from, const Vec3& middle, RigidFit& fit) noexcept {
  Symmetric<3> scatter;
  for (const Vec3& p : from) {
    const auto d = elements(p - middle);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) scatter.m[i][j] += d[i] * d[j];
  }
  auto squares = eigen(scatter).value;
  sort_in_place(std::span<double>(squares), [](double a, double b) { return a < b; });
  const auto spread = [&](int i) {
    return std::sqrt(std::max(squares[i], 0.0) / static_cast<double>(from.size()));
  };
  fit.depth_mm = spread(0);
  fit.width_mm = spread(1);
  fit.length_mm = spread(2);
}

Rotation best_rotation(std::span<const Vec3> from, const Vec3& from_middle,
                       std::span<const Vec3> to, const Vec3& to_middle) noexcept {
  double s[3][3] = {};
  for (std::size_t n = 0; n < from.size(); ++n) {
    const auto a = elements(from[n] - from_middle);
    const auto b = elements(to[n] - to_middle);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) s[i][j] += a[i] * b[j];
  }
  const Symmetric<4> n{
      {{{s[0][0] + s[1][1] + s[2][2], s[1][2] - s[2][1], s[2][0] - s[0][2], s[0][1] - s[1][0]},
        {s[1][2] - s[2][1], s[0][0] - s[1][1] - s[2][2], s[0][1] + s[1][0], s[2][0] + s[0][2]},
        {s[2][0] - s[0][2], s[0][1] + s[1][0], -s[0][0] + s[1][1] - s[2][2], s[1][2] + s[2][1]},
        {s[0][1] - s[1][0], s[2][0] + s[0][2], s[1][2] + s[2][1], -s[0][0] - s[1][1] + s[2][2]}}}};
  const Spectrum<4> e = eigen(n);
  const auto best = std::max_element(e.value.begin(), e.value.end()) - e.value.begin();
  const auto q = [&](int i) { return e.vector[i][static_cast<std::size_t>(best)]; };
  const double w = q(0), x = q(1), y = q(2), z = q(3);
  return orthonormalized({{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
                           2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                           2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}});
}

}  // namespace

Result<RigidFit> fit_rigid(std::span<const Vec3> from_mm, std::span<const Vec3> to_mm) noexcept {
  constexpr double kLine = 1e-7;
  if (from_mm.size() != to_mm.size()) return Status::kShapeMismatch;
  if (from_mm.size() < 3) return Status::kTooFewPoints;
  if (!are_finite(from_mm) || !are_finite(to_mm)) return Status::kNotFinite;
  const Vec3 from_middle = middle_of(from_mm);
  const Vec3 to_middle = middle_of(to_mm);
  RigidFit fit;
  measure_spread(from_mm, from_middle, fit);
  if (!(fit.width_mm > kLine * (fit.length_mm + norm(from_middle)))) return Status::kTooFewPoints;
  fit.to_T_from.rotation = best_rotation(from_mm, from_middle, to_mm, to_middle);
  fit.to_T_from.position_mm = to_middle - fit.to_T_from.rotation * from_middle;
  double squares = 0.0;
  for (std::size_t n = 0; n < from_mm.size(); ++n) {
    const Vec3 off = fit.to_T_from * from_mm[n] - to_mm[n];
    squares += dot(off, off);
  }
  fit.rms_mm = std::sqrt(squares / static_cast<double>(from_mm.size()));
  return fit;
}

}  // namespace flatpose
