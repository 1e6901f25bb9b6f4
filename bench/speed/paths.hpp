#pragma once
// The vector paths that this processor has, by name.

#include <string>
#include <vector>

#include "flatpose/core/vector_path.hpp"

namespace flatpose::bench {

struct NamedPath {
  std::string name;
  VectorPath path;
};

/// The narrowest first.
[[nodiscard]] const std::vector<NamedPath>& vector_paths();

}  // namespace flatpose::bench
