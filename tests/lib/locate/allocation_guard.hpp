#pragma once
// Counts every allocation of the program, by new or malloc, so that a test can prove there is none.
// Linking allocation_guard.cpp into a test program is what interposes it.

namespace flatpose::test {

class AllocationGuard {
 public:
  AllocationGuard() noexcept : start_(total()) {}
  /// Allocations since this guard was made.
  [[nodiscard]] long count() const noexcept { return total() - start_; }

 private:
  static long total() noexcept;
  long start_;
};

}  // namespace flatpose::test
