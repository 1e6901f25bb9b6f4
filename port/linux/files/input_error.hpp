#pragma once
// What is wrong with what the user gave, why, and what to do about it, in one line:
// `WHAT: WHY; REMEDY`. File names and file content may be hostile, so control characters are
// escaped and the length is bounded: a message never breaks a log or a terminal.

#include <cstddef>
#include <exception>
#include <string>
#include <string_view>

namespace flatpose::port {

inline constexpr std::size_t kSubjectBytesMax = 400;  // names a file: long paths lose their middle
inline constexpr std::size_t kReasonBytesMax = 400;
inline constexpr std::size_t kRemedyBytesMax = 300;

/// `text` fit for one line of a log: control, direction and line-separating characters and broken
/// UTF-8 become \xNN; what is longer than `bytes_max` loses its middle.
[[nodiscard]] std::string printable(std::string_view text, std::size_t bytes_max);

/// An input, an output path or a setting that cannot be used. The tool answers with exit code 2.
struct InputError : std::exception {
  InputError(std::string_view subject, std::string_view why, std::string_view remedy);

  /// The whole line, without a line feed.
  [[nodiscard]] const char* what() const noexcept override { return line_.c_str(); }
  [[nodiscard]] const std::string& line() const noexcept { return line_; }

 private:
  std::string line_;
};

}  // namespace flatpose::port
