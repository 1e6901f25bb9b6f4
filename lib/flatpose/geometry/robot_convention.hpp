#pragma once
// The numbers in which robot controllers write a rotation, and the way back. R is frame_T_tool as a
// matrix; Rx, Ry, Rz turn about one axis.
//
//   KUKA         A B C     R = Rz(A) Ry(B) Rx(C)
//   FANUC        W P R     R = Rz(R) Ry(P) Rx(W), also Yaskawa's Rx Ry Rz
//   UR           rx ry rz  R = turn by |r| about r
//   ABB          q1..q4    unit quaternion w x y z
//   Staubli      rx ry rz  R = Rx(rx) Ry(ry) Rz(rz)
//   z-y'-z''     a b c     R = Rz(a) Ry(b) Rz(c), as Kawasaki's O A T; singular at no tilt
//
// Every rotation has several sets of numbers. With a reference the one nearest to it is taken, and
// angles may then leave +-180 degrees, so that noise about a border does not flip a sign.

#include <array>
#include <cstdint>

#include "flatpose/geometry/pose.hpp"

namespace flatpose {

/// The numbers are those of the register map.
enum class Convention : std::uint8_t {
  kKukaAbc = 0,
  kFanucWpr = 1,
  kUrRotationVector = 2,
  kAbbQuaternion = 3,
  kStaubliXyz = 4,
  kZyz = 5,
};
inline constexpr int kConventionCount = 6;

/// "kuka_abc", "fanuc_wpr", ...
[[nodiscard]] const char* to_string(Convention convention) noexcept;

/// Whether the numbers are angles; else a rotation vector or a quaternion.
[[nodiscard]] constexpr bool is_euler(Convention convention) noexcept {
  return convention != Convention::kUrRotationVector && convention != Convention::kAbbQuaternion;
}

struct RotationNumbers {
  std::array<double, 4> value{};  ///< rad, or a quaternion's w x y z; the fourth is its alone.
  bool is_singular = false;       ///< Only a sum or difference of two angles was determined.
};

/// Inside this sine (or cosine) of the middle angle the outer two are taken for one.
inline constexpr double kSingularSine = 1e-9;

/// The numbers of least amount: the middle angle in [-90, 90] degrees (z-y'-z'': [0, 180]), the
/// others in (-180, 180]; a vector no longer than pi; w >= 0. Where singular, C (FANUC W, Staubli
/// rx, the last of z-y'-z'') is 0.  Units/frames: rad.
[[nodiscard]] RotationNumbers rotation_numbers(const Rotation& rotation,
                                               Convention convention) noexcept;

/// The numbers nearest to `reference` (least squares).  Where singular, the free angle too is the
/// one that brings them nearest.  Fails: never, for a finite reference.
[[nodiscard]] RotationNumbers rotation_numbers(const Rotation& rotation, Convention convention,
                                               const std::array<double, 4>& reference) noexcept;

/// The inverse.  A quaternion is normalised; none at all (zero) gives no turn.
[[nodiscard]] Rotation rotation_from_numbers(const std::array<double, 4>& numbers,
                                             Convention convention) noexcept;

}  // namespace flatpose
