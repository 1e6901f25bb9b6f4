#include "flatpose/search/block_search.hpp"
#define FLATPOSE_LANES 32
#define FLATPOSE_WIDTH lanes_32
#include "flatpose/search/block_search.inc"

namespace flatpose::search {
void search_block_avx2(const BlockJob& job) noexcept {
  lanes_32::search_span(job, lanes_32::wanted_span(job));
}
void bound_nodes_avx2(const NodeJob& job) noexcept { lanes_32::bound_nodes(job); }
}  // namespace flatpose::search
