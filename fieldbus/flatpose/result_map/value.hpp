#pragma once
// What a field of the map is worth in a snapshot, before it becomes registers.

#include "flatpose/geometry/robot_convention.hpp"
#include "flatpose/job/snapshot.hpp"
#include "flatpose/result_map/entry.hpp"

namespace flatpose::result_map {

struct Value {
  double number = 0.0;  ///< mm, degrees, rad of a rotation vector; exact for every integer here.
  bool is_none = false;
};

/// Cost: one branch and a product.
[[nodiscard]] Value value_of(const Entry& entry, const job::Snapshot& snapshot) noexcept;

/// Raw units of rotations in int32: 0.001 degree, or 1e-6.
[[nodiscard]] constexpr double rotation_scale(Convention convention) noexcept {
  return is_euler(convention) ? 0.001 : 1e-6;
}

}  // namespace flatpose::result_map
