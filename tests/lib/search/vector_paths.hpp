#pragma once
// Every form of the vectorised loops that this processor can run.

#include <ostream>
#include <vector>

#include "port/linux/cpu/vector_path.hpp"

namespace flatpose {

inline std::vector<VectorPath> vector_paths() {
  std::vector<VectorPath> paths;
  for (int path = 0; path <= static_cast<int>(port::best_vector_path()); ++path)
    paths.push_back(static_cast<VectorPath>(path));
  return paths;
}

/// For counts that every path adds to.
inline int path_count() { return static_cast<int>(vector_paths().size()); }

inline void PrintTo(VectorPath path, std::ostream* out) {
  constexpr const char* kNames[] = {"Portable", "Avx2", "Avx512"};
  *out << kNames[static_cast<int>(path)];
}

}  // namespace flatpose
