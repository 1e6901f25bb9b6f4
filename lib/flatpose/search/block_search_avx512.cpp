#include "flatpose/search/block_search.hpp"
#define FLATPOSE_LANES 64
#include "flatpose/search/block_search.inc"

namespace flatpose::search {
void search_block_avx512(const BlockJob& job) noexcept { search_block(job); }
void bound_nodes_avx512(const NodeJob& job) noexcept { bound_nodes(job); }
}  // namespace flatpose::search
