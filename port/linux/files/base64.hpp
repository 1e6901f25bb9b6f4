#pragma once
// Base64 with padding (RFC 4648, section 4).

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

namespace flatpose::port {

struct Base64Result {
  std::vector<std::byte> bytes;
  std::optional<std::size_t> wrong_character;  ///< Index of the first that cannot stand there.
};

/// Decodes `text`. Its length must be a multiple of 4; else the wrong character is its end.
[[nodiscard]] Base64Result decode_base64(std::string_view text);

}  // namespace flatpose::port
