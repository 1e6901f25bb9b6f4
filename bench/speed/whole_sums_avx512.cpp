#include "flatpose/search/block_search.hpp"
#define FLATPOSE_LANES 64
#define FLATPOSE_WIDTH lanes_64
#include "whole_sums.inc"  // made by the build

namespace flatpose::bench {
void whole_sums_avx512(const search::BlockJob& job) noexcept {
  search::lanes_64::search_span(job, search::lanes_64::wanted_span(job));
}
}  // namespace flatpose::bench
