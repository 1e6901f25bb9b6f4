#pragma once
// Whole files in, whole files out. A file is read within a bound, and only when it is one (a pipe
// would block, a device never ends). It is written beside its target and renamed onto it, so that a
// reader, a full disk or a loss of power never leaves half of it.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace flatpose::port {

/// All bytes of the regular file `path`.
/// Fails: InputError when it is missing, unreadable, not a regular file or longer than
/// `bytes_max`. Memory: the file's length, whatever is said inside it.
[[nodiscard]] std::vector<std::byte> read_file(const std::string& path, std::int64_t bytes_max);

/// What a loss of power may do to a file that was written: nothing, or put back what stood at its
/// path before, until the folder is synced for another file. Half of it is never there.
enum class NewName : std::uint8_t { kOutlastsPower, kMayBeLost };

/// Puts `bytes` at `path`, replacing what stands there (a link is followed, rights are kept).
/// Cost: waits for the disk, twice when the name is to outlast a loss of power.
/// Fails: InputError; then `path` is as it was and no temporary file is left.
void write_file_atomically(const std::string& path, std::span<const std::byte> bytes,
                           NewName name = NewName::kOutlastsPower);
void write_file_atomically(const std::string& path, std::string_view text,
                           NewName name = NewName::kOutlastsPower);

/// The bytes as characters, without a copy.
[[nodiscard]] inline std::string_view as_text(std::span<const std::byte> bytes) noexcept {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace flatpose::port
