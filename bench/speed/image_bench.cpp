#include "bench/speed/benches.hpp"

namespace flatpose::bench {
void register_image_benches(const BenchOptions&) {}
}  // namespace flatpose::bench
