#include "port/linux/files/pcd_header.hpp"

#include <cmath>
#include <string_view>

#include "port/linux/files/atomic_file.hpp"
#include "port/linux/files/input_error.hpp"
#include "port/linux/files/words.hpp"

namespace flatpose::port {
namespace {

constexpr const char* kSaveAgain = "save it again as PCD 0.7";

// One keyword's values and the line they stand in; line 0: not there.
struct Entry {
  std::string_view values;
  std::size_t line = 0;
};

class HeaderReader {
 public:
  HeaderReader(const std::string& path, std::span<const std::byte> bytes)
      : path_(path), text_(as_text(bytes)) {}

  PcdHeader read(const ReadLimits& limits) {
    PcdHeader header;
    header.data_offset_bytes = read_lines();
    header.line_count = line_count_;
    header.is_simulated = is_simulated_;
    check_version();
    header.data = data_kind();
    read_fields(header);
    read_shape(header, limits);
    read_viewpoint(header);
    return header;
  }

 private:
  static constexpr std::array<std::string_view, 10> kKeywords{
      "VERSION", "FIELDS", "SIZE",      "TYPE",   "COUNT",
      "WIDTH",   "HEIGHT", "VIEWPOINT", "POINTS", "DATA"};

  [[noreturn]] void fail(std::size_t line, std::string_view why, std::string_view remedy) const {
    throw InputError(path_, "line " + std::to_string(line) + ": " + std::string(why), remedy);
  }

  // Sorts the lines by keyword up to DATA; the number of bytes they take.
  std::size_t read_lines() {
    std::string_view rest = text_;
    while (true) {
      if (rest.empty())
        throw InputError(
            path_,
            "the header ends at byte " + std::to_string(text_.size()) + " without a DATA line",
            "copy the file again or save it again as PCD 0.7");
      if (++line_count_ > kPcdLinesMax)
        fail(line_count_, "more header lines than " + std::to_string(kPcdLinesMax), kSaveAgain);
      if (rest.substr(0, kPcdLineBytesMax + 1).find('\n') == std::string_view::npos &&
          rest.size() > kPcdLineBytesMax)
        fail(line_count_, "longer than " + std::to_string(kPcdLineBytesMax) + " bytes", kSaveAgain);
      std::string_view line = take_line(rest);
      is_simulated_ = is_simulated_ || is_simulated_line(line);
      const std::string_view keyword = take_word(line);
      if (keyword.empty() || keyword[0] == '#') continue;
      store(keyword, line);
      if (keyword == "DATA") return text_.size() - rest.size();
    }
  }

  static bool is_simulated_line(std::string_view line) {
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line == kPcdSimulatedLine;
  }

  void store(std::string_view keyword, std::string_view values) {
    for (std::size_t i = 0; i < kKeywords.size(); ++i) {
      if (kKeywords[i] != keyword) continue;
      if (entries_[i].line != 0)
        fail(line_count_, "a second " + std::string(keyword) + " line", kSaveAgain);
      entries_[i] = {values, line_count_};
      return;
    }
    fail(line_count_, "unknown word \"" + printable(keyword, 40) + "\" in the header", kSaveAgain);
  }

  [[nodiscard]] const Entry& entry(std::string_view keyword) const {
    std::size_t i = 0;
    while (kKeywords[i] != keyword) ++i;
    return entries_[i];
  }
  [[nodiscard]] const Entry& required(std::string_view keyword) const {
    const Entry& found = entry(keyword);
    if (found.line == 0)
      throw InputError(path_, "its header has no " + std::string(keyword) + " line", kSaveAgain);
    return found;
  }

  // The only word of a line.
  [[nodiscard]] std::string_view single_word(std::string_view keyword) const {
    const Entry& line = required(keyword);
    std::string_view rest = line.values;
    const std::string_view word = take_word(rest);
    if (word.empty() || !take_word(rest).empty())
      fail(line.line, std::string(keyword) + " takes one value", kSaveAgain);
    return word;
  }
  [[nodiscard]] std::uint64_t whole_number(std::string_view keyword) const {
    const std::string_view word = single_word(keyword);
    const auto value = parse_number<std::uint64_t>(word);
    if (!value)
      fail(entry(keyword).line,
           std::string(keyword) + " \"" + printable(word, 40) + "\" is not a whole number",
           kSaveAgain);
    return *value;
  }

  void check_version() const {
    const std::string_view version = single_word("VERSION");
    if (version != "0.7" && version != ".7")
      fail(entry("VERSION").line, "version \"" + printable(version, 40) + "\" is not 0.7",
           kSaveAgain);
  }

  [[nodiscard]] PcdData data_kind() const {
    const std::string_view kind = single_word("DATA");
    if (kind == "ascii") return PcdData::kAscii;
    if (kind == "binary") return PcdData::kBinary;
    if (kind == "binary_compressed") return PcdData::kBinaryCompressed;
    fail(entry("DATA").line, "DATA \"" + printable(kind, 40) + "\" is not known",
         "save it as ascii, binary or binary_compressed");
  }

  // The next value of a line that has one for every field.
  [[nodiscard]] std::string_view next_of(std::string_view keyword, std::string_view& rest) const {
    const std::string_view word = take_word(rest);
    if (word.empty())
      fail(entry(keyword).line, std::string(keyword) + " has fewer values than FIELDS", kSaveAgain);
    return word;
  }
  void check_no_more(std::string_view keyword, std::string_view rest) const {
    if (!take_word(rest).empty())
      fail(entry(keyword).line, std::string(keyword) + " has more values than FIELDS", kSaveAgain);
  }

