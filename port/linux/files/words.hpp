#pragma once
// Words and numbers of a line of text, without locale and without copies.

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <optional>
#include <string_view>
#include <system_error>

namespace flatpose::port {

/// Takes the next word off `text`; empty when there is none.
[[nodiscard]] inline std::string_view take_word(std::string_view& text) noexcept {
  constexpr std::string_view kBlank = " \t\r\v\f";
  const std::size_t begin = text.find_first_not_of(kBlank);
  if (begin == std::string_view::npos) {
    text = {};
    return {};
  }
  const std::size_t end = std::min(text.find_first_of(kBlank, begin), text.size());
  const std::string_view word = text.substr(begin, end - begin);
  text.remove_prefix(end);
  return word;
}

/// Takes the next line off `text`, without its line feed.
[[nodiscard]] inline std::string_view take_line(std::string_view& text) noexcept {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

/// The number that is all of `word`; none when it is something else or out of T's range.
template <class T>
[[nodiscard]] std::optional<T> parse_number(std::string_view word) noexcept {
  T value{};
  const char* end = word.data() + word.size();
  const auto [rest, error] = std::from_chars(word.data(), end, value);
  if (error != std::errc{} || rest != end) return {};
  return value;
}

}  // namespace flatpose::port
