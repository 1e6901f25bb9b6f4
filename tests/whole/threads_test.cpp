// A search gives the same bits whoever runs its chunks, and in whatever order.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "bench/scenes/trial.hpp"
#include "port/linux/threads/worker_pool.hpp"

namespace flatpose::bench {
namespace {

/// The last chunk first; none may share out work in its turn.
class Backwards final : public Executor {
 public:
  void parallel_for(int chunk_count, Task task, void* context) noexcept override {
    EXPECT_FALSE(is_at_work_);
    is_at_work_ = true;
    for (int i = chunk_count; i-- > 0;) task(context, i);
    is_at_work_ = false;
    most_chunks_ = std::max(most_chunks_, chunk_count);
  }
  [[nodiscard]] int most_chunks() const noexcept { return most_chunks_; }

 private:
  int most_chunks_ = 0;
  bool is_at_work_ = false;
};

struct ThreadsCase {
  std::string scene;
  std::string part;
  int max_matches;
};

void PrintTo(const ThreadsCase& c, std::ostream* out) { *out << c.scene << " " << c.part; }

class Threads : public testing::TestWithParam<ThreadsCase> {};

TEST_P(Threads, GiveTheSameDigest) {
  ShotConfig config;
  config.scene.scene = GetParam().scene;
  config.scene.part = GetParam().part;
  config.seed = 5;
  const Shot shot = take_shot(config);
  const model::Template part = teach_part(GetParam().part, {}).part;
  locate::LocateConfig search;
  search.max_matches = GetParam().max_matches;
  Searcher searcher;
  const locate::LocateResult alone = searcher.locate(shot, part, search);
  const auto digest_by = [&](Executor& executor) {
    return locate::digest(searcher.locate(shot, part, search, port::best_vector_path(), executor));
  };
  Backwards backwards;
  EXPECT_EQ(digest_by(backwards), locate::digest(alone));
  EXPECT_GT(backwards.most_chunks(), 1);  // there was something to turn round
  for (const int thread_count : {2, 3, 8}) {
    port::WorkerPool pool(thread_count);
    EXPECT_EQ(digest_by(pool), locate::digest(alone)) << thread_count;
  }
  EXPECT_EQ(alone.match_count > 0, GetParam().scene != "absent");
}

INSTANTIATE_TEST_SUITE_P(Scenes, Threads,
                         testing::Values(ThreadsCase{"medium", "pad", 1},
                                         ThreadsCase{"pile", "pad", 20},
                                         ThreadsCase{"absent", "pad", 1},
                                         ThreadsCase{"cyl_grid", "cylinder", 64}),
                         [](const auto& made) { return made.param.scene; });

}  // namespace
}  // namespace flatpose::bench
