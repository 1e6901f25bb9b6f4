#include "port/linux/daemon/mailbox.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace flatpose::daemon {
namespace {

/// Torn when its parts differ.
struct Wide {
  std::array<std::uint64_t, 512> parts{};  // long to copy, so that the threads meet

  Wide() = default;
  explicit Wide(std::uint64_t value) { parts.fill(value); }
  [[nodiscard]] bool is_whole() const {
    for (const std::uint64_t part : parts)
      if (part != parts[0]) return false;
    return true;
  }
};

constexpr std::uint64_t kValues = 100'000;

TEST(Latest, GivesTheNewestOnce) {
  Latest<int> box;
  int value = -1;
  EXPECT_FALSE(box.take(value));
  box.put(1);
  box.put(2);
  EXPECT_TRUE(box.take(value));
  EXPECT_EQ(value, 2);
  EXPECT_FALSE(box.take(value));
  box.put(3);
  EXPECT_TRUE(box.take(value));
  EXPECT_EQ(value, 3);
}

TEST(Latest, BetweenThreadsIsWholeNeverOlderAndEndsWithTheLast) {
  Latest<Wide> box;
  const std::jthread writer([&] {
    for (std::uint64_t i = 1; i <= kValues; ++i) box.put(Wide(i));
  });
  Wide seen;
  std::uint64_t last = 0;
  while (last < kValues) {
    if (!box.take(seen)) continue;
    ASSERT_TRUE(seen.is_whole());
    ASSERT_GT(seen.parts[0], last);
    last = seen.parts[0];
  }
}

TEST(Queue, GivesAllInTheirOrderAndSaysWhenItIsFull) {
  Queue<int, 3> queue;
  int value = 0;
  EXPECT_FALSE(queue.take(value));
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(queue.put(i));
  EXPECT_FALSE(queue.put(3));
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(queue.take(value));
    EXPECT_EQ(value, i);
  }
  EXPECT_FALSE(queue.take(value));
}

TEST(Queue, BetweenThreadsLosesNothing) {
  Queue<Wide, 4> queue;
  const std::jthread writer([&] {
    for (std::uint64_t i = 1; i <= kValues; ++i)
      while (!queue.put(Wide(i))) std::this_thread::yield();
  });
  Wide seen;
  for (std::uint64_t i = 1; i <= kValues; ++i) {
    while (!queue.take(seen)) std::this_thread::yield();
    ASSERT_TRUE(seen.is_whole());
    ASSERT_EQ(seen.parts[0], i);
  }
}

}  // namespace
}  // namespace flatpose::daemon
