#include "port/linux/daemon/arrivals.hpp"

#include <algorithm>

namespace flatpose::daemon {

void Arrivals::mark() {
  ++marks_;
  fresh_.clear();
  stale_.clear();
  std::erase_if(known_, [](const auto& entry) { return entry.second.arrival.is_finished; });
}

void Arrivals::add(const std::string& name, const Known& known) {
  if (known_.size() >= kArrivalsMax) forget();
  known_[name] = known;
}

void Arrivals::finished(const std::string& name, const Known& known) {
  if (known.mark != marks_) {
    stale_ = name;
  } else if (fresh_.size() < kArrivalsMax) {
    let_go(name);
    fresh_.push_back(name);
  }
}

void Arrivals::created(const std::string& name, std::int64_t now_us) {
  let_go(name);
  add(name, {{now_us, false, false}, marks_});
}

void Arrivals::closed(const std::string& name) {
  const auto found = known_.find(name);
  if (found == known_.end()) return finished(name, {});
  // Written once more after it was finished: it is as new as it was.
  found->second.arrival.is_finished = true;
  finished(name, found->second);
}

void Arrivals::moved_out(const std::string& name, std::uint32_t cookie) {
  const auto found = known_.find(name);
  moving_cookie_ = cookie;
  moving_ = found != known_.end() ? found->second : Known{{0, true, false}, 0};
  removed(name);
}

void Arrivals::moved_in(const std::string& name, std::uint32_t cookie, std::int64_t now_us) {
  const bool is_renamed = cookie != 0 && cookie == moving_cookie_;
  const Known known = is_renamed ? moving_ : Known{{now_us, true, true}, marks_};
  moving_cookie_ = 0;
  removed(name);  // what was there before is replaced
  add(name, known);
  if (known.arrival.is_finished) finished(name, known);
}

void Arrivals::removed(const std::string& name) {
  known_.erase(name);
  let_go(name);
}

void Arrivals::forget() {
  std::erase_if(known_, [](const auto& entry) { return !entry.second.arrival.is_finished; });
  if (known_.size() >= kArrivalsMax) known_.clear();
  moving_cookie_ = 0;
}

const Arrival* Arrivals::find(const std::string& name) const {
  const auto found = known_.find(name);
  return found == known_.end() ? nullptr : &found->second.arrival;
}

void Arrivals::let_go(const std::string& name) { std::erase(fresh_, name); }

}  // namespace flatpose::daemon
