#pragma once
// A value or the reason why there is none. No exceptions, no heap.

#include <cassert>
#include <utility>

#include "flatpose/core/status.hpp"

namespace flatpose {

template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) noexcept : value_(std::move(value)) {}  // NOLINT: a value is a result
  Result(Status error) noexcept : status_(error) { assert(error != Status::kOk); }  // NOLINT

  explicit operator bool() const noexcept { return status_ == Status::kOk; }
  Status status() const noexcept { return status_; }
  const T& operator*() const noexcept { return value_; }
  T& operator*() noexcept { return value_; }
  const T* operator->() const noexcept { return &value_; }
  T* operator->() noexcept { return &value_; }

 private:
  T value_{};
  Status status_ = Status::kOk;
};

}  // namespace flatpose
