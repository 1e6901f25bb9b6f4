#include "port/linux/files/base64.hpp"

#include <array>
#include <cstdint>

namespace flatpose::port {
namespace {

constexpr std::string_view kAlphabet =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr std::uint8_t kNone = 0xFF;

constexpr std::array<std::uint8_t, 256> make_values() {
  std::array<std::uint8_t, 256> values{};
  values.fill(kNone);
  for (std::size_t i = 0; i < kAlphabet.size(); ++i)
    values[static_cast<unsigned char>(kAlphabet[i])] = static_cast<std::uint8_t>(i);
  return values;
}
constexpr std::array<std::uint8_t, 256> kValues = make_values();

}  // namespace

Base64Result decode_base64(std::string_view text) {
  Base64Result result;
  const std::size_t padding = text.ends_with("==") ? 2 : text.ends_with('=') ? 1 : 0;
  const std::size_t digit_count = text.size() - padding;
  result.bytes.reserve(digit_count / 4 * 3 + 2);
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < digit_count; ++i) {
    const std::uint8_t value = kValues[static_cast<unsigned char>(text[i])];
    if (value == kNone) {
      result.wrong_character = i;
      return result;
    }
    bits = bits << 6 | value;
    // Each group of four digits gives a byte with its second, third and fourth.
    const unsigned spare_bits = 6 - 2 * (i % 4);
    if (i % 4 != 0) result.bytes.push_back(static_cast<std::byte>(bits >> spare_bits & 0xFF));
  }
  if (text.size() % 4 != 0) result.wrong_character = text.size();
  return result;
}

}  // namespace flatpose::port
