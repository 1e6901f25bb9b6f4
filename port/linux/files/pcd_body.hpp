#pragma once
// The points below a PCD's header, in its three encodings.

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "port/linux/files/pcd_header.hpp"

namespace flatpose::port {

/// x, y, z of every point, interleaved. `body` is what follows the header.
/// Fails: InputError when the body is not what the header promises, before memory is taken for it.
[[nodiscard]] std::vector<float> read_pcd_body(const std::string& path, const PcdHeader& header,
                                               std::span<const std::byte> body,
                                               const ReadLimits& limits);

}  // namespace flatpose::port
