#pragma once
// What became of one step of a set-up. Nothing here is worth failing for: a search without it gives
// the same answer, only at a less certain time.

#include <string>
#include <vector>

namespace flatpose::port {

struct Step {
  bool is_done = false;
  std::string what;    ///< "search thread 0: SCHED_FIFO 80"
  std::string why;     ///< When not done.
  std::string remedy;  ///< When not done.
};
using Steps = std::vector<Step>;

/// In one line: `WHAT` or `WHAT: WHY; REMEDY`.
[[nodiscard]] inline std::string line_of(const Step& step) {
  return step.is_done ? step.what : step.what + ": " + step.why + "; " + step.remedy;
}

inline void append(Steps& steps, Steps&& more) {
  for (Step& step : more) steps.push_back(std::move(step));
}

}  // namespace flatpose::port
