#include "flatpose/search/block_search.hpp"
#define FLATPOSE_LANES 64
#include "flatpose/search/block_search.inc"

namespace flatpose::search {
void search_block_avx512(const BlockJob& job) noexcept { search_block(job); }
}  // namespace flatpose::search
