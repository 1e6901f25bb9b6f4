// Templates come from disks and networks: whatever the bytes, reading them ends in a Status, leaves
// the caller's template alone unless it is kOk, and what is kOk is fit for use.

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <limits>
#include <random>

#include "tests/lib/model/made_template.hpp"

namespace flatpose::model {
namespace {

// Where fields lie in the file, by the header's words.
constexpr std::size_t kNameAt = kHeaderBytes;
constexpr std::size_t kOrderAt = kNameAt + 64;
constexpr std::size_t kDoublesAt = kOrderAt + 4;  // centre, nine numbers, pose: 23 of them
constexpr std::size_t kDoubleCount = 2 + 9 + 12;
constexpr std::size_t kUpAt = kDoublesAt + 8 * kDoubleCount;
constexpr std::size_t kFrameAt = kUpAt + 1;
constexpr std::size_t kLikelyAt = kFrameAt + 1 + 4;
constexpr std::size_t kCountsAt = kLikelyAt + 4;
constexpr std::size_t kCloudsAt = kCountsAt + 12;

TEST(BadTemplateFile, AnyByteFlippedIsNoticed) {
  const std::vector<std::byte> good = bytes_of(*made_template());
  for (std::size_t i = 0; i < good.size(); ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      std::vector<std::byte> bytes = good;
      bytes[i] ^= static_cast<std::byte>(1U << static_cast<unsigned>(bit));
      const Status status = read(bytes);
      ASSERT_NE(status, Status::kOk) << "byte " << i << " bit " << bit;
      if (i < 4) {
        EXPECT_EQ(status, Status::kBadMagic);
      } else if (i < 8) {
        EXPECT_EQ(status, Status::kBadVersion);
      } else if (i >= 12) {
        EXPECT_EQ(status, Status::kBadChecksum) << i;
      }
    }
  }
}

TEST(BadTemplateFile, AnyByteReplacedByAnyOtherIsNoticed) {
  const std::vector<std::byte> good = bytes_of(*made_template(1, 3, 1));
  std::vector<std::byte> bytes = good;
  const auto part = std::make_unique<Template>();
  for (std::size_t i = 0; i < good.size(); ++i) {
    for (unsigned value = 0; value < 256; ++value) {
      bytes[i] = static_cast<std::byte>(value);
      if (bytes[i] == good[i]) continue;
      ASSERT_NE(read_template(bytes, *part), Status::kOk) << "byte " << i << " is " << value;
    }
    bytes[i] = good[i];
  }
}

TEST(BadTemplateFile, TruncatedAtAnyLengthIsNoticed) {
  const std::vector<std::byte> good = bytes_of(*made_template());
  for (std::size_t length = 0; length < good.size(); ++length) {
    const std::vector<std::byte> bytes(good.begin(),
                                       good.begin() + static_cast<std::ptrdiff_t>(length));
    const Status status = read(bytes);
    // Without the whole magic nothing says that it ever was a template.
    if (length < 4) {
      EXPECT_TRUE(status == Status::kBadMagic || status == Status::kTruncated) << length;
    } else {
      EXPECT_EQ(status, Status::kTruncated) << length;
    }
  }
}

TEST(BadTemplateFile, AFailedReadLeavesTheTemplateAsItWas) {
  const auto kept = made_template(7, 6, 3);
  const std::vector<std::byte> before = bytes_of(*kept);
  std::vector<std::byte> bytes = bytes_of(*made_template());
  bytes.pop_back();
  ASSERT_NE(read_template(bytes, *kept), Status::kOk);
  bytes.push_back(std::byte{0x77});
  ASSERT_NE(read_template(bytes, *kept), Status::kOk);
  put_little_endian<std::uint32_t>(bytes, kCountsAt, 513);
  seal(bytes);
  ASSERT_NE(read_template(bytes, *kept), Status::kOk);
  EXPECT_EQ(bytes_of(*kept), before);
}

TEST(BadTemplateFile, AnotherKindOfFileIsNotATemplate) {
  for (const char* text : {"# .PCD v0.7 - Point Cloud Data file format", "\x89PNG\r\n\x1a\n",
                           "FPT\r\n and then text that is long enough for a header", "", "F"}) {
    std::vector<std::byte> bytes;
    for (const char* c = text; *c != '\0'; ++c) bytes.push_back(static_cast<std::byte>(*c));
    EXPECT_EQ(read(bytes), Status::kBadMagic) << text;
  }
}

TEST(BadTemplateFile, ANewerVersionSaysSoWhateverFollows) {
  std::vector<std::byte> bytes = bytes_of(*made_template());
  for (const std::uint32_t version : {kTemplateFileVersion + 1, 77U, 0xFFFFFFFFU}) {
    put_little_endian(bytes, 4, version);
    EXPECT_EQ(read(bytes), Status::kBadVersion);
  }
  bytes.resize(kHeaderBytes + 3);  // a newer version may be laid out as it likes
  EXPECT_EQ(read(bytes), Status::kBadVersion);
}

TEST(BadTemplateFile, CountsOutOfRangeAreRefusedThoughTheChecksumIsRight) {
  const std::vector<std::byte> good = bytes_of(*made_template());
  const std::array<int, 3> largest{kContourPointCountMax, kSurfacePointCountMax, kAnchorCountMax};
  const std::array<int, 3> present{5, 4, 2};
  for (std::size_t k = 0; k < 3; ++k) {
    for (const std::int64_t count :
         {std::int64_t{-1}, std::int64_t{0}, present[k] - std::int64_t{1},
          present[k] + std::int64_t{1}, std::int64_t{largest[k]}, largest[k] + std::int64_t{1},
          std::int64_t{0x7FFFFFFF}, std::int64_t{-0x7FFFFFFF} - 1}) {
      std::vector<std::byte> bytes = good;
      put_little_endian(bytes, kCountsAt + 4 * k, static_cast<std::uint32_t>(count));
      seal(bytes);
      EXPECT_NE(read(bytes), Status::kOk) << "count " << k << " is " << count;
    }
  }
}

TEST(BadTemplateFile, APayloadLongerThanItsFieldsIsRefused) {
  std::vector<std::byte> bytes = bytes_of(*made_template());
  bytes.push_back(std::byte{0});
  put_little_endian(bytes, 8, static_cast<std::uint32_t>(bytes.size() - kHeaderBytes));
  seal(bytes);
  EXPECT_EQ(read(bytes), Status::kInvalidArgument);
}

TEST(BadTemplateFile, NumbersThatAreNotFiniteAreRefusedWhereverTheyStand) {
  const auto part = made_template();
  const std::vector<std::byte> good = bytes_of(*part);
  ASSERT_EQ(kCloudsAt + 4U * (7U * 5U + 6U * 4U + 3U * 2U), good.size());
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
        -std::numeric_limits<double>::infinity()}) {
    for (std::size_t i = 0; i < kDoubleCount; ++i) {
      std::vector<std::byte> bytes = good;
      put_little_endian(bytes, kDoublesAt + 8 * i, std::bit_cast<std::uint64_t>(bad));
      seal(bytes);
      EXPECT_EQ(read(bytes), Status::kInvalidArgument) << "double " << i << " is " << bad;
    }
    for (std::size_t at = kCloudsAt; at < good.size(); at += 4) {
      std::vector<std::byte> bytes = good;
      put_little_endian(bytes, at, std::bit_cast<std::uint32_t>(static_cast<float>(bad)));
      seal(bytes);
      EXPECT_EQ(read(bytes), Status::kInvalidArgument) << "float at " << at << " is " << bad;
    }
  }
}

