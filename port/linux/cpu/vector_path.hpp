#pragma once
// What this processor can do, for lib's vectorised loops.

#include "flatpose/core/vector_path.hpp"

namespace flatpose::port {

/// The widest path that this processor and the operating system support.
[[nodiscard]] VectorPath best_vector_path() noexcept;

}  // namespace flatpose::port
