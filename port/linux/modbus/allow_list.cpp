#include "port/linux/modbus/allow_list.hpp"

#include <arpa/inet.h>

#include <charconv>

namespace flatpose::port {
namespace {

constexpr int kAddressBits = 32;

std::optional<int> parse_bits(const std::string& text) {
  int bits = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, bits);
  const bool is_number = error == std::errc() && stop == end && text.front() != '-';
  return is_number && bits <= kAddressBits ? std::optional(bits) : std::nullopt;
}

}  // namespace

std::optional<Network> parse_network(const std::string& text) {
  const std::size_t slash = text.find('/');
  in_addr parsed{};
  if (inet_pton(AF_INET, text.substr(0, slash).c_str(), &parsed) != 1) return std::nullopt;
  int bits = kAddressBits;
  if (slash != std::string::npos) {
    const auto given = parse_bits(text.substr(slash + 1));
    if (!given) return std::nullopt;
    bits = *given;
  }
  const std::uint32_t mask = bits == 0 ? 0 : ~std::uint32_t{0} << (kAddressBits - bits);
  const Network network{ntohl(parsed.s_addr), mask};
  return network.contains(network.address) ? std::optional(network) : std::nullopt;
}

}  // namespace flatpose::port