TEST(BadTemplateFile, ValuesOutsideTheirRangeAreRefusedOnBothWays) {
  const std::vector<std::pair<const char*, std::function<void(Template&)>>> harms{
      {"name without end", [](Template& p) { p.name.fill('x'); }},
      {"negative order", [](Template& p) { p.symmetry.order = -1; }},
      {"huge order", [](Template& p) { p.symmetry.order = 1 << 20; }},
      {"negative likely order", [](Template& p) { p.symmetry_likely = -3; }},
      {"huge likely order", [](Template& p) { p.symmetry_likely = 1 << 20; }},
      {"no cell", [](Template& p) { p.cell_mm = 0.0; }},
      {"negative cell", [](Template& p) { p.cell_mm = -1.0; }},
      {"giant cell", [](Template& p) { p.cell_mm = 1e9; }},
      {"no pitch", [](Template& p) { p.pitch_mm = 0.0; }},
      {"no radius", [](Template& p) { p.radius_mm = 0.0; }},
      {"negative noise", [](Template& p) { p.noise_mm = -0.1; }},
      {"negative step", [](Template& p) { p.step_mm = -0.1; }},
      {"negative area", [](Template& p) { p.area_mm2 = -1.0; }},
      {"threshold over one", [](Template& p) { p.score_threshold = 1.01; }},
      {"negative score", [](Template& p) { p.self_score = -0.01; }},
      {"rival over one", [](Template& p) { p.rival_score = 2.0; }},
      {"no up", [](Template& p) { p.up = 0; }},
      {"another frame", [](Template& p) { p.frame = static_cast<Frame>(2); }},
      {"scaled rotation", [](Template& p) { p.scan_T_object.rotation.m[8] = 1.1; }},
      {"mirrored rotation", [](Template& p) { p.scan_T_object.rotation.m[8] = -1.0; }},
      {"giant position", [](Template& p) { p.scan_T_object.position_mm.z = 1e9; }},
      {"giant centre", [](Template& p) { p.symmetry.center_x_mm = 1e9; }},
      {"no contour", [](Template& p) { p.contour_count = 0; }},
      {"two surface points", [](Template& p) { p.surface_count = 2; }},
      {"no anchor", [](Template& p) { p.anchor_count = 0; }},
      {"long direction", [](Template& p) { p.contour[1].nx = 2.0F; }},
      {"no direction", [](Template& p) { p.contour[0].nx = p.contour[0].ny = 0.0F; }},
      {"giant contour", [](Template& p) { p.contour[2].z_mm = 1e9F; }},
      {"long normal", [](Template& p) { p.surface[3].ny = 1.5F; }},
      {"giant surface", [](Template& p) { p.surface[0].x_mm = -1e9F; }},
      {"negative weight", [](Template& p) { p.surface[1].weight = -0.5F; }},
      {"giant weight", [](Template& p) { p.surface[2].weight = 1e6F; }},
      {"negative clearance", [](Template& p) { p.anchors[1].clearance_mm = -1.0F; }},
  };
  std::vector<std::byte> buffer(kTemplateFileBytesMax);
  for (const auto& [what, harm] : harms) {
    auto part = made_template();
    ASSERT_TRUE(is_valid(*part));
    harm(*part);
    EXPECT_FALSE(is_valid(*part)) << what;
    EXPECT_EQ(write_template(*part, buffer).status(), Status::kInvalidArgument) << what;
  }
}

