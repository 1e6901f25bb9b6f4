#pragma once
// Who may connect at all: networks, as "192.0.2.0/24", and single addresses.

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace flatpose::port {

/// All addresses that agree with `address` where `mask` has ones.
struct Network {
  std::uint32_t address = 0;
  std::uint32_t mask = 0;

  [[nodiscard]] bool contains(std::uint32_t other) const noexcept {
    return (other & mask) == address;
  }
};

/// "192.0.2.0/24", or "192.0.2.7" for one alone; nothing for what is neither, and for an address
/// that has ones beyond its network's.
[[nodiscard]] std::optional<Network> parse_network(const std::string& text);

/// An empty list admits everybody.
struct AllowList {
  std::vector<Network> networks;

  [[nodiscard]] bool admits(std::uint32_t address) const noexcept {
    return networks.empty() || std::any_of(networks.begin(), networks.end(),
                                           [&](const Network& n) { return n.contains(address); });
  }
};

}  // namespace flatpose::port
