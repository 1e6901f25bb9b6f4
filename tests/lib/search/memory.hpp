#pragma once
// Random numbers that are the same everywhere, and memory of a test's own.

#include <cstddef>
#include <random>
#include <span>
#include <vector>

#include "flatpose/core/arena.hpp"

namespace flatpose::search {

inline double uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
}
inline int integer(std::mt19937& random, int low, int high) {
  return low + static_cast<int>(random() % static_cast<unsigned>(high - low + 1));
}

/// An arena over bytes of its own.
struct Memory {
  std::vector<std::byte> bytes;
  Arena arena;
  explicit Memory(std::size_t size_bytes) : bytes(size_bytes), arena(std::span(bytes)) {}
};

}  // namespace flatpose::search