  void read_fields(PcdHeader& header) const {
    const bool has_count = entry("COUNT").line != 0;
    std::string_view names = required("FIELDS").values;
    std::string_view sizes = required("SIZE").values;
    std::string_view types = required("TYPE").values;
    std::string_view counts = entry("COUNT").values;
    std::array<bool, 3> found{};
    std::size_t field_count = 0;
    for (std::string_view name; !(name = take_word(names)).empty();) {
      if (++field_count > kPcdFieldsMax)
        fail(entry("FIELDS").line, "more fields than " + std::to_string(kPcdFieldsMax),
             "save x, y and z only");
      const Field field{name, field_size(next_of("SIZE", sizes)), next_of("TYPE", types),
                        has_count ? field_values(next_of("COUNT", counts)) : 1};
      check_type(field);
      place_coordinate(field, header, found);
      header.point_bytes += field.size_bytes * field.values;  // at most 256 x 8 x 65536
      header.point_values += field.values;
      if (header.point_bytes > kPcdPointBytesMax)
        fail(entry("FIELDS").line,
             "a point takes more than " + std::to_string(kPcdPointBytesMax) + " bytes",
             "save x, y and z only");
    }
    check_no_more("SIZE", sizes);
    check_no_more("TYPE", types);
    check_no_more("COUNT", counts);
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (!found[axis])
        fail(entry("FIELDS").line, std::string("no field ") + "xyz"[axis],
             "save the points with fields x, y and z");
  }

  struct Field {
    std::string_view name;
    std::uint64_t size_bytes;
    std::string_view type;
    std::uint64_t values;
  };

  [[nodiscard]] std::uint64_t field_size(std::string_view word) const {
    const auto size = parse_number<std::uint64_t>(word);
    if (!size || (*size != 1 && *size != 2 && *size != 4 && *size != 8))
      fail(entry("SIZE").line, "SIZE \"" + printable(word, 40) + "\" is not 1, 2, 4 or 8",
           kSaveAgain);
    return *size;
  }
  [[nodiscard]] std::uint64_t field_values(std::string_view word) const {
    const auto count = parse_number<std::uint64_t>(word);
    if (!count || *count == 0 || *count > kPcdFieldCountMax)
      fail(entry("COUNT").line,
           "COUNT \"" + printable(word, 40) + "\" is not 1 to " + std::to_string(kPcdFieldCountMax),
           kSaveAgain);
    return *count;
  }
  void check_type(const Field& field) const {
    if (field.type != "I" && field.type != "U" && field.type != "F")
      fail(entry("TYPE").line, "TYPE \"" + printable(field.type, 40) + "\" is not I, U or F",
           kSaveAgain);
  }

  void place_coordinate(const Field& field, PcdHeader& header, std::array<bool, 3>& found) const {
    if (field.name != "x" && field.name != "y" && field.name != "z") return;
    const auto axis = static_cast<std::size_t>(field.name[0] - 'x');
    const std::string name(field.name);
    if (found[axis]) fail(entry("FIELDS").line, "a second field " + name, "rename one of them");
    if (field.type != "F" || field.size_bytes != 4 || field.values != 1)
      fail(entry("TYPE").line,
           "field " + name + " is TYPE " + std::string(field.type) + " SIZE " +
               std::to_string(field.size_bytes) + " COUNT " + std::to_string(field.values),
           "save x, y and z as float32 (TYPE F SIZE 4 COUNT 1)");
    found[axis] = true;
    header.offset_bytes[axis] = header.point_bytes;
    header.value_index[axis] = header.point_values;
  }

  void read_shape(PcdHeader& header, const ReadLimits& limits) const {
    const std::uint64_t width_px = whole_number("WIDTH");
    const std::uint64_t height_px = whole_number("HEIGHT");
    check_shape(path_, width_px, height_px, limits, "save it organized (WIDTH and HEIGHT > 1)");
    header.width_px = static_cast<int>(width_px);
    header.height_px = static_cast<int>(height_px);
    if (entry("POINTS").line != 0 && whole_number("POINTS") != header.point_count())
      fail(entry("POINTS").line,
           "POINTS " + std::to_string(whole_number("POINTS")) +
               " is not WIDTH x HEIGHT = " + std::to_string(header.point_count()),
           "correct the header or save it again");
  }

  void read_viewpoint(PcdHeader& header) const {
    const Entry& line = entry("VIEWPOINT");
    if (line.line == 0) return;  // the format's default: the sensor at 0, 0, 0
    std::array<double, 7> values{};
    std::string_view rest = line.values;
    for (double& value : values) {
      const auto number = parse_number<double>(take_word(rest));
      if (!number || !(std::fabs(*number) <= kViewpointMax_mm))
        fail(line.line, "VIEWPOINT is not seven finite numbers",
             "write the sensor's x y z in mm and 1 0 0 0");
      value = *number;
    }
    if (!take_word(rest).empty())
      fail(line.line, "VIEWPOINT has more than seven numbers",
           "write the sensor's x y z in mm and 1 0 0 0");
    header.viewpoint_mm = {values[0], values[1], values[2]};
  }

  const std::string& path_;
  std::string_view text_;
  std::array<Entry, kKeywords.size()> entries_{};
  std::size_t line_count_ = 0;
  bool is_simulated_ = false;
};

}  // namespace

PcdHeader parse_pcd_header(const std::string& path, std::span<const std::byte> bytes,
                           const ReadLimits& limits) {
  return HeaderReader(path, bytes).read(limits);
}

}  // namespace flatpose::port
