#pragma once
// What a sound config most likely does not mean: said at each start, and by --check.

#include <optional>
#include <string>
#include <vector>

#include "port/linux/daemon/config.hpp"

namespace flatpose::daemon {

[[nodiscard]] std::vector<std::string> warnings_of(const Config& config);

/// Which job may take longer to answer than a CAN master may be silent, and how it is heard in
/// between; none: no job, or the master beats.  Advice: most answers come sooner.
[[nodiscard]] std::optional<std::string> lease_advice(const Config& config);

}  // namespace flatpose::daemon
