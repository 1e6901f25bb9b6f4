#pragma once
// What the library's Status means to who typed the command.

#include <string>

#include "flatpose/core/status.hpp"

namespace flatpose::tool {

enum class Doing { kTeach, kTeachByMask, kLocate, kSurvey, kReadTemplate, kWriteTemplate };

/// Throws what `status`, which is not kOk, says about `subject` (a file or option): InputError for
/// what the user can mend, std::logic_error for what only we can.
[[noreturn]] void fail(Status status, Doing doing, const std::string& subject);

}  // namespace flatpose::tool
