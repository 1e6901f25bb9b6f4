#include "port/linux/files/pcd_body.hpp"

#include <lzf.h>

#include <bit>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>

#include "port/linux/files/atomic_file.hpp"
#include "port/linux/files/input_error.hpp"
#include "port/linux/files/words.hpp"

namespace flatpose::port {
namespace {

static_assert(std::endian::native == std::endian::little, "PCD stores little-endian numbers");

constexpr std::uint64_t kCompressedHeaderBytes = 8;
// LZF's longest copy: three bytes that stand for 264.
constexpr std::uint64_t kLzfGrowthMax = 88;
// A number of an ascii point takes a digit and what parts it from the next.
constexpr std::uint64_t kAsciiValueBytesMin = 2;

[[noreturn]] void fail_short(const std::string& path, std::uint64_t missing_bytes) {
  throw InputError(path, "the data is cut off",
                   "copy the file again: it is " + std::to_string(missing_bytes) + " bytes short");
}

// Some writers pad; anything else below the points means that the header is wrong.
void check_rest(const std::string& path, std::span<const std::byte> rest) {
  for (const std::byte byte : rest) {
    if (byte == std::byte{0} || byte == std::byte{'\n'} || byte == std::byte{'\r'}) continue;
    throw InputError(
        path, std::to_string(rest.size()) + " bytes stand below the last point of the header",
        "correct WIDTH, HEIGHT, SIZE and COUNT or save it again");
  }
}

std::vector<float> read_binary(const std::string& path, const PcdHeader& header,
                               std::span<const std::byte> body) {
  const std::uint64_t count = header.point_count();
  const std::uint64_t size_bytes = count * header.point_bytes;  // below 2^40 x 2^20
  if (body.size() < size_bytes) fail_short(path, size_bytes - body.size());
  check_rest(path, body.subspan(size_bytes));
  std::vector<float> xyz_mm(3 * count);
  const std::byte* point = body.data();
  for (std::uint64_t i = 0; i < count; ++i, point += header.point_bytes)
    for (std::size_t axis = 0; axis < 3; ++axis)
      std::memcpy(&xyz_mm[3 * i + axis], point + header.offset_bytes[axis], sizeof(float));
  return xyz_mm;
}

std::uint32_t read_u32(std::span<const std::byte> bytes) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data(), sizeof(value));
  return value;
}

std::vector<std::byte> unpack(const std::string& path, std::span<const std::byte> packed,
                              std::uint32_t size_bytes) {
  std::vector<std::byte> plain(size_bytes);
  const unsigned written =
      lzf_decompress(packed.data(), static_cast<unsigned>(packed.size()), plain.data(), size_bytes);
  if (written != size_bytes)
    throw InputError(
        path, "the compressed data does not unpack to " + std::to_string(size_bytes) + " bytes",
        "copy the file again: it is damaged");
  return plain;
}

// After u32 sizes packed and unpacked, all values of the first field, then of the second, ...
std::vector<float> read_compressed(const std::string& path, const PcdHeader& header,
                                   std::span<const std::byte> body, const ReadLimits& limits) {
  if (body.size() < kCompressedHeaderBytes) fail_short(path, kCompressedHeaderBytes - body.size());
  const std::uint32_t packed_bytes = read_u32(body);
  const std::uint32_t plain_bytes = read_u32(body.subspan(4));
  const std::uint64_t count = header.point_count();
  const std::uint64_t promised_bytes = count * header.point_bytes;
  if (plain_bytes != promised_bytes)
    throw InputError(path,
                     "it unpacks to " + std::to_string(plain_bytes) +
                         " bytes and the header says " + std::to_string(promised_bytes),
                     "correct the header or save it again");
  body = body.subspan(kCompressedHeaderBytes);
  if (body.size() < packed_bytes) fail_short(path, packed_bytes - body.size());
  if (plain_bytes > kLzfGrowthMax * packed_bytes)
    throw InputError(
        path,
        std::to_string(packed_bytes) + " bytes cannot unpack to " + std::to_string(plain_bytes),
        "copy the file again: it is damaged");
  if (std::cmp_greater(plain_bytes, limits.max_file_bytes))
    throw InputError(path,
                     "it unpacks to " + std::to_string(plain_bytes) + " bytes, over the limit of " +
                         std::to_string(limits.max_file_bytes),
                     "save x, y and z only");
  check_rest(path, body.subspan(packed_bytes));
  const std::vector<std::byte> plain = unpack(path, body.first(packed_bytes), plain_bytes);
  std::vector<float> xyz_mm(3 * count);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::byte* value = plain.data() + count * header.offset_bytes[axis];
    for (std::uint64_t i = 0; i < count; ++i, value += sizeof(float))
      std::memcpy(&xyz_mm[3 * i + axis], value, sizeof(float));
  }
  return xyz_mm;
}

