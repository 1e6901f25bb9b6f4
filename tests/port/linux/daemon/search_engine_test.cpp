// The search's thread without a bus: what it shows of itself while it searches.

#include "port/linux/daemon/search_engine.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "tests/port/linux/daemon/running_daemon.hpp"

namespace flatpose::daemon {
namespace {

using Kind = job::SearchEvent::Kind;

constexpr const char* kConfig = R"(
[search]
threads = 2
scan_width_px = 400
scan_height_px = 333
cell_count = 600_000
[source]
replay = "scan.pcd"
[[part]]
name = "pad"
file = "pad.fpt"
[[job]]
parts = ["pad", "pad2"]
max_tilt_deg = 60
[[part]]
name = "pad2"
file = "pad.fpt"
)";

class Engine : public testing::Test {
 protected:
  Engine()
      : config_(parse_config(FLATPOSE_EXAMPLE "/f.toml", kConfig)),
        jobs_(std::make_shared<const JobSet>(load_jobs(config_))),
        log_(lines_),
        engine_(std::make_unique<SearchEngine>(config_, jobs_, log_)) {
    engine_->start();
  }
  void locate(std::uint32_t ticket) {
    const std::int64_t now_us = port::SteadyClock().now_us();
    job::Order order;
    order.kind = job::Order::Kind::kStart;
    order.ticket = ticket;
    order.number = 1;
    order.job = 1;
    order.accepted_us = now_us;
    order.answer_by_us = now_us + 3'600'000'000;
    engine_->give(order);
  }
  bool says(Kind kind) {
    return comes_true([&] {
      while (engine_->take(event_))
        if (event_.kind == kind) return true;
      return false;
    });
  }
  bool answers(std::uint32_t asked) {
    return comes_true([&] { return engine_->has_answered(asked); });
  }

  Config config_;
  std::shared_ptr<const JobSet> jobs_;
  std::ostringstream lines_;
  Log log_;
  std::unique_ptr<SearchEngine> engine_;
  job::SearchEvent event_;
};

TEST_F(Engine, ShowsLifeBetweenSearches) {
  ASSERT_TRUE(answers(engine_->ask()));
  bool search_lives = false;
  bool source_lives = false;
  EXPECT_TRUE(comes_true([&] {
    while (engine_->take(event_)) {
      search_lives = search_lives || event_.kind == Kind::kSearchAlive;
      source_lives = source_lives || event_.kind == Kind::kSourceAlive;
    }
    return search_lives && source_lives;
  }));
}

TEST_F(Engine, ShowsLifeWithinASearch) {
  locate(1);
  ASSERT_TRUE(says(Kind::kScanned));
  int answers_within = 0;
  bool is_over = false;
  while (!is_over) {
    ASSERT_TRUE(answers(engine_->ask()));
    bool has_told = false;
    while (engine_->take(event_)) {
      has_told = has_told || event_.kind == Kind::kSearchAlive;
      is_over = is_over || event_.kind == Kind::kFinished;
    }
    answers_within += has_told && !is_over ? 1 : 0;
  }
  EXPECT_GT(answers_within, 5);
}

}  // namespace
}  // namespace flatpose::daemon
