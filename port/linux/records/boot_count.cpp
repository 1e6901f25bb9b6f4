#include "port/linux/records/boot_count.hpp"

#include <filesystem>
#include <nlohmann/json.hpp>

#include "port/linux/files/atomic_file.hpp"
#include "port/linux/files/input_error.hpp"
#include "port/linux/files/json_text.hpp"

namespace flatpose::port {
namespace {

constexpr std::int64_t kFileBytesMax = 4096;
constexpr const char* kKey = "boot_count";

std::uint16_t count_in(const std::string& path) {
  const nlohmann::json json = parse_json(path, read_file(path, kFileBytesMax));
  const JsonPlace place = JsonPlace(path, json)[kKey];
  const std::uint64_t count = place.whole_number();
  if (count > UINT16_MAX) place.fail("it is more than 65535");
  return static_cast<std::uint16_t>(count);
}

}  // namespace

std::uint16_t count_boot(const std::string& path,
                         const std::function<void(const std::string&)>& warn) {
  std::uint16_t before = 0;
  std::error_code error;
  try {
    if (std::filesystem::exists(path, error)) before = count_in(path);
  } catch (const InputError& damage) {
    warn("starts are counted anew: " + damage.line());
  }
  const auto count = static_cast<std::uint16_t>(before == UINT16_MAX ? 1 : before + 1);
  try {
    write_file_atomically(path, nlohmann::json{{kKey, count}}.dump() + "\n");
  } catch (const InputError& refusal) {
    warn("starts are not counted: " + refusal.line());
    return 0;
  }
  return count;
}

}  // namespace flatpose::port
