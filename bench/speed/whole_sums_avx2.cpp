#include "flatpose/search/block_search.hpp"
#define FLATPOSE_LANES 32
#include "whole_sums.inc"  // made by the build

namespace flatpose::bench {
void whole_sums_avx2(const search::BlockJob& job) noexcept { search::search_block(job); }
}  // namespace flatpose::bench
