#include "bench/speed/whole_sums.hpp"

namespace flatpose::bench {

#ifdef FLATPOSE_HAS_WHOLE_SUMS
void whole_sums_portable(const search::BlockJob& job) noexcept;
void whole_sums_avx2(const search::BlockJob& job) noexcept;
void whole_sums_avx512(const search::BlockJob& job) noexcept;

search::SearchBlock whole_sums_for(VectorPath path) noexcept {
  return FLATPOSE_FORM_FOR(path, whole_sums_portable, whole_sums_avx2, whole_sums_avx512);
}
#else
search::SearchBlock whole_sums_for(VectorPath) noexcept { return nullptr; }
#endif

}  // namespace flatpose::bench
