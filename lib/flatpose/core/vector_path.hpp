#pragma once
// Which form of the vectorised loops runs. All give the same bits. What the processor can do is
// found out by the port; lib asks no operating system.

#include <cstdint>

namespace flatpose {

enum class VectorPath : std::uint8_t {
  kPortable = 0,  ///< What every processor of its kind has: SSE2 on x86-64, NEON on 64-bit Arm.
  kAvx2 = 1,
  kAvx512 = 2,        ///< With the byte and word instructions (BW).
  kNeon = kPortable,  ///< Vectors of 16 bytes too: on 64-bit Arm the portable form is NEON.
};

}  // namespace flatpose

// The one table of which form runs on a path; the portable one where this build has no other. A
// macro, because the wide forms exist for x86-64 only and must not even be named elsewhere.
#if defined(__x86_64__)
#define FLATPOSE_FORM_FOR(path, portable, avx2, avx512) \
  ((path) == ::flatpose::VectorPath::kAvx512 ? (avx512) \
   : (path) == ::flatpose::VectorPath::kAvx2 ? (avx2)   \
                                             : (portable))
#else
#define FLATPOSE_FORM_FOR(path, portable, avx2, avx512) (static_cast<void>(path), (portable))
#endif
