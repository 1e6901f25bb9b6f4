#include "flatpose/search/lattice.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "tests/lib/image/image.hpp"
#include "tests/lib/search/memory.hpp"

namespace flatpose::search {
namespace {

struct Size {
  int width_px, height_px;
};
constexpr std::array kSizes{Size{1, 1},  Size{1, 9},   Size{9, 1},    Size{7, 5},
                            Size{64, 3}, Size{65, 17}, Size{129, 10}, Size{131, 14}};

/// Any lattice: all strides, sizes about a block's and the stride's multiples, some reaches.
template <class Check>
void over_lattices(const Check& check) {
  for (int stride_px = 1; stride_px <= kStrideMax_px; ++stride_px) {
    for (const Size& size : kSizes) {
      for (const int reach_px : {1, 2, 3, 7, 12}) {
        SCOPED_TRACE(testing::Message() << size.width_px << 'x' << size.height_px << " stride "
                                        << stride_px << " reach " << reach_px);
        check(make_lattice(size.width_px, size.height_px, stride_px, reach_px), size, reach_px);
        if (testing::Test::HasFatalFailure()) return;
      }
    }
  }
}

/// The cell's byte as the search finds it: from the place at or before it.
std::ptrdiff_t byte_of_cell(const Lattice& lattice, int x, int y) {
  return static_cast<std::ptrdiff_t>(lattice.byte_of(0, 0)) + lattice.offset_bytes(x, y);
}

TEST(Lattice, HasAPlaceAtEveryStridethCell) {
  over_lattices([](const Lattice& lattice, const Size& size, int) {
    EXPECT_LE((lattice.width - 1) * lattice.stride_px, size.width_px - 1);
    EXPECT_GT(lattice.width * lattice.stride_px, size.width_px - 1);
    EXPECT_LE((lattice.height - 1) * lattice.stride_px, size.height_px - 1);
    EXPECT_GT(lattice.height * lattice.stride_px, size.height_px - 1);
    EXPECT_EQ(lattice.padded_width() % kBlockSize, 0);
    EXPECT_GE(lattice.padded_width(), lattice.width);
    EXPECT_LT(lattice.padded_width(), lattice.width + kBlockSize);
  });
}

TEST(Lattice, GivesEveryCellWithinReachAByteOfItsOwn) {
  over_lattices([](const Lattice& lattice, const Size& size, int reach_px) {
    std::vector<int> taken(lattice.image_bytes());
    for (int y = -reach_px; y < size.height_px + reach_px; ++y) {
      for (int x = -reach_px; x < size.width_px + reach_px; ++x) {
        const std::ptrdiff_t byte = byte_of_cell(lattice, x, y);
        ASSERT_GE(byte, 0);
        ASSERT_LT(byte, static_cast<std::ptrdiff_t>(taken.size()));
        ASSERT_EQ(taken[static_cast<std::size_t>(byte)]++, 0) << x << ' ' << y;
      }
    }
  });
}

TEST(Lattice, LaysCellsOfNeighbouringPlacesSideBySide) {
  over_lattices([](const Lattice& lattice, const Size& size, int reach_px) {
    for (int y = -reach_px; y < size.height_px + reach_px; ++y) {
      for (int x = -reach_px; x + lattice.stride_px < size.width_px + reach_px; ++x) {
        ASSERT_EQ(byte_of_cell(lattice, x + lattice.stride_px, y), byte_of_cell(lattice, x, y) + 1);
      }
    }
  });
}

TEST(Lattice, ShiftsByTheSameBytesFromEveryPlace) {
  over_lattices([](const Lattice& lattice, const Size&, int reach_px) {
    for (int dy = -reach_px; dy <= reach_px; ++dy) {
      for (int dx = -reach_px; dx <= reach_px; ++dx) {
        for (const int row : {0, lattice.height / 2, lattice.height - 1}) {
          for (const int column : {0, lattice.width / 2, lattice.width - 1}) {
            ASSERT_EQ(static_cast<std::ptrdiff_t>(lattice.byte_of(column, row)) +
                          lattice.offset_bytes(dx, dy),
                      byte_of_cell(lattice, column * lattice.stride_px + dx,
                                   row * lattice.stride_px + dy));
          }
        }
      }
    }
  });
}

TEST(Lattice, ReachesAtLeastAsFarAsAskedUpToItsLimit) {
  for (int stride_px = 1; stride_px <= kStrideMax_px; ++stride_px) {
    for (const int asked_px : {1, 2, 5, 100, kReachMax_px - 1, kReachMax_px}) {
      const int reach_px = make_lattice(50, 40, stride_px, asked_px).reach_px();
      EXPECT_GE(reach_px, asked_px);
      EXPECT_LT(reach_px, asked_px + stride_px);
    }
    for (const int asked_px : {kReachMax_px + 1, 100'000, std::numeric_limits<int>::max()})
      EXPECT_EQ(make_lattice(50, 40, stride_px, asked_px).reach_px(), kReachMax_px);
    for (const int asked_px : {0, -1, std::numeric_limits<int>::min()})
      EXPECT_EQ(make_lattice(50, 40, stride_px, asked_px).reach_px(), stride_px);
  }
}

TEST(Lattice, BlocksStayInsideTheMemoryWithAnyShiftWithinReach) {
  over_lattices([](const Lattice& lattice, const Size&, int) {
    // Exactly as many bytes as asked for: the address sanitizer judges.
    const std::vector<std::uint8_t> bytes(lattice.image_bytes(), 1);
    const int reach_px = lattice.reach_px();
    for (const int row : {0, lattice.height - 1}) {
      for (int column = 0; column < lattice.width; column += kBlockSize) {
        for (int dy = -reach_px; dy <= reach_px; ++dy) {
          for (int dx = -reach_px; dx <= reach_px; ++dx) {
            const std::uint8_t* block =
                bytes.data() + (static_cast<std::ptrdiff_t>(lattice.byte_of(column, row)) +
                                lattice.offset_bytes(dx, dy));
            ASSERT_EQ(std::accumulate(block, block + kBlockSize, 0), kBlockSize);
          }
        }
      }
    }
  });
}

TEST(Lattice, SpreadPutsEachCellAtItsByteAndOutsideEverywhereElse) {
  std::mt19937 random(1);
  constexpr std::uint8_t kOutside = 200;
  over_lattices([&](const Lattice& lattice, const Size& size, int) {
    const auto cells = image::Image<std::uint8_t>::of(
        size.width_px, size.height_px, [&](int, int) { return integer(random, 0, 99); });
    std::vector<std::uint8_t> found(lattice.image_bytes(), 7);
    spread(cells.view(), lattice, kOutside, found.data());
    std::vector<std::uint8_t> expected(lattice.image_bytes(), kOutside);
    for (int y = 0; y < size.height_px; ++y) {
      for (int x = 0; x < size.width_px; ++x)
        expected[static_cast<std::size_t>(byte_of_cell(lattice, x, y))] = cells(x, y);
    }
    ASSERT_EQ(found, expected);
  });
}

TEST(Lattice, SpreadsAnImageWhoseRowsLieApart) {
  std::mt19937 random(2);
  const auto wide =
      image::Image<std::uint8_t>::of(40, 9, [&](int, int) { return integer(random, 0, 99); });
  const ImageView<const std::uint8_t> part{wide.view().data + 5, 21, 9, 40};
  const Lattice lattice = make_lattice(21, 9, 2, 3);
  std::vector<std::uint8_t> bytes(lattice.image_bytes());
  spread(part, lattice, 255, bytes.data());
  for (int y = 0; y < 9; ++y) {
    for (int x = 0; x < 21; ++x)
      EXPECT_EQ(bytes[static_cast<std::size_t>(byte_of_cell(lattice, x, y))], wide(x + 5, y));
  }
}

}  // namespace
}  // namespace flatpose::search
