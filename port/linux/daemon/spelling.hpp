#pragma once
// What somebody may have meant.

#include <string>
#include <string_view>
#include <vector>

namespace flatpose::daemon {

/// The known word that is the fewest letters away (one added, left out, changed, or two exchanged);
/// empty when none is near enough to be meant.
[[nodiscard]] std::string nearest_word(std::string_view word,
                                       const std::vector<std::string>& known);

}  // namespace flatpose::daemon
