#include "flatpose/core/arena.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace flatpose {
namespace {

void lay_out(Arena& arena) {
  (void)arena.take<std::uint8_t>(3);
  {
    const ArenaScope scope(arena);
    (void)arena.take_image<float>(17, 5);
  }
  (void)arena.take<double>(10);
}

TEST(Arena, WhatWasMeasuredFitsAtAnyAddress) {
  Arena measuring = Arena::measuring();
  lay_out(measuring);
  std::vector<std::byte> memory(measuring.required_bytes() + Arena::kAlignmentBytes);
  for (std::size_t shift = 0; shift < Arena::kAlignmentBytes; ++shift) {
    Arena arena{std::span{memory}.subspan(shift, measuring.required_bytes())};
    lay_out(arena);
    EXPECT_FALSE(arena.failed()) << shift;
  }
}

TEST(Arena, FailsForGoodWhenFullAndNeverWraps) {
  std::vector<std::byte> memory(1024);
  Arena arena{std::span(memory)};
  EXPECT_TRUE(arena.take<double>(SIZE_MAX / 4).empty());
  EXPECT_TRUE(arena.failed());
  EXPECT_TRUE(arena.take<std::uint8_t>(1).empty());
}

TEST(Arena, AlignsAndDoesNotOverlap) {
  std::vector<std::byte> memory(1024);
  Arena arena{std::span(memory)};
  const auto a = arena.take<std::uint8_t>(65);
  const auto b = arena.take<double>(2);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(a.data()) % Arena::kAlignmentBytes, 0U);
  EXPECT_GE(reinterpret_cast<std::uint8_t*>(b.data()), a.data() + a.size());
}

}  // namespace
}  // namespace flatpose
