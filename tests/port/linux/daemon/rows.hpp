#pragma once
// Poses multiplied in a way of the tests' own, and a robot's frame made of them.

#include <cmath>
#include <cstddef>
#include <cstdio>
#include <string>

#include "flatpose/geometry/pose.hpp"

namespace flatpose::daemon {

/// A pose as four rows of four.
struct Rows {
  double m[4][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};

  static Rows of(const Pose& pose) {
    Rows r;
    const double p[] = {pose.position_mm.x, pose.position_mm.y, pose.position_mm.z};
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) r.m[i][j] = pose.rotation.m[static_cast<std::size_t>(3 * i + j)];
      r.m[i][3] = p[i];
    }
    return r;
  }
  static Rows at(double x, double y, double z) { return of({{}, {x, y, z}}); }
  /// A turn by degrees about x (0), y (1) or z (2).
  static Rows about(int axis, double degrees) {
    Rows r;
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    const double c = std::cos(degrees * M_PI / 180), s = std::sin(degrees * M_PI / 180);
    r.m[a][a] = r.m[b][b] = c;
    r.m[a][b] = -s;
    r.m[b][a] = s;
    return r;
  }
  friend Rows operator*(const Rows& x, const Rows& y) {
    Rows r;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) {
        r.m[i][j] = 0;
        for (int k = 0; k < 4; ++k) r.m[i][j] += x.m[i][k] * y.m[k][j];
      }
    return r;
  }
  [[nodiscard]] Pose pose() const {
    Pose p;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) p.rotation.m[static_cast<std::size_t>(3 * i + j)] = m[i][j];
    p.position_mm = {m[0][3], m[1][3], m[2][3]};
    return p;
  }
};

/// As the tool writes them.
inline std::string robot_json(const Rows& robot_T_scan) {
  std::string text =
      "{\"format\":\"flatpose-robot\",\"version\":1,\"robot_T_scan\":"
      "{\"position_mm\":[";
  for (int i = 0; i < 3; ++i) text += (i ? "," : "") + std::to_string(robot_T_scan.m[i][3]);
  text += "],\"rotation\":[";
  char number[40];
  for (int i = 0; i < 9; ++i) {
    std::snprintf(number, sizeof number, "%s%.17g", i ? "," : "", robot_T_scan.m[i / 3][i % 3]);
    text += number;
  }
  return text + "]}}";
}

/// Tilted against the scan, so that no axis of one is the other's.
inline const Rows kRobotTScan =
    Rows::at(850, -200, 1200) * Rows::about(2, 35) * Rows::about(1, 4) * Rows::about(0, 176);

}  // namespace flatpose::daemon
