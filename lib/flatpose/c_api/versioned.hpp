#pragma once
// Structs of callers that were built with this version or an earlier one: what they do not know yet
// has its default.

#include <cstddef>
#include <cstring>
#include <type_traits>

#include "flatpose/core/result.hpp"

namespace flatpose::c_api {

/// What `from` says, on top of the defaults `out` comes with.
/// Fails: kInvalidArgument (null, or no size in it), kBadVersion (of a newer library).
template <class T>
[[nodiscard]] Status read(const T* from, T& out) noexcept {
  static_assert(std::is_trivially_copyable_v<T>);
  if (from == nullptr || from->struct_size < sizeof(from->struct_size))
    return Status::kInvalidArgument;
  if (from->struct_size > sizeof(T)) return Status::kBadVersion;
  std::memcpy(&out, from, from->struct_size);
  return Status::kOk;
}

/// As much of `value` as the caller's struct has room for; its size stays.
/// Fails: as read().
template <class T>
[[nodiscard]] Status write(const T& value, T* to) noexcept {
  static_assert(std::is_trivially_copyable_v<T>);
  if (to == nullptr || to->struct_size < sizeof(to->struct_size)) return Status::kInvalidArgument;
  if (to->struct_size > sizeof(T)) return Status::kBadVersion;
  const std::size_t struct_size = to->struct_size;
  std::memcpy(to, &value, struct_size);
  to->struct_size = struct_size;
  return Status::kOk;
}

}  // namespace flatpose::c_api
