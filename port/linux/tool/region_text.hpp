#pragma once
// Regions as users type them: circle:X,Y,R | box:X0,Y0,X1,Y1 | polygon:X,Y;X,Y;... in mm.

#include <string_view>

#include "flatpose/geometry/region.hpp"

namespace flatpose::tool {

/// Fails: InputError naming `option` when the text is none of the three, holds a number that is not
/// finite, too many corners or no area.
[[nodiscard]] Region parse_region(std::string_view option, std::string_view text);

}  // namespace flatpose::tool
