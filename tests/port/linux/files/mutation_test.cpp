// Thousands of damaged files with a fixed seed: each gives a scan or an InputError of one line, and
// nothing for the sanitizers to report.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <functional>

#include "port/linux/files/depth_png.hpp"
#include "port/linux/files/mask_png.hpp"
#include "port/linux/files/pcd.hpp"
#include "port/linux/files/sick_json.hpp"
#include "port/linux/files/work_file.hpp"
#include "tests/port/linux/files/made_files.hpp"
#include "tests/port/linux/files/temporary_folder.hpp"

namespace flatpose::port {
namespace {

constexpr int kMutations = 4000;
constexpr int kFileMutations = 2000;  // where every one goes through the disk

class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::size_t below(std::size_t bound) {
    state_ += 0x9E3779B97F4A7C15u;  // splitmix64
    std::uint64_t z = state_;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
    z = (z ^ z >> 27) * 0x94D049BB133111EBu;
    return static_cast<std::size_t>((z ^ z >> 31) % bound);
  }

 private:
  std::uint64_t state_;
};

// Flips bits, puts digits and signs where numbers stand, cuts out, doubles and cuts off.
std::string mutated(std::string bytes, Random& random) {
  static constexpr std::string_view kPuts = "0123456789-+.eE naNinf\n\0\xff\x7f{}[],:\"=A/";
  for (std::size_t count = 1 + random.below(4); count > 0 && !bytes.empty(); --count) {
    const std::size_t at = random.below(bytes.size());
    const std::size_t length = std::min(bytes.size() - at, 1 + random.below(16));
    switch (random.below(6)) {
      case 0: bytes[at] = static_cast<char>(bytes[at] ^ (1 << random.below(8))); break;
      case 1:
      case 2: bytes[at] = kPuts[random.below(kPuts.size())]; break;
      case 3: bytes.erase(at, length); break;
      case 4: bytes.insert(at, bytes.substr(at, length)); break;
      default:
        if (random.below(4) == 0) bytes.resize(at);
        bytes.insert(std::min(at, bytes.size()), 1, kPuts[random.below(kPuts.size())]);
    }
  }
  return bytes;
}

void expect_scan_or_line(const std::function<void()>& read, int& good, int& bad) {
  try {
    read();
    ++good;
  } catch (const InputError& error) {
    expect_one_line(error.line());
    ++bad;
  }
}

void check_scan(const Scan& scan) {
  ASSERT_GT(scan.width_px, 1);
  ASSERT_GT(scan.height_px, 1);
  ASSERT_EQ(scan.xyz_mm.size(), 3 * scan.view().size());
  for (const float value : scan.xyz_mm) ASSERT_FALSE(std::abs(value) > 1e6f);
}

void mutate_in_memory(const std::string& good_file, std::uint64_t seed,
                      Scan (*read)(const std::string&, std::span<const std::byte>,
                                   const ReadLimits&)) {
  Random random(seed);
  int good = 0, bad = 0;
  for (int i = 0; i < kMutations; ++i) {
    const std::string bytes = mutated(good_file, random);
    expect_scan_or_line([&] { check_scan(read("t", as_bytes(bytes), {100'000})); }, good, bad);
  }
  // Both must occur, or the mutations are too weak or too strong to mean anything.
  EXPECT_GT(good, 10);
  EXPECT_GT(bad, kMutations / 10);
}

std::string pcd(PcdLines lines, const std::string& data, const std::string& body) {
  lines.data = data;
  return lines.text() + body;
}

TEST(Mutated, AsciiPcd) { mutate_in_memory(pcd({}, "ascii", small_ascii()), 1, read_pcd); }
TEST(Mutated, BinaryPcd) {
  mutate_in_memory(pcd(mixed_lines(), "binary", mixed_points(small_xyz())), 2, read_pcd);
}
TEST(Mutated, CompressedPcd) {
  mutate_in_memory(pcd({}, "binary_compressed", packed_points(small_xyz())), 3, read_pcd);
}
TEST(Mutated, CompressedBodyOnly) {
  const std::string head = pcd({}, "binary_compressed", "");
  std::vector<float> xyz = small_xyz();
  std::fill(xyz.begin(), xyz.end(), 1.0f);  // long copies inside
  const std::string body = packed_points(xyz);
  Random random(4);
  int good = 0, bad = 0;
  for (int i = 0; i < kMutations; ++i) {
    const std::string bytes = head + body.substr(0, 8) + mutated(body.substr(8), random);
    expect_scan_or_line([&] { check_scan(read_pcd("t", as_bytes(bytes))); }, good, bad);
  }
  EXPECT_GT(good, 10);
  EXPECT_GT(bad, 10);
}
TEST(Mutated, SickJson) { mutate_in_memory(std::string(kSickJson), 5, read_sick_json); }

// Without its checksums every damage to a PNG would be seen at once; this puts them right again.
std::string with_right_checksums(std::string png) {
  std::size_t at = 8;
  while (at + 12 <= png.size()) {
    std::size_t length = 0;
    for (std::size_t i = 0; i < 4; ++i)
      length = length << 8 | static_cast<unsigned char>(png[at + i]);
    if (length > png.size() - at - 12) break;
    std::uint32_t crc = 0xFFFFFFFF;
    for (std::size_t i = at + 4; i < at + 8 + length; ++i) {
      crc ^= static_cast<unsigned char>(png[i]);
      for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xEDB88320u : 0);
    }
    for (std::size_t i = 0; i < 4; ++i)
      png[at + 8 + length + i] = static_cast<char>(~crc >> (24 - 8 * i));
    at += 12 + length;
  }
  return png;
}

TEST(Mutated, DepthPngAndItsCamera) {
  const TemporaryFolder folder;
  const std::string png = depth_png_of(3, 2, {1000, 0, 65535, 1, 2000, 3000});
  const std::string path = folder.path("d.png");
  Random random(6);
  int good = 0, bad = 0;
  for (int i = 0; i < kFileMutations; ++i) {
    std::string bytes = png;
    if (i % 2 == 0) bytes = with_right_checksums(mutated(png, random));
    folder.write("d.json", i % 2 == 0 ? kCameraJson : mutated(std::string(kCameraJson), random));
    const auto read = [&] { check_scan(read_depth_png(path, as_bytes(bytes), {100'000})); };
    expect_scan_or_line(read, good, bad);
  }
  EXPECT_GT(good, 10);
  EXPECT_GT(bad, 10);
}

TEST(Mutated, MaskPng) {
  const TemporaryFolder folder;
  const std::string pixels("\xff\0\0\0\0\xff\0\xff\0\xff\0\0\0\0\xff\0\xff\0", 18);
  const std::string files[] = {
      png_of(3, 2, SPNG_COLOR_TYPE_TRUECOLOR, 8, pixels),
      png_of(3, 2, SPNG_COLOR_TYPE_INDEXED, 8, std::string("\1\2\3\0\1\2", 6), true)};
  Random random(7);
  int good = 0, bad = 0;
  for (int i = 0; i < kFileMutations; ++i) {
    const std::string path =
        folder.write("m.png", with_right_checksums(mutated(files[i % 2], random)));
    const auto read = [&] { ASSERT_EQ(read_mask_png(path, 3, 2).label.size(), 6u); };
    expect_scan_or_line(read, good, bad);
  }
  EXPECT_GT(good, 10);
  EXPECT_GT(bad, 10);
}

TEST(Mutated, WorkFile) {
  const TemporaryFolder folder;
  write_work_file(folder.path("good"), {{}, Up::kPlusZ, WorkQuality{0.1, 0.5, 9}});
  std::ifstream stream(folder.path("good"));
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  Random random(8);
  int good = 0, bad = 0;
  for (int i = 0; i < kFileMutations; ++i) {
    const std::string path = folder.write("w", mutated(text, random));
    expect_scan_or_line([&] { (void)read_work_file(path); }, good, bad);
  }
  EXPECT_GT(good, 10);
  EXPECT_GT(bad, 10);
}

}  // namespace
}  // namespace flatpose::port
