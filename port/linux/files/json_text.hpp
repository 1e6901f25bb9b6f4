#pragma once
// JSON files through nlohmann-json, within limits, and their values with messages that name the
// place. For this folder's .cpp files only: it pulls the JSON library in.

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>

namespace flatpose::port {

inline constexpr int kJsonDepthMax = 32;
inline constexpr std::size_t kJsonValuesMax = 100'000;  // pixels come in one string, not in numbers

/// Fails: InputError naming line and column of the first wrong byte, or the limit passed.
[[nodiscard]] nlohmann::json parse_json(const std::string& path, std::span<const std::byte> bytes);

/// A value inside the file, which knows how to name itself: `data.PixelSize.x`.
class JsonPlace {
 public:
  JsonPlace(const std::string& path, const nlohmann::json& value, std::string name = {})
      : path_(&path), value_(&value), name_(std::move(name)) {}

  [[nodiscard]] const nlohmann::json& value() const noexcept { return *value_; }
  [[nodiscard]] bool has(std::string_view key) const;
  /// The member `key` of an object.
  [[nodiscard]] JsonPlace operator[](std::string_view key) const;
  /// The element `index` of a list that has `count`.
  [[nodiscard]] JsonPlace element(std::size_t index, std::size_t count) const;

  /// A finite number.
  [[nodiscard]] double number() const;
  [[nodiscard]] double positive_number() const;
  [[nodiscard]] std::uint64_t whole_number() const;
  [[nodiscard]] const std::string& text() const;

  [[noreturn]] void fail(std::string_view why, std::string_view remedy = kCorrect) const;

 private:
  static constexpr std::string_view kCorrect = "correct the file or write it again";

  const std::string* path_;
  const nlohmann::json* value_;
  std::string name_;
};

}  // namespace flatpose::port