TEST(BadTemplateFile, AnUpAFrameAndAnOrderOutOfRangeAreRefusedThoughTheChecksumIsRight) {
  const std::vector<std::byte> good = bytes_of(*made_template());
  const auto with = [&](std::size_t at, unsigned value) {
    std::vector<std::byte> bytes = good;
    bytes[at] = static_cast<std::byte>(value);
    seal(bytes);
    return read(bytes);
  };
  for (unsigned value = 0; value < 256; ++value) {
    const bool up = value == 1 || value == 255;
    EXPECT_EQ(with(kUpAt, value), up ? Status::kOk : Status::kInvalidArgument) << value;
    EXPECT_EQ(with(kFrameAt, value), value < 2 ? Status::kOk : Status::kInvalidArgument) << value;
  }
  EXPECT_EQ(with(kOrderAt + 3, 0x80), Status::kInvalidArgument) << "a negative order";
  EXPECT_EQ(with(kLikelyAt + 3, 0x80), Status::kInvalidArgument);
  EXPECT_EQ(with(kNameAt + 63, 'x'), Status::kInvalidArgument) << "a name without its end";
}

// Whatever a right checksum covers: no read or write out of bounds (the sanitizers watch), and what
// is accepted is valid and survives the way back.
TEST(BadTemplateFile, RandomBytesUnderARightChecksumAreRefusedOrFitForUse) {
  std::mt19937 random(20150);
  const std::vector<std::byte> good = bytes_of(*made_template());
  const auto part = std::make_unique<Template>();
  int accepted = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    std::vector<std::byte> bytes = good;
    const int changes = 1 + static_cast<int>(random() % 4);
    for (int i = 0; i < changes; ++i) {
      const std::size_t at = kHeaderBytes + random() % (bytes.size() - kHeaderBytes);
      bytes[at] = static_cast<std::byte>(random());
    }
    if (random() % 4 == 0) {
      bytes.resize(kHeaderBytes + random() % (2 * good.size()));
      put_little_endian(bytes, 8, static_cast<std::uint32_t>(bytes.size() - kHeaderBytes));
    }
    seal(bytes);
    if (read_template(bytes, *part) != Status::kOk) continue;
    ++accepted;
    ASSERT_TRUE(is_valid(*part));
    ASSERT_EQ(bytes_of(*part), bytes);
  }
  EXPECT_GT(accepted, 1000) << "the trials reach the values behind the checksum";
  EXPECT_LT(accepted, 19000);
}

TEST(BadTemplateFile, RandomBytesAreNoTemplate) {
  std::mt19937 random(2015);
  for (int trial = 0; trial < 20000; ++trial) {
    std::vector<std::byte> bytes(random() % 700);
    for (std::byte& b : bytes) b = static_cast<std::byte>(random());
    const std::vector<std::byte> head = bytes_of(*made_template());
    const std::size_t kept = std::min<std::size_t>(bytes.size(), random() % 24);
    std::copy_n(head.begin(), kept, bytes.begin());
    ASSERT_NE(read(bytes), Status::kOk);
  }
}

}  // namespace
}  // namespace flatpose::model
