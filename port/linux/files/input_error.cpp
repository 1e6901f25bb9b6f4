#include "port/linux/files/input_error.hpp"

#include <cstdint>
#include <vector>

namespace flatpose::port {
namespace {

// Length of the well-formed UTF-8 character at the start of `text`; 0 when it is broken.
std::size_t utf8_length_bytes(std::string_view text, std::uint32_t& code) {
  const auto first = static_cast<unsigned char>(text[0]);
  const std::size_t length = first < 0x80   ? 1
                             : first < 0xC2 ? 0
                             : first < 0xE0 ? 2
                             : first < 0xF0 ? 3
                             : first < 0xF5 ? 4
                                            : 0;
  if (length == 0 || length > text.size()) return 0;
  code = length == 1 ? first : first & (0x7Fu >> length);
  for (std::size_t i = 1; i < length; ++i) {
    const auto next = static_cast<unsigned char>(text[i]);
    if ((next & 0xC0) != 0x80) return 0;
    code = code << 6 | (next & 0x3Fu);
  }
  const bool overlong = (length == 3 && code < 0x800) || (length == 4 && code < 0x10000);
  const bool surrogate = code >= 0xD800 && code < 0xE000;
  return overlong || surrogate || code > 0x10FFFF ? 0 : length;
}

// Characters that end a line, drive a terminal or turn the direction of reading.
bool is_unsafe(std::uint32_t code) {
  return code < 0x20 || (code >= 0x7F && code < 0xA0) || (code >= 0x200E && code <= 0x200F) ||
         (code >= 0x2028 && code <= 0x202E) || (code >= 0x2066 && code <= 0x2069) || code == 0xFEFF;
}

std::string escaped(std::string_view bytes) {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    text += {'\\', 'x', kDigits[byte >> 4], kDigits[byte & 15]};
  }
  return text;
}

// Escaped characters of `text` from its start, in pieces that must not be cut.
std::vector<std::string> pieces_of(std::string_view text) {
  std::vector<std::string> pieces;
  while (!text.empty()) {
    std::uint32_t code = 0;
    const std::size_t length = utf8_length_bytes(text, code);
    const std::string_view head = text.substr(0, length == 0 ? 1 : length);
    pieces.push_back(length == 0 || is_unsafe(code) ? escaped(head) : std::string(head));
    text.remove_prefix(head.size());
  }
  return pieces;
}

}  // namespace

std::string printable(std::string_view text, std::size_t bytes_max) {
  static constexpr std::string_view kGap = "...";
  // Content may be of any length; its ends are all that can be shown.
  std::string shortened;
  if (text.size() > 4 * bytes_max) {
    shortened = std::string(text.substr(0, 2 * bytes_max)) +
                std::string(text.substr(text.size() - 2 * bytes_max));
    text = shortened;
  }
  const std::vector<std::string> pieces = pieces_of(text);
  std::size_t size_bytes = 0;
  for (const std::string& piece : pieces) size_bytes += piece.size();
  std::string head;
  if (size_bytes <= bytes_max) {
    for (const std::string& piece : pieces) head += piece;
    return head;
  }
  const std::size_t half_bytes = bytes_max > kGap.size() ? (bytes_max - kGap.size()) / 2 : 0;
  for (std::size_t i = 0; head.size() + pieces[i].size() <= half_bytes; ++i) head += pieces[i];
  std::size_t tail_bytes = 0;
  std::size_t first = pieces.size();
  while (tail_bytes + pieces[first - 1].size() <= half_bytes) tail_bytes += pieces[--first].size();
  head += kGap;
  for (; first < pieces.size(); ++first) head += pieces[first];
  return head;
}

InputError::InputError(std::string_view subject, std::string_view why, std::string_view remedy)
    : line_(printable(subject, kSubjectBytesMax) + ": " + printable(why, kReasonBytesMax) + "; " +
            printable(remedy, kRemedyBytesMax)) {}

}  // namespace flatpose::port
