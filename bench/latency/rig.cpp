#include "bench/latency/rig.hpp"

#include <algorithm>
#include <exception>
#include <future>
#include <numeric>
#include <random>
#include <stdexcept>
#include <thread>

#include "bench/latency/spin.hpp"
#include "port/linux/clock/steady_clock.hpp"
#include "port/linux/realtime/thread_setup.hpp"
#include "port/linux/threads/worker_pool.hpp"

namespace flatpose::bench {
namespace {

constexpr std::size_t kSamplesMax = 1'000'000;
/// Of what is between two sleeps: as long as one lasts at least. A thread of fixed priority that
/// never slept would be stopped by the kernel's guard.
constexpr double kSleepShare = 0.15;
constexpr std::size_t kSweptValues = 1 << 20;  // of 8 bytes, by each thread
constexpr double kShareMin = 0.02;             // of the usual time, that a deadline leaves
constexpr double kShareMax = 0.98;

Shot take(const RigConfig& config, const std::string& scene, int seed) {
  ShotConfig shot;
  shot.scene.scene = scene;
  shot.sensor.columns = config.columns;
  shot.sensor.rows = config.rows;
  shot.seed = static_cast<std::uint64_t>(seed);
  return take_shot(shot);
}

/// Seed by seed, so that scenes are mixed; two at a time.
std::vector<Shot> take_all(const RigConfig& config) {
  std::vector<Shot> shots;
  for (int seed = 0; seed < config.seed_count; ++seed) {
    for (std::size_t i = 0; i < config.scenes.size(); i += 2) {
      std::future<Shot> other;
      if (i + 1 < config.scenes.size())
        other = std::async(std::launch::async, take, config, config.scenes[i + 1], seed);
      shots.push_back(take(config, config.scenes[i], seed));
      if (other.valid()) shots.push_back(other.get());
    }
  }
  return shots;
}

class Order {
 public:
  explicit Order(std::size_t count) : list_(count), next_(count) {
    std::iota(list_.begin(), list_.end(), 0);
  }
  int next() {
    if (next_ == list_.size()) {
      std::shuffle(list_.begin(), list_.end(), random_);
      next_ = 0;
    }
    return list_[next_++];
  }

