#include "flatpose/search/block_search.hpp"
#define FLATPOSE_LANES 32
#define FLATPOSE_WIDTH lanes_32
#include "whole_sums.inc"  // made by the build

namespace flatpose::bench {
void whole_sums_avx2(const search::BlockJob& job) noexcept {
  search::lanes_32::search_span(job, search::lanes_32::wanted_span(job));
}
}  // namespace flatpose::bench
