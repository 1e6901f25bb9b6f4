#include "port/linux/tool/number_text.hpp"

#include <charconv>
#include <cmath>
#include <cstdarg>
#include <cstdio>

#include "port/linux/files/input_error.hpp"

namespace flatpose::tool {
namespace {

constexpr std::size_t kShownBytesMax = 60;

std::string quoted(std::string_view text) {
  return "\"" + port::printable(text, kShownBytesMax) + "\"";
}

template <class T>
bool read_all(std::string_view text, T& value) {
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc{} && stop == end && !text.empty();
}

}  // namespace

double parse_number(std::string_view option, std::string_view text, double low, double high) {
  double value = 0.0;
  const std::string range = formatted("give one from %.12g to %.12g", low, high);
  if (!read_all(text, value) || !std::isfinite(value))
    throw port::InputError(option, quoted(text) + " is no number", range);
  if (value < low || value > high)
    throw port::InputError(option, quoted(text) + " is out of range", range);
  return value;
}

std::int64_t parse_whole(std::string_view option, std::string_view text, std::int64_t low,
                         std::int64_t high) {
  std::int64_t value = 0;
  const std::string range = "give one from " + std::to_string(low) + " to " + std::to_string(high);
  if (!read_all(text, value))
    throw port::InputError(option, quoted(text) + " is no whole number", range);
  if (value < low || value > high)
    throw port::InputError(option, quoted(text) + " is out of range", range);
  return value;
}

std::uint64_t parse_seed(std::string_view option, std::string_view text) {
  std::uint64_t value = 0;
  if (!read_all(text, value))
    throw port::InputError(option, quoted(text) + " is no whole number of 0 or more",
                           "give one, for example 1");
  return value;
}

std::vector<double> parse_numbers(std::string_view option, std::string_view text, std::size_t count,
                                  std::string_view form) {
  const std::vector<std::string_view> pieces = split(text, ',');
  if (pieces.size() != count)
    throw port::InputError(option,
                           quoted(text) + " has " + std::to_string(pieces.size()) +
                               " numbers instead of " + std::to_string(count),
                           "write it as " + std::string(form));
  std::vector<double> numbers;
  for (const std::string_view piece : pieces)
    numbers.push_back(parse_number(option, piece, -kTypedCoordinateMax_mm, kTypedCoordinateMax_mm));
  return numbers;
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> pieces;
  while (true) {
    const std::size_t at = text.find(separator);
    pieces.push_back(text.substr(0, at));
    if (at == std::string_view::npos) return pieces;
    text.remove_prefix(at + 1);
  }
}

std::string formatted(const char* format, ...) {
  std::va_list args;
  va_start(args, format);
  std::va_list again;
  va_copy(again, args);
  const int length = std::vsnprintf(nullptr, 0, format, args);
  va_end(args);
  std::string text(length > 0 ? static_cast<std::size_t>(length) : 0, '\0');
  if (length > 0) std::vsnprintf(text.data(), text.size() + 1, format, again);
  va_end(again);
  return text;
}

}  // namespace flatpose::tool
