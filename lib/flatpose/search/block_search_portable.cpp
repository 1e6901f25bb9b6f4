#include "flatpose/search/block_search.hpp"
#define FLATPOSE_LANES 16
#include "flatpose/search/block_search.inc"

namespace flatpose::search {
void search_block_portable(const BlockJob& job) noexcept { search_block(job); }
void bound_nodes_portable(const NodeJob& job) noexcept { bound_nodes(job); }
}  // namespace flatpose::search
