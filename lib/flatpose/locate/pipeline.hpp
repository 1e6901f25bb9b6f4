#pragma once
// The stages of one search, in the order of the data.

#include "flatpose/locate/locator.hpp"

namespace flatpose::locate {

/// Runs a validated search in the given arena. See Locator::locate.
[[nodiscard]] Status run_pipeline(const model::Template& part, const RangeImageView& scan,
                                  const Frames& frames, const LocateConfig& config,
                                  const Limits& limits, const Host& host, Arena& arena,
                                  LocateResult& result) noexcept;

}  // namespace flatpose::locate
