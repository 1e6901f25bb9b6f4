#pragma once
// A template with every field set to something of its own, and its bytes.

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <vector>

#include "flatpose/core/fnv.hpp"
#include "flatpose/core/maths.hpp"
#include "flatpose/model/template_file.hpp"

namespace flatpose::model {

inline constexpr std::size_t kHeaderBytes = 20;

/// Only arithmetic that rounds alike everywhere, so that its bytes can be pinned.
inline std::unique_ptr<Template> made_template(int contour_count = 5, int surface_count = 4,
                                               int anchor_count = 2) {
  auto part = std::make_unique<Template>();
  std::memcpy(part->name.data(), "pad \xC3\xA4", 7);
  part->symmetry = {4, 1.25, -2.5};
  part->cell_mm = 0.75;
  part->pitch_mm = 0.625;
  part->noise_mm = 0.125;
  part->step_mm = 4.5;
  part->area_mm2 = 1234.5;
  part->radius_mm = 33.0;
  part->score_threshold = 0.8125;
  part->self_score = 0.9375;
  part->rival_score = 0.375;
  part->scan_T_object = {Rotation{{0.6, -0.8, 0, 0.8, 0.6, 0, 0, 0, 1}}, {10.5, -20.25, 300.125}};
  part->up = -1;
  part->frame = Frame::kWork;
  part->weakness = kWeakSymmetryLikely | kWeakSmall;
  part->symmetry_likely = 3;
  part->contour_count = contour_count;
  part->surface_count = surface_count;
  part->anchor_count = anchor_count;
  const std::array<std::array<float, 2>, 4> directions{
      {{1.0F, 0.0F}, {0.0F, 1.0F}, {-0.6F, 0.8F}, {0.8F, -0.6F}}};
  for (int i = 0; i < contour_count; ++i) {
    const auto& d = directions[static_cast<std::size_t>(i % 4)];
    const auto k = static_cast<float>(i);
    part->contour[i] = {1.5F + k, -2.25F * k, 0.125F * k,          d[0],
                        d[1],     4.0F + k,   0.0625F * (k - 1.0F)};
  }
  for (int i = 0; i < surface_count; ++i) {
    const auto k = static_cast<float>(i);
    part->surface[i] = {k - 3.0F,   0.5F * k,     -0.25F * k,
                        0.001F * k, -0.0005F * k, 0.75F + 0.25F * k};
  }
  for (int i = 0; i < anchor_count; ++i) {
    const auto k = static_cast<float>(i);
    part->anchors[i] = {k + 0.5F, -k, 7.5F - k};
  }
  return part;
}

inline std::vector<std::byte> bytes_of(const Template& part) {
  std::vector<std::byte> bytes(kTemplateFileBytesMax);
  const Result<std::size_t> size_bytes = write_template(part, bytes);
  EXPECT_TRUE(size_bytes) << to_string(size_bytes.status());
  bytes.resize(size_bytes ? *size_bytes : 0);
  return bytes;
}

/// Puts the right checksum over whatever the payload has become.
inline void seal(std::vector<std::byte>& bytes) {
  Fnv1a64 checksum;
  checksum.add(std::span<const std::byte>(bytes).subspan(kHeaderBytes));
  for (std::size_t i = 0; i < 8; ++i) {
    bytes[12 + i] = static_cast<std::byte>((checksum.value() >> (8 * i)) & 0xFFU);
  }
}

template <class T>
void put_little_endian(std::vector<std::byte>& bytes, std::size_t at, T value) {
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    bytes.at(at + i) = static_cast<std::byte>((value >> (8 * i)) & 0xFFU);
  }
}

inline Status read(const std::vector<std::byte>& bytes) {
  const auto part = std::make_unique<Template>();
  return read_template(bytes, *part);
}

}  // namespace flatpose::model
