#pragma once
// Numbers as users type them: all of the text must be one, finite and within bounds.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace flatpose::tool {

/// Coordinates beyond a kilometre are typing errors.
inline constexpr double kTypedCoordinateMax_mm = 1.0e6;

/// The number `text` spells.  Fails: InputError naming `option`.
[[nodiscard]] double parse_number(std::string_view option, std::string_view text, double low,
                                  double high);
[[nodiscard]] std::int64_t parse_whole(std::string_view option, std::string_view text,
                                       std::int64_t low, std::int64_t high);
/// An unsigned number of 64 bits, as seeds are.
[[nodiscard]] std::uint64_t parse_seed(std::string_view option, std::string_view text);
/// `count` numbers with commas between them; `form` ("X,Y") is for the message.
[[nodiscard]] std::vector<double> parse_numbers(std::string_view option, std::string_view text,
                                                std::size_t count, std::string_view form);
/// The pieces between the separators, empty ones too.
[[nodiscard]] std::vector<std::string_view> split(std::string_view text, char separator);

/// printf into a string.
[[nodiscard]] std::string formatted(const char* format, ...) __attribute__((format(printf, 1, 2)));

}  // namespace flatpose::tool