 private:
  std::vector<int> list_;
  std::size_t next_;
  std::mt19937_64 random_{1};
};

/// Runs the body on a thread of its own, as the daemon's search has; passes exceptions on.
template <class Body>
void on_search_thread(const Body& body) {
  std::exception_ptr failure;
  std::thread([&] {
    try {
      body();
    } catch (...) {
      failure = std::current_exception();
    }
  }).join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace

/// What a search thread holds while it runs.
struct Rig::Hands {
  Hands(int threads, const port::RealtimeConfig& realtime)
      : pool(threads, realtime),
        thread_count(threads),
        swept(kSweptValues * static_cast<std::size_t>(threads), 1) {
    // Set up last: threads inherit what their maker has.
    steps = port::set_up_this_thread(realtime, 0, "search 0");
    port::append(steps, port::Steps(pool.steps()));
  }
  void spin_on_all(std::int64_t step_count) noexcept {
    auto body = [&](int) {
      volatile std::uint64_t kept = spin(step_count);
      static_cast<void>(kept);
    };
    for_each_chunk(pool, thread_count, body);
  }

  /// Steps of spin_on_all() that take about this long, found by trying.
  std::int64_t spin_steps_for(std::int64_t time_ns) noexcept {
    constexpr int kTries = 12;
    std::int64_t step_count = 10'000;
    for (int i = 0; i < kTries; ++i) {
      const std::int64_t start_ns = now_ns();
      spin_on_all(step_count);
      const double taken_ns = static_cast<double>(std::max<std::int64_t>(now_ns() - start_ns, 1));
      // Half of what the last try says, so that one that was held up decides little.
      const double ratio = std::clamp(static_cast<double>(time_ns) / taken_ns, 0.5, 8.0);
      step_count =
          static_cast<std::int64_t>(static_cast<double>(step_count) * 0.5 * (1.0 + ratio)) + 1;
    }
    return step_count;
  }
  void sweep_on_all() noexcept {
    const std::size_t share = swept.size() / static_cast<std::size_t>(thread_count);
    auto body = [&](int i) {
      volatile std::uint64_t kept =
          sweep(std::span(swept).subspan(static_cast<std::size_t>(i) * share, share));
      static_cast<void>(kept);
    };
    for_each_chunk(pool, thread_count, body);
  }

  port::WorkerPool pool;
  int thread_count;
  std::vector<std::uint64_t> swept;
  port::Steps steps;
};

Rig::Rig(const RigConfig& config) : config_(config), shots_(take_all(config)) {
  if (shots_.empty()) throw std::runtime_error("no scans");
  for (const Shot& shot : shots_)
    if (!taught_.contains(shot.part)) taught_.emplace(shot.part, teach_part(shot.part, {}));
  const locate::Limits limits = tool::limits_for(shots_.front().loaded.scan);
  memory_.emplace(locate::Locator::required_bytes(limits));
  if (locator_.init(limits, memory_->span()) != Status::kOk)
    throw std::runtime_error("the locator refuses its memory");
  setup_.emplace(config.realtime);
}

locate::LocateResult Rig::search(int scan, std::int64_t deadline_us, Executor& executor) {
  const Shot& shot = shots_[static_cast<std::size_t>(scan)];
  const port::SteadyClock clock;
  locate::LocateConfig config;
  config.max_matches = config_.max_matches;
  config.deadline_us = deadline_us;
  locate::LocateResult result;
  const Status status = locator_.locate(taught_.at(shot.part).part, shot.loaded.scan.view(),
                                        shot.loaded.frames, config, {clock, executor}, result);
  if (status != Status::kOk) throw std::runtime_error(shot.loaded.path + ": " + to_string(status));
  return result;
}

std::vector<std::int64_t> Rig::usual_times_us(Executor& executor) {
  std::vector<std::int64_t> times_us(shots_.size(), INT64_MAX);
  for (int round = 0; round < 2; ++round)
    for (std::size_t i = 0; i < shots_.size(); ++i)
      times_us[i] =
          std::min(times_us[i], search(static_cast<int>(i), 0, executor).timings.total_us);
  return times_us;
}

void Rig::cycle(Hands& hands, int scan, std::int64_t busy_steps, CycleRun& run) {
  CycleSample sample;
  sample.scan = scan;
  const Events before = Events::now();
  const std::int64_t start_ns = now_ns();
  const locate::LocateResult result = search(scan, 0, hands.pool);
  sample.cycle_ns = now_ns() - start_ns;
  const Events between = Events::now();
  const std::int64_t busy_start_ns = now_ns();
  hands.spin_on_all(busy_steps);
  sample.busy_ns = now_ns() - busy_start_ns;
  const std::int64_t sweep_start_ns = now_ns();
  hands.sweep_on_all();
  sample.memory_ns = now_ns() - sweep_start_ns;
  run.in_cycles.add(before, between);
  run.in_loops.add(between, Events::now());
  sample.timings = result.timings;
  sample.outcome = result.outcome;

  const auto sleep_ns =
      static_cast<std::int64_t>(kSleepShare * static_cast<double>(now_ns() - start_ns));
  const auto until = std::chrono::steady_clock::now() + std::chrono::nanoseconds(sleep_ns);
  std::this_thread::sleep_until(until);
  sample.wake_ns =
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now() - until)
          .count();
  run.samples.push_back(sample);
}

CycleRun Rig::run_cycles(int thread_count, double seconds) {
  CycleRun run;
  // Written to beforehand: no page of it is new during the run.
  run.samples.resize(std::min(kSamplesMax, static_cast<std::size_t>(1000.0 * seconds) + 1000));
  const std::size_t samples_max = run.samples.size();
  run.samples.clear();
  on_search_thread([&] {
    Hands hands(thread_count, config_.realtime);
    std::vector<std::int64_t> usual_us = usual_times_us(hands.pool);  // and warm
    std::nth_element(usual_us.begin(), usual_us.begin() + usual_us.size() / 2, usual_us.end());
    const std::int64_t busy_steps = hands.spin_steps_for(1000 * usual_us[usual_us.size() / 2]);
    hands.spin_on_all(busy_steps);
    hands.sweep_on_all();
    Order order(shots_.size());
    const std::int64_t end_ns = now_ns() + static_cast<std::int64_t>(1e9 * seconds);
    while (now_ns() < end_ns && run.samples.size() < samples_max)
      cycle(hands, order.next(), busy_steps, run);
    run.steps = hands.steps;
  });
  return run;
}

std::vector<DeadlineSample> Rig::run_deadlines(int thread_count, double seconds) {
  std::vector<DeadlineSample> samples;
  samples.reserve(std::min(kSamplesMax, static_cast<std::size_t>(10'000.0 * seconds) + 1000));
  on_search_thread([&] {
    Hands hands(thread_count, config_.realtime);
    const std::vector<std::int64_t> usual_us = usual_times_us(hands.pool);
    Order order(shots_.size());
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> share(kShareMin, kShareMax);
    const std::int64_t end_ns = now_ns() + static_cast<std::int64_t>(1e9 * seconds);
    while (now_ns() < end_ns && samples.size() < samples.capacity()) {
      DeadlineSample sample;
      sample.scan = order.next();
      sample.usual_us = usual_us[static_cast<std::size_t>(sample.scan)];
      sample.deadline_us = std::max<std::int64_t>(
          1, static_cast<std::int64_t>(share(random) * static_cast<double>(sample.usual_us)));
      const std::int64_t start_ns = now_ns();
      sample.outcome = search(sample.scan, sample.deadline_us, hands.pool).outcome;
      sample.elapsed_ns = now_ns() - start_ns;
      samples.push_back(sample);
      std::this_thread::sleep_for(std::chrono::nanoseconds(
          static_cast<std::int64_t>(kSleepShare * static_cast<double>(sample.elapsed_ns))));
    }
  });
  return samples;
}

}  // namespace flatpose::bench
