#include "port/linux/daemon/rotation_setting.hpp"

#include <cmath>

#include "flatpose/core/maths.hpp"

namespace flatpose::daemon {
namespace {

constexpr double kAngleMax_deg = 720.0;
constexpr double kVectorMax_rad = 4.0 * kPi;
constexpr double kUnitTolerance = 1e-3;

}  // namespace

std::vector<std::string> convention_words() {
  std::vector<std::string> words;
  for (int i = 0; i < kConventionCount; ++i)
    words.emplace_back(to_string(static_cast<Convention>(i)));
  return words;
}

std::optional<std::array<double, 4>> read_rotation_numbers(Section& section, const std::string& key,
                                                           Convention convention) {
  const bool is_quaternion = convention == Convention::kAbbQuaternion;
  const double most = is_euler(convention) ? kAngleMax_deg : is_quaternion ? 1.0 : kVectorMax_rad;
  const std::vector<double> given = section.numbers(key, -most, most, is_quaternion ? 4 : 3);
  if (given.empty()) return std::nullopt;
  std::array<double, 4> numbers{};
  double squares = 0.0;
  for (std::size_t i = 0; i < given.size(); ++i) {
    numbers[i] = is_euler(convention) ? given[i] * kRadPerDeg : given[i];
    squares += given[i] * given[i];
  }
  if (is_quaternion && !(std::fabs(std::sqrt(squares) - 1.0) <= kUnitTolerance))
    section.fail(key, "'" + key + "' is no quaternion of length 1",
                 "give w, x, y, z whose squares sum to 1");
  return numbers;
}

}  // namespace flatpose::daemon
