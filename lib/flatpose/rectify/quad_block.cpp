#include "flatpose/rectify/quad_block.hpp"

#include "flatpose/rectify/lanes.hpp"
#include "flatpose/rectify/scan_row.hpp"

namespace flatpose::rectify {
namespace {

static_assert(kBlock % kLanes == 0 && kRowPadding >= kLanes,
              "the last quads of a block are judged together with what lies beyond");

constexpr std::int32_t kAbc = kAb | kBc | kAc;
constexpr std::int32_t kAcd = kAc | kCd | kAd;
constexpr std::int32_t kAbd = kAb | kBd | kAd;
constexpr std::int32_t kBcd = kBc | kCd | kBd;
constexpr std::int32_t kAllEdges = kAbc | kAcd | kBd;

/// One corner of four quads.
struct Corners {
  Int4 u, v;
  Float4 z_mm;
};

/// The corners of the quads from `i` on.
struct Quads {
  Corners a, b, c, d;

  Quads(const QuadBlock& block, int i) noexcept
      : a{load4(block.u_above + i), load4(block.v_above + i), load4(block.z_above_mm + i)},
        b{load4(block.u_above + i + 1), load4(block.v_above + i + 1),
          load4(block.z_above_mm + i + 1)},
        c{load4(block.u_below + i + 1), load4(block.v_below + i + 1),
          load4(block.z_below_mm + i + 1)},
        d{load4(block.u_below + i), load4(block.v_below + i), load4(block.z_below_mm + i)} {}
};

/// Cells whose centres lie in the boxes of the quads. Places are odd and centres even: the first
/// centre beyond u is (u >> bits) + 1.
struct Boxes {
  Int4 column, row;  // the last ones
  Int4 columns, rows;

  explicit Boxes(const Quads& q) noexcept {
    column = larger(larger(q.a.u, q.b.u), larger(q.c.u, q.d.u)) >> kUnitBits;
    row = larger(larger(q.a.v, q.b.v), larger(q.c.v, q.d.v)) >> kUnitBits;
    columns = column - (smaller(smaller(q.a.u, q.b.u), smaller(q.c.u, q.d.u)) >> kUnitBits);
    rows = row - (smaller(smaller(q.a.v, q.b.v), smaller(q.c.v, q.d.v)) >> kUnitBits);
  }
};

/// False when an end is missing: its height is NaN.
Int4 holds(const EdgeLimits& limits, const Corners& p, const Corners& q) noexcept {
  const Float4 x = to_float(q.u - p.u);
  const Float4 y = to_float(q.v - p.v);
  const Float4 length_squared = x * x + y * y;
  const Float4 beyond_mm = absolute(q.z_mm - p.z_mm) - limits.jump_mm;
  return (length_squared <= limits.gap_squared) &
         ((beyond_mm <= 0.0F) | (beyond_mm * beyond_mm <= limits.slope_squared * length_squared));
}

/// False also when an end is missing.
Int4 is_level(const EdgeLimits& limits, const Corners& p, const Corners& q) noexcept {
  return absolute(q.z_mm - p.z_mm) <= limits.jump_mm;
}

/// Quads that lie within two cells and step nowhere: all six edges hold without a closer look.
Int4 hold_at_a_glance(const EdgeLimits& limits, const Quads& q, const Boxes& box) noexcept {
  constexpr float kDiagonalSquared = 8.0F * kUnitsPerCell * kUnitsPerCell;
  if (limits.gap_squared < kDiagonalSquared) return Int4{};
  return (box.columns <= 1) & (box.rows <= 1) & is_level(limits, q.a, q.b) &
         is_level(limits, q.b, q.c) & is_level(limits, q.c, q.d) & is_level(limits, q.a, q.d) &
         is_level(limits, q.a, q.c) & is_level(limits, q.b, q.d);
}

Int4 edges_of(const EdgeLimits& limits, const Quads& q) noexcept {
  return (holds(limits, q.a, q.b) & kAb) | (holds(limits, q.b, q.c) & kBc) |
         (holds(limits, q.c, q.d) & kCd) | (holds(limits, q.a, q.d) & kAd) |
         (holds(limits, q.a, q.c) & kAc) | (holds(limits, q.b, q.d) & kBd);
}

/// A corner as seen from the centre of a cell. Where that is not the box's only one the numbers
/// mean nothing, and are not looked at.
struct Seen {
  Float4 x, y, z_mm;

  Seen(const Corners& p, const Boxes& box) noexcept
      : x(to_float(p.u - box.column * kUnitsPerCell)),
        y(to_float(p.v - box.row * kUnitsPerCell)),
        z_mm(p.z_mm) {}
  Seen(Int4 mask, const Seen& p, const Seen& q) noexcept  // p where the mask is set, else q
      : x(mask ? p.x : q.x), y(mask ? p.y : q.y), z_mm(mask ? p.z_mm : q.z_mm) {}

