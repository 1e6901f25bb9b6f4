#include "flatpose/image/hysteresis.hpp"

#include <cassert>
#include <cstddef>

#include "flatpose/image/edge.hpp"

namespace flatpose::image {
namespace {

bool is_crease(std::uint8_t mark) noexcept {
  return (mark & kKindBits) == static_cast<std::uint8_t>(EdgeKind::kCrease);
}

// Every cell is pushed at most once: when it loses its mark.
class Flood {
 public:
  Flood(ImageView<std::uint8_t> marks, std::span<std::int32_t> stack) noexcept
      : marks_(marks), stack_(stack) {}

  void keep(int x, int y) noexcept {
    push(x, y);
    while (size_ > 0) {
      const std::int32_t cell = stack_[--size_];
      visit_neighbours(cell & 0xFFFF, cell >> 16U);
    }
  }

 private:
  void push(int x, int y) noexcept {
    assert(size_ < stack_.size());
    marks_(x, y) &= kKindBits;
    stack_[size_++] = y << 16U | x;  // neither is beyond kEdgeMapSizeMax_px
  }
  void visit_neighbours(int x, int y) noexcept {
    const bool crease = is_crease(marks_(x, y));
    for (int ny = y - 1; ny <= y + 1; ++ny) {
      for (int nx = x - 1; nx <= x + 1; ++nx) {
        const std::uint8_t mark = marks_(nx, ny);
        if ((mark & (kWeakMark | kStrongMark)) != 0 && is_crease(mark) == crease) push(nx, ny);
      }
    }
  }

  ImageView<std::uint8_t> marks_;
  std::span<std::int32_t> stack_;
  std::size_t size_ = 0;
};

}  // namespace

void keep_connected(ImageView<std::uint8_t> marks, int x, int y,
                    std::span<std::int32_t> stack) noexcept {
  Flood(marks, stack).keep(x, y);
}

}  // namespace flatpose::image
