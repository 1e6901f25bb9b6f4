#include "flatpose/search/block_search.hpp"
#define FLATPOSE_LANES 16
#define FLATPOSE_WIDTH lanes_16
#include "flatpose/search/block_search.inc"

namespace flatpose::search {
void search_block_portable(const BlockJob& job) noexcept {
  lanes_16::search_span(job, lanes_16::wanted_span(job));
}
void bound_nodes_portable(const NodeJob& job) noexcept { lanes_16::bound_nodes(job); }
}  // namespace flatpose::search
