// flatpose_speed: the benches, as Google Benchmark runs them. run_bench.py drives it.

#include <benchmark/benchmark.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string_view>

#include "bench/speed/benches.hpp"

int main(int argc, char** argv) {
  flatpose::bench::BenchOptions options;
  benchmark::Initialize(&argc, argv);
  for (int i = 1; i < argc; ++i) {
    if (std::string_view(argv[i]) == "--quick") {
      options.seed_count = 2;
      options.ground_count = 1;
    } else {
      std::fprintf(stderr, "flatpose_speed: unknown argument '%s'\n", argv[i]);
      return 2;
    }
  }
  try {
    flatpose::bench::register_search_benches(options);
    flatpose::bench::register_image_benches(options);
    flatpose::bench::register_cycle_benches(options);
    flatpose::bench::register_growth_benches(options);
    flatpose::bench::register_bounds_benches(options);
    benchmark::RunSpecifiedBenchmarks();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "flatpose_speed: %s\n", error.what());
    return 3;
  }
  return 0;
}
