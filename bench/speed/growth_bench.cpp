#include "bench/speed/benches.hpp"

namespace flatpose::bench {
void register_growth_benches(const BenchOptions&) {}
}  // namespace flatpose::bench