std::optional<float> parse_coordinate(std::string_view word) {
  if (!word.empty() && word[0] == '+') word.remove_prefix(1);
  const auto value = parse_number<double>(word);
  if (!value) return {};
  return to_coordinate(*value);
}

class AsciiReader {
 public:
  AsciiReader(const std::string& path, const PcdHeader& header, std::span<const std::byte> body)
      : path_(path), header_(header), rest_(as_text(body)), line_(header.line_count) {}

  std::vector<float> read() {
    const std::uint64_t count = header_.point_count();
    // The last number needs nothing behind it.
    const std::uint64_t needed_bytes = count * header_.point_values * kAsciiValueBytesMin - 1;
    if (rest_.size() < needed_bytes) fail_missing(0);
    std::vector<float> xyz_mm(3 * count);
    for (std::uint64_t i = 0; i < count; ++i) {
      const std::string_view line = next_line();
      if (line.empty()) fail_missing(i);
      read_point(line, &xyz_mm[3 * i]);
    }
    if (!next_line().empty())
      fail("more points than WIDTH x HEIGHT = " + std::to_string(count),
           "correct WIDTH and HEIGHT or save it again");
    return xyz_mm;
  }

 private:
  [[noreturn]] void fail(const std::string& why, std::string_view remedy) const {
    throw InputError(path_, "line " + std::to_string(line_) + ": " + why, remedy);
  }
  [[noreturn]] void fail_missing(std::uint64_t found) const {
    throw InputError(path_,
                     "the data ends before point " + std::to_string(header_.point_count()) +
                         (found == 0 ? std::string() : ", after point " + std::to_string(found)),
                     "copy the file again: it is cut off");
  }

  // The next line with a word in it; empty at the end.
  std::string_view next_line() {
    while (!rest_.empty()) {
      ++line_;
      const std::string_view line = take_line(rest_);
      std::string_view words = line;
      if (!take_word(words).empty()) return line;
    }
    return {};
  }

  void read_point(std::string_view line, float* xyz_mm) const {
    for (std::uint64_t i = 0; i < header_.point_values; ++i) {
      const std::string_view word = take_word(line);
      if (word.empty())
        fail(std::to_string(i) + " numbers instead of " + std::to_string(header_.point_values),
             "copy the file again or correct FIELDS and COUNT");
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (i != header_.value_index[axis]) continue;
        const auto value = parse_coordinate(word);
        if (!value)
          fail(std::string("\"").append(printable(word, 40)) + "\" is not a number",
               "copy the file again");
        xyz_mm[axis] = *value;
      }
    }
    if (!take_word(line).empty())
      fail("more than " + std::to_string(header_.point_values) + " numbers",
           "write one point a line or correct FIELDS and COUNT");
  }

  const std::string& path_;
  const PcdHeader& header_;
  std::string_view rest_;
  std::size_t line_;
};

}  // namespace

std::vector<float> read_pcd_body(const std::string& path, const PcdHeader& header,
                                 std::span<const std::byte> body, const ReadLimits& limits) {
  switch (header.data) {
    case PcdData::kAscii: return AsciiReader(path, header, body).read();
    case PcdData::kBinary: return read_binary(path, header, body);
    case PcdData::kBinaryCompressed: break;
  }
  return read_compressed(path, header, body, limits);
}

}  // namespace flatpose::port
