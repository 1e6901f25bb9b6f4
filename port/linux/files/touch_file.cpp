#include "port/linux/files/touch_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "port/linux/files/atomic_file.hpp"
#include "port/linux/files/input_error.hpp"
#include "port/linux/files/scan.hpp"

namespace flatpose::port {
namespace {

constexpr std::int64_t kFileBytesMax = 4 << 20;
constexpr std::size_t kColumns = 6;
constexpr std::array<std::string_view, kColumns> kNames{"scan_x",  "scan_y",  "scan_z",
                                                        "robot_x", "robot_y", "robot_z"};
constexpr const char* kForm = "give scan_x,scan_y,scan_z,robot_x,robot_y,robot_z in mm";

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r\"";
  const std::size_t begin = text.find_first_not_of(kBlank);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlank) - begin + 1);
}

std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  for (;;) {
    const std::size_t end = line.find_first_of(",;");
    fields.push_back(trimmed(line.substr(0, end)));
    if (end == std::string_view::npos || fields.size() > 2 * kColumns) return fields;
    line.remove_prefix(end + 1);
  }
}

/// Which column each field of a line is; empty: the line holds no name.
std::vector<std::size_t> columns_of(const std::vector<std::string_view>& fields) {
  std::vector<std::size_t> columns;
  for (const std::string_view field : fields) {
    const auto found = std::find(kNames.begin(), kNames.end(), field);
    if (found == kNames.end()) return {};
    columns.push_back(static_cast<std::size_t>(found - kNames.begin()));
  }
  return columns;
}

class Reader {
 public:
  explicit Reader(const std::string& path) : path_(path) {}

  std::vector<TouchedPair> read(std::string_view text) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (text.substr(0, kByteOrderMark.size()) == kByteOrderMark)
      text.remove_prefix(kByteOrderMark.size());
    while (!text.empty()) {
      const std::size_t end = text.find('\n');
      ++line_;
      take(trimmed(text.substr(0, end).substr(0, text.substr(0, end).find('#'))));
      text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    }
    return std::move(pairs_);
  }

 private:
  [[noreturn]] void fail(const std::string& why, const std::string& remedy = kForm) const {
    throw InputError(path_ + ":" + std::to_string(line_), why, remedy);
  }

  void take(std::string_view line) {
    if (line.empty()) return;
    const auto fields = fields_of(line);
    const bool is_first = std::exchange(is_first_, false);
    if (is_first && take_names(fields)) return;
    if (fields.size() != kColumns)
      fail("there are " + std::to_string(fields.size()) + " numbers, not 6");
    if (pairs_.size() == kTouchedPairsMax)
      fail("there are more than " + std::to_string(kTouchedPairsMax) + " pairs", "take some out");
    std::array<double, kColumns> values{};
    for (std::size_t i = 0; i < kColumns; ++i) values[columns_[i]] = number(fields[i]);
    pairs_.push_back(
        {line_, {values[0], values[1], values[2]}, {values[3], values[4], values[5]}, 0.0});
  }

  bool take_names(const std::vector<std::string_view>& fields) {
    const bool has_letter = std::any_of(fields.begin(), fields.end(), [](std::string_view field) {
      return field.find_first_of("_xyzXYZ") != std::string_view::npos;
    });
    if (!has_letter) return false;
    const std::vector<std::size_t> columns = columns_of(fields);
    std::vector<std::size_t> sorted = columns;
    std::sort(sorted.begin(), sorted.end());
    if (columns.size() != kColumns || std::unique(sorted.begin(), sorted.end()) != sorted.end())
      fail("the line of names is not those of the six columns",
           "name scan_x,scan_y,scan_z,robot_x,robot_y,robot_z in any order, or leave it out");
    std::copy(columns.begin(), columns.end(), columns_.begin());
    return true;
  }

  [[nodiscard]] double number(std::string_view field) const {
    double value = 0.0;
    if (!field.empty() && field.front() == '+') field.remove_prefix(1);
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    if (error != std::errc() || end != field.data() + field.size() || !std::isfinite(value))
      fail("'" + printable(field, 40) + "' is no number");
    if (std::fabs(value) > kCoordinateMax_mm)
      fail("'" + printable(field, 40) + "' lies beyond +-1e6 mm", "give coordinates in mm");
    return value;
  }

  const std::string& path_;
  int line_ = 0;
  bool is_first_ = true;
  std::array<std::size_t, kColumns> columns_{0, 1, 2, 3, 4, 5};
  std::vector<TouchedPair> pairs_;
};

}  // namespace

std::vector<TouchedPair> read_touch_file(const std::string& path) {
  const std::vector<std::byte> bytes = read_file(path, kFileBytesMax);
  return Reader(path).read(as_text(bytes));
}

}  // namespace flatpose::port
