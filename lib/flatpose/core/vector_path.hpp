#pragma once
// Which form of the vectorised loops runs. All give the same bits. What the processor can do is
// found out by the port; lib asks no operating system.

#include <cstdint>

namespace flatpose {

enum class VectorPath : std::uint8_t {
  kPortable = 0,  ///< What the compiler may take for granted: SSE2 on x86-64, NEON on 64-bit Arm.
  kAvx2 = 1,
  kAvx512 = 2,  ///< With the byte and word instructions (BW).
};

}  // namespace flatpose
