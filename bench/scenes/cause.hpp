#pragma once
// What went wrong, in a word for tables and file names, and where in the pipeline it did.
//
//   not_found               no answer
//   false_match[_on_PART]   an answer where the part is not; PART is what lies there
//   upside_down             an answer on an instance that lies on its face
//   hidden_instance         right, but on an instance that is not half visible
//   flip                    on an instance, turned by more than 45 degrees
//   position, tilt, turn    on an instance, beyond that coarse bound most of all
//   fine_position, ...      coarsely right, beyond that fine bound most of all
//   missed, wrong, double   among several matches
//   no_target               the scene holds no instance that is visible enough: the scene's fault

#include <optional>
#include <string>

#include "bench/scenes/trial.hpp"

namespace flatpose::bench {

/// Empty when nothing went wrong. `expects_target`: that the scene promises one.
[[nodiscard]] std::string cause_of_first(const Trial& trial, const Shot& shot, int fold,
                                         bool expects_target);
[[nodiscard]] std::string cause_of_all(const Trial& trial);

/// What the locator makes of an instance when it is asked for that place alone, without a
/// threshold.
struct Probe {
  bool is_found = false;  ///< Coarsely right.
  double score = 0.0;
  double visible = 0.0;
};
[[nodiscard]] Probe probe(Searcher& searcher, const Shot& shot, const Taught& taught,
                          const Truth& truth);

/// "verification": looked at the place, the part is there but does not pass; "competition": it
/// would pass, but lost its place to other candidates; "search": not even found when nothing else
/// is asked for.
[[nodiscard]] std::string stage_of(const Probe& probe, const Taught& taught,
                                   const locate::LocateConfig& config);

}  // namespace flatpose::bench
