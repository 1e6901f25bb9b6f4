#include <algorithm>

#include "flatpose/c_api/convert.hpp"
#include "flatpose/c_api/handles.hpp"
#include "flatpose/c_api/versioned.hpp"

using namespace flatpose;
using namespace flatpose::c_api;

namespace {

Status read_limits(const flatpose_limits* given, locate::Limits& limits, bool& can_teach) noexcept {
  flatpose_limits in = FLATPOSE_LIMITS_INIT;
  if (const Status s = read(given, in); s != Status::kOk) return s;
  if (in.vector_path < FLATPOSE_PATH_PORTABLE || in.vector_path > FLATPOSE_PATH_AVX512)
    return Status::kInvalidArgument;
  limits = {in.scan_width_px, in.scan_height_px, in.cell_count,
            static_cast<VectorPath>(in.vector_path)};
  can_teach = in.can_teach != 0;
  return Status::kOk;
}

// Zero when a limit is out of range.
std::size_t arena_bytes(const locate::Limits& limits, bool can_teach) noexcept {
  const std::size_t locator_bytes = locate::Locator::required_bytes(limits);
  if (locator_bytes == 0 || !can_teach) return locator_bytes;
  return std::max(locator_bytes, teach::Teacher::required_bytes(limits));
}

}  // namespace

static_assert(FLATPOSE_PATH_AVX2 == static_cast<int>(VectorPath::kAvx2) &&
              FLATPOSE_PATH_AVX512 == static_cast<int>(VectorPath::kAvx512));

size_t flatpose_required_bytes(const flatpose_limits* limits) {
  locate::Limits wanted;
  bool can_teach = false;
  if (read_limits(limits, wanted, can_teach) != Status::kOk) return 0;
  const std::size_t bytes = arena_bytes(wanted, can_teach);
  return bytes > 0 ? bytes + kHandleBytes<flatpose_finder> : 0;
}

flatpose_status flatpose_init(const flatpose_limits* limits, void* memory, size_t memory_bytes,
                              flatpose_finder** finder) {
  if (finder == nullptr) return to_c(Status::kInvalidArgument);
  *finder = nullptr;
  locate::Limits wanted;
  bool can_teach = false;
  if (const Status s = read_limits(limits, wanted, can_teach); s != Status::kOk) return to_c(s);
  const std::size_t bytes = arena_bytes(wanted, can_teach);
  if (memory == nullptr || bytes == 0) return to_c(Status::kInvalidArgument);
  if (memory_bytes < bytes + kHandleBytes<flatpose_finder>) return to_c(Status::kOutOfMemory);

  auto* const made = make_handle<flatpose_finder>(memory);
  const std::span<std::byte> arena(reinterpret_cast<std::byte*>(made) + sizeof(flatpose_finder),
                                   bytes);
  made->can_teach = can_teach;
  Status s = made->locator.init(wanted, arena);
  // One at a time is at work, each from the arena's beginning.
  if (s == Status::kOk && can_teach) s = made->teacher.init(wanted, arena);
  if (s == Status::kOk) *finder = made;
  return to_c(s);
}