  [[nodiscard]] Float4 distance_squared() const noexcept { return x * x + y * y; }
};

/// The edge function of p->q at the centre.
Float4 edge(const Seen& p, const Seen& q) noexcept { return p.x * q.y - p.y * q.x; }

Int4 same_side(Float4 p, Float4 q, Float4 r) noexcept {
  return (smaller(smaller(p, q), r) >= 0.0F) | (larger(larger(p, q), r) <= 0.0F);
}

/// What the first diagonal's triangles make of the only centre in each box.
struct Hits {
  Int4 covered, folded;  // folded: both triangles cover it, at two heights
  Float4 height_mm;
  Int4 nearest;

  Hits(const Quads& q, const Boxes& box, Int4 may_abc, Int4 may_acd) noexcept {
    const Seen a(q.a, box), b(q.b, box), c(q.c, box), d(q.d, box);
    const Float4 ab = edge(a, b), bc = edge(b, c), cd = edge(c, d), da = edge(d, a);
    const Float4 ac = edge(a, c);
    const Float4 area_abc = ab + bc - ac;
    const Float4 area_acd = ac + cd + da;
    const Int4 in_abc = may_abc & same_side(ab, bc, -ac) & (area_abc != 0.0F);
    const Int4 in_acd = may_acd & same_side(ac, cd, da) & (area_acd != 0.0F);
    covered = in_abc | in_acd;
    folded = in_abc & in_acd & ((area_abc > 0.0F) ^ (area_acd > 0.0F));

    // The triangle over the centre is a, c and a third; on the diagonal both are right.
    const Seen third(in_abc, b, d);
    const Float4 weight_third = in_abc ? -ac : ac;
    const Float4 weight_c = in_abc ? ab : da;
    const Float4 area = in_abc ? area_abc : area_acd;
    height_mm =
        a.z_mm + (weight_third * (third.z_mm - a.z_mm) + weight_c * (c.z_mm - a.z_mm)) / area;

    const Float4 to_a = a.distance_squared();
    const Float4 to_third = third.distance_squared();
    const Int4 third_is_nearer = to_third < to_a;
    const Float4 to_nearer = third_is_nearer ? to_third : to_a;
    const Int4 nearer = third_is_nearer & ((in_abc & 1) | (~in_abc & 3));
    const Int4 c_is_nearest = c.distance_squared() < to_nearer;
    nearest = (c_is_nearest & 2) | (~c_is_nearest & nearer);
  }
};

}  // namespace

bool covers_any(const QuadBlock& block) noexcept {
  Int4 covers{};
  for (int i = 0; i < block.count; i += kLanes) {
    const Int4 u = load4(block.u_above + i), v = load4(block.v_above + i);
    // No centre's column passes between four places that lie between the same two.
    const Int4 across = (u ^ load4(block.u_above + i + 1)) | (u ^ load4(block.u_below + i)) |
                        (u ^ load4(block.u_below + i + 1));
    const Int4 down = (v ^ load4(block.v_above + i + 1)) | (v ^ load4(block.v_below + i)) |
                      (v ^ load4(block.v_below + i + 1));
    covers |= ((across >> kUnitBits) != 0) & ((down >> kUnitBits) != 0);
  }
  return any(covers);
}

void find_cells(const QuadBlock& block, const EdgeLimits& edge_limits, const Grid& grid,
                BlockFindings& out) noexcept {
  const EdgeLimits limits = edge_limits;
  const std::int32_t width_px = grid.width_px;
  const std::int32_t height_px = grid.height_px;
  for (int i = 0; i < block.count; i += kLanes) {
    const Quads quads(block, i);
    const Boxes box(quads);
    const Int4 covers = (box.columns > 0) & (box.rows > 0);
    if (!any(covers)) {
      store(out.finding.data() + i, covers);
      continue;
    }
    const Int4 plain = hold_at_a_glance(limits, quads, box);
    const Int4 edges = all(plain) ? plain & kAllEdges : edges_of(limits, quads);
    const Int4 may_abc = (edges & kAbc) == kAbc;
    const Int4 may_acd = (edges & kAcd) == kAcd;
    // The second diagonal never has more triangles when the first has one.
    const Int4 first = may_abc | may_acd;
    const Int4 second = ((edges & kAbd) == kAbd) | ((edges & kBcd) == kBcd);
    const Hits hits(quads, box, may_abc, may_acd);
    const Int4 inside =
        (box.column >= 0) & (box.column < width_px) & (box.row >= 0) & (box.row < height_px);
    const Int4 one_cell = (box.columns == 1) & (box.rows == 1);
    const Int4 simple = first & one_cell & ~hits.folded;
    const Int4 finding =
        (simple & inside & hits.covered & static_cast<std::int32_t>(Finding::kOneCell)) |
        (covers & (first | second) & ~simple & static_cast<std::int32_t>(Finding::kTriangles));
    store(out.finding.data() + i, finding);
    store(out.edges.data() + i, edges);
    store(out.column.data() + i, box.column);
    store(out.row.data() + i, box.row);
    store(out.height_mm.data() + i, hits.height_mm);
    store(out.nearest.data() + i, hits.nearest);
  }
}

}  // namespace flatpose::rectify
