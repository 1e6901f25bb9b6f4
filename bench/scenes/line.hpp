#pragma once
// A trial as one line of JSON.

#include <string>
#include <vector>

#include "bench/scenes/cause.hpp"
#include "bench/scenes/trial.hpp"

namespace flatpose::bench {

/// An instance that should have been found and was not, and what the locator makes of it.
struct Lost {
  int instance = 0;
  Probe probe;
  std::string stage;
};

struct Record {
  const Shot& shot;
  const Taught& taught;
  const Trial& trial;
  std::string sensor;
  int max_matches = 1;
  bool expects_target = true;
  std::string cause;
  std::vector<Lost> lost;
  std::string picture;  ///< Its path, when one was drawn.
};

[[nodiscard]] std::string json_line(const Record& record);

}  // namespace flatpose::bench
