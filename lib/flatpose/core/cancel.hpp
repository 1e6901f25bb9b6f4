#pragma once
// How a run is told to stop before it is done.

#include <atomic>

namespace flatpose {

class Cancel {
 public:
  /// Asked often, from any thread that works on the run: must be quick and must not block.
  [[nodiscard]] virtual bool is_asked_for() const noexcept = 0;

 protected:
  ~Cancel() = default;
};

/// Set and cleared by anybody at any time.
class CancelFlag final : public Cancel {
 public:
  void set(bool is_asked_for) noexcept {
    is_asked_for_.store(is_asked_for, std::memory_order_relaxed);
  }
  [[nodiscard]] bool is_asked_for() const noexcept override {
    return is_asked_for_.load(std::memory_order_relaxed);
  }

 private:
  std::atomic<bool> is_asked_for_{false};
};

}  // namespace flatpose
