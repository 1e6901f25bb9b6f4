#pragma once
// The library's survey of a scan, with memory of its own.

#include "flatpose/rectify/survey.hpp"
#include "port/linux/tool/loaded_scan.hpp"

namespace flatpose::tool {

/// Fails: InputError.
[[nodiscard]] rectify::Survey survey_of(const LoadedScan& loaded);

}  // namespace flatpose::tool
