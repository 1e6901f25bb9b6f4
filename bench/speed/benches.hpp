#pragma once
// What can be measured. Each call registers benchmarks by name: GROUP/INPUT/CONTENDER. run_bench.py
// runs a group with its contenders interleaved, so that what else the machine does hits all alike.

namespace flatpose::bench {

struct BenchOptions {
  int seed_count = 10;   ///< Scans of a scene that is located in.
  int ground_count = 2;  ///< Scans of a scene that is searched.
};

void register_search_benches(const BenchOptions& options);
void register_image_benches(const BenchOptions& options);
void register_cycle_benches(const BenchOptions& options);
void register_growth_benches(const BenchOptions& options);
/// By `flatpose_speed --benchmark_filter=^bounds/` alone: no table tells of it.
void register_bounds_benches(const BenchOptions& options);

}  // namespace flatpose::bench
