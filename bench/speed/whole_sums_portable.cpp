#include "flatpose/search/block_search.hpp"
#define FLATPOSE_LANES 16
#include "whole_sums.inc"  // made by the build

namespace flatpose::bench {
void whole_sums_portable(const search::BlockJob& job) noexcept { search::search_block(job); }
}  // namespace flatpose::bench
