#pragma once
// The numbers that registers may hold, with their names: from the job machine's own tables.

#include <string>
#include <vector>

#include "flatpose/result_map/entry.hpp"

namespace flatpose::tool {

struct NamedValue {
  int value;
  std::string name;
  std::string doc;
};

[[nodiscard]] std::vector<NamedValue> values_of(result_map::ValueSet set);

/// "bits" are told by index, all else by value.
[[nodiscard]] inline bool is_bits(result_map::ValueSet set) {
  return set == result_map::ValueSet::kBits || set == result_map::ValueSet::kControlBits;
}

}  // namespace flatpose::tool
