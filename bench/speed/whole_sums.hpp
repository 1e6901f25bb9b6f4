#pragma once
// The search's own block loop without early termination: the same text, but that it never asks
// whether a block can still win (the build makes it, see CMakeLists.txt).

#include "flatpose/search/block_search.hpp"

namespace flatpose::bench {

/// Null when the library's loop no longer has the line that the build takes out.
[[nodiscard]] search::SearchBlock whole_sums_for(VectorPath path) noexcept;

}  // namespace flatpose::bench
