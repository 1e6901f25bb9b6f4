#pragma once
// How often the daemon was started, kept in a small file: {"boot_count":3}.

#include <cstdint>
#include <functional>
#include <string>

namespace flatpose::port {

/// Counts this start: 1 after the first, and after 65535. A file that cannot be understood is
/// begun anew; when this start cannot be written down it is 0, which says that nobody counts.
/// Both are told to `warn`, in a line.
[[nodiscard]] std::uint16_t count_boot(const std::string& path,
                                       const std::function<void(const std::string&)>& warn);

}  // namespace flatpose::port
