#pragma once
// A locator whose memory is kept from scan to scan, as a daemon's is.

#include <memory>

#include "bench/scenes/trial.hpp"

namespace flatpose::bench {

class Station {
 public:
  /// Fails: std::runtime_error when locate() refuses.
  [[nodiscard]] locate::LocateResult locate(const Shot& shot, const model::Template& part,
                                            const locate::LocateConfig& config, VectorPath path);

 private:
  std::unique_ptr<tool::Memory> memory_;
};

}  // namespace flatpose::bench
