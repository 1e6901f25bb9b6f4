#include "flatpose/search/block_search.hpp"
#define FLATPOSE_LANES 64
#define FLATPOSE_WIDTH lanes_64
#include "flatpose/search/block_search.inc"
#undef FLATPOSE_LANES
#undef FLATPOSE_WIDTH
#define FLATPOSE_LANES 32
#define FLATPOSE_WIDTH lanes_32
#include "flatpose/search/block_search.inc"

namespace flatpose::search {
void search_block_avx512(const BlockJob& job) noexcept {
  // Half a vector takes less, on processors that do a whole one in two turns half of the time.
  const auto span = lanes_64::wanted_span(job);
  if (span.last - span.first < 32) {
    lanes_32::search_span(job, {span.first, span.last});
  } else {
    lanes_64::search_span(job, span);
  }
}
void bound_nodes_avx512(const NodeJob& job) noexcept { lanes_64::bound_nodes(job); }
}  // namespace flatpose::search
