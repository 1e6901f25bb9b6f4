#pragma once
// The callbacks of a flatpose_host as clock, executor and cancel.

#include "flatpose/core/host.hpp"
#include "flatpose/flatpose.h"

namespace flatpose::c_api {

class HostOf final : public Clock, public Executor, public Cancel {
 public:
  explicit HostOf(const flatpose_host& host) noexcept : host_(host) {}

  [[nodiscard]] Host host() noexcept {
    return {*this, *this, host_.is_cancelled != nullptr ? this : nullptr};
  }

  [[nodiscard]] std::int64_t now_us() const noexcept override {
    return host_.now_us != nullptr ? host_.now_us(host_.context) : 0;
  }
  void parallel_for(int chunk_count, Task task, void* context) noexcept override {
    if (host_.parallel_for == nullptr) {
      callers_thread.parallel_for(chunk_count, task, context);
    } else {
      host_.parallel_for(host_.context, chunk_count, task, context);
    }
  }
  [[nodiscard]] bool is_asked_for() const noexcept override {
    return host_.is_cancelled(host_.context) != 0;
  }

 private:
  flatpose_host host_;
};

}  // namespace flatpose::c_api
