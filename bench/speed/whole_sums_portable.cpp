#include "flatpose/search/block_search.hpp"
#define FLATPOSE_LANES 16
#define FLATPOSE_WIDTH lanes_16
#include "whole_sums.inc"  // made by the build

namespace flatpose::bench {
void whole_sums_portable(const search::BlockJob& job) noexcept {
  search::lanes_16::search_span(job, search::lanes_16::wanted_span(job));
}
}  // namespace flatpose::bench
