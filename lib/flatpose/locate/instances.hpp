#pragma once
// The poses that refinement has come to so far: each once, best first when sorted.

#include <span>

#include "flatpose/geometry/pose.hpp"
#include "flatpose/locate/verify.hpp"
#include "flatpose/refine/polish.hpp"

namespace flatpose::locate {

/// A candidate after refinement.
struct Instance {
  Pose work_T_object;
  Verification verification;
  bool is_open = true;  ///< Neither a match nor out of the question.
  bool is_polished = false;
  int judged_at = -1;  ///< How many matches there were then; -1: not yet.
  refine::PolishResult polished;

  /// What poses are ordered by.
  [[nodiscard]] double rank() const noexcept { return verification.score * verification.visible; }
};

class Instances {
 public:
  Instances() noexcept = default;
  /// In memory that the caller keeps.
  explicit Instances(std::span<Instance> memory) noexcept : memory_(memory) {}

  [[nodiscard]] int count() const noexcept { return count_; }
  [[nodiscard]] bool is_full() const noexcept { return count_ == static_cast<int>(memory_.size()); }
  [[nodiscard]] Instance& operator[](int i) noexcept { return memory_[i]; }
  [[nodiscard]] const Instance& operator[](int i) const noexcept { return memory_[i]; }

  /// There must be room.
  void add(const Pose& work_T_object, const Verification& verification) noexcept;
  /// Whether a pose is there already: origins nearer than `near_mm`, and points at `radius_mm`.
  [[nodiscard]] bool contains(const Pose& pose, double near_mm, double radius_mm) const noexcept;
  /// By rank; ties by pose.
  void sort() noexcept;

 private:
  std::span<Instance> memory_;
  int count_ = 0;
};

}  // namespace flatpose::locate
