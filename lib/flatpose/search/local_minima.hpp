#pragma once
// What of the costs of all places, angles and sectors is a candidate: the local minima among
// neighbours in place and angle, the lowest first.

#include <array>
#include <cstdint>
#include <span>

#include "flatpose/core/arena.hpp"
#include "flatpose/search/block_search.hpp"
#include "flatpose/search/candidate.hpp"
#include "flatpose/search/hypotheses.hpp"
#include "flatpose/search/places.hpp"

namespace flatpose::search {

/// Where the results lie: by sector, as the places are. What is no place, or has no cost below the
/// cut-off, has kNoAngle and kCostMax; a sector without angles has no memory.
struct SectorBests {
  std::array<std::span<std::uint8_t>, kSectorCount> cost;
  std::array<std::span<std::uint8_t>, kSectorCount> angle;
};

/// By block and sector the lowest cost: what is asked before anything is looked at.
[[nodiscard]] std::span<std::uint8_t> take_block_lows(Arena& arena,
                                                      std::size_t place_count) noexcept;

/// Fills `minima` with the best, in order of cost, row, column, angle, and returns how many. Of a
/// candidate it knows the angle, and for now in places and plain cost: column, row, cost_q10.
/// No neighbouring place (within two) is better at about the same angle (within two); of equals
/// the first counts; of `hypotheses` (null: all are) those
/// that are not wanted take no room.  Cost: one pass over the costs; then
/// only blocks that hold something as good.
[[nodiscard]] int list_minima(const Places& places, const SectorBests& bests, int angle_count,
                              std::span<std::uint8_t> block_lows, std::span<Candidate> minima,
                              const Hypotheses* hypotheses = nullptr) noexcept;

}  // namespace flatpose::search
