#pragma once
// One bin of the grid search: its blocks of places, first as nodes of branch and bound, where there
// are any, then those places and angles that the bound leaves.

#include <cstdint>

#include "flatpose/search/local_minima.hpp"
#include "flatpose/search/places.hpp"
#include "flatpose/search/search_images.hpp"
#include "flatpose/search/turned_template.hpp"

namespace flatpose::search {

struct BinJob {
  const SearchImages& images;
  const Places& places;
  const TurnedTemplate& turned;
  const SectorBests& bests;
  SearchBlock search_block;
  BoundNodes bound_nodes;
};

/// Searches the blocks [begin, end) of one bin. Returns how many hypotheses it looked at one by
/// one.
std::int64_t search_bin(const BinJob& job, int begin, int end) noexcept;

}  // namespace flatpose::search
