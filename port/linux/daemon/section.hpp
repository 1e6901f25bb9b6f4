#pragma once
// A table of the config file and its values. Every reader says what may be there; what nobody asked
// for is refused by finish(). All messages name file and line: `FILE:LINE: WHAT; REMEDY`.

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace flatpose::daemon {

inline constexpr std::int64_t kConfigBytesMax = 1 << 20;

struct Range {
  std::int64_t least = 0;
  std::int64_t greatest = std::numeric_limits<std::int64_t>::max();
};

class Section {
 public:
  /// The whole file.  Fails: port::InputError when it cannot be read or is not TOML.
  static Section of_file(const std::string& path);
  static Section of_text(const std::string& path, std::string_view text);

  /// Each fails with port::InputError when the value is there but of another type or out of range.
  [[nodiscard]] std::optional<std::int64_t> whole(const std::string& key, Range range);
  [[nodiscard]] std::vector<std::int64_t> wholes(const std::string& key, Range range,
                                                 std::size_t count_max);
  [[nodiscard]] std::optional<double> number(const std::string& key, double least, double greatest);
  [[nodiscard]] std::optional<bool> flag(const std::string& key);
  [[nodiscard]] std::vector<double> numbers(const std::string& key, double least, double greatest,
                                            std::size_t count);
  [[nodiscard]] std::optional<std::string> text(const std::string& key);
  [[nodiscard]] std::vector<std::string> texts(const std::string& key, std::size_t count_max);
  /// The index of the text among `words`.
  [[nodiscard]] std::optional<int> choice(const std::string& key,
                                          const std::vector<std::string>& words);
  /// A path; a relative one starts where the config file is.
  [[nodiscard]] std::optional<std::string> file(const std::string& key);
  /// [key]; one that is not there is empty.
  [[nodiscard]] Section section(const std::string& key);
  /// [[key]], in their order.
  [[nodiscard]] std::vector<Section> sections(const std::string& key);

  /// Whether the file has it.
  [[nodiscard]] bool is_there() const noexcept;
  /// "FILE:LINE", of the value or, when it is not there, of the section.
  [[nodiscard]] std::string place_of(const std::string& key) const;

  /// Refuses what was not asked for, with what may have been meant.
  void finish() const;

  /// Says what is wrong with a value, or, when it is not there, with the section.
  [[noreturn]] void fail(const std::string& key, const std::string& what,
                         const std::string& remedy) const;

 private:
  struct Place;
  explicit Section(std::shared_ptr<Place> place) noexcept : place_(std::move(place)) {}
  std::shared_ptr<Place> place_;
};

/// Names the tables and values at the top of two sound configs that differ, but for those named.
[[nodiscard]] std::vector<std::string> changed_tables(std::string_view before,
                                                      std::string_view after,
                                                      const std::vector<std::string>& but);

}  // namespace flatpose::daemon
