#pragma once
// What the opaque handles are: objects at the beginning of the caller's memory.

#include <array>
#include <cstddef>
#include <cstdint>
#include <new>

#include "flatpose/flatpose.h"
#include "flatpose/locate/locator.hpp"
#include "flatpose/teach/teacher.hpp"

struct flatpose_part {
  flatpose::model::Template part;
};

struct flatpose_finder {
  flatpose::locate::Locator locator;
  flatpose::teach::Teacher teacher;
  flatpose::locate::LocateResult result;
  flatpose::model::Symmetry symmetry;  // of the part that the result is of
  std::array<flatpose::Region, flatpose::locate::kExclusionCountMax> exclusions;  // of a call
  bool can_teach = false;
};

namespace flatpose::c_api {

/// Bytes that an object takes in memory of any alignment.
template <class T>
inline constexpr std::size_t kHandleBytes = sizeof(T) + alignof(T) - 1;

/// Makes an object at the first place in `memory` that is aligned for it; there must be
/// kHandleBytes.
template <class T>
[[nodiscard]] T* make_handle(void* memory) noexcept {
  const auto address = reinterpret_cast<std::uintptr_t>(memory);
  const std::uintptr_t past = address % alignof(T);
  auto* const at = static_cast<std::byte*>(memory) + (past == 0 ? 0 : alignof(T) - past);
  return ::new (at) T{};
}

}  // namespace flatpose::c_api
