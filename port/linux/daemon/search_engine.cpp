#include "port/linux/daemon/search_engine.hpp"

#include <memory>
#include <stdexcept>
#include <string>

#include "port/linux/realtime/thread_setup.hpp"
#include "port/linux/threads/worker_pool.hpp"

namespace flatpose::daemon {

SearchEngine::SearchEngine(const Config& config)
    : config_(config),
      arena_(locate::Locator::required_bytes(config.search.limits)),
      scans_{port::PrefaultedMemory(scan_buffer_bytes(config.search.limits)),
             port::PrefaultedMemory(scan_buffer_bytes(config.search.limits))} {
  const Status status = locator_.init(config.search.limits, arena_.span());
  if (status != Status::kOk)
    throw std::runtime_error(std::string("the limits of [search]: ") + to_string(status));
}

void SearchEngine::start() {
  thread_ = std::thread([this] { work(); });
  is_ready_.wait(false);
  if (!failure_) return;
  stop();
  std::rethrow_exception(failure_);
}

SearchEngine::~SearchEngine() { stop(); }

void SearchEngine::stop() noexcept {
  is_over_.store(true);
  call_.fetch_add(1);
  call_.notify_one();
  if (thread_.joinable()) thread_.join();
}

void SearchEngine::ask() noexcept {
  asked_.fetch_add(1);
  call_.fetch_add(1);
  call_.notify_one();
}

void SearchEngine::work() noexcept {
  std::unique_ptr<port::WorkerPool> workers;
  try {
    // Before this thread is set up itself: threads inherit processor and priority from their maker.
    workers = std::make_unique<port::WorkerPool>(config_.search.thread_count, config_.realtime);
    steps_ = port::set_up_this_thread(config_.realtime, 0, "search 0");
    port::append(steps_, port::Steps(workers->steps()));
  } catch (...) {
    failure_ = std::current_exception();
  }
  is_ready_.store(true);
  is_ready_.notify_one();
  std::uint32_t seen = 0;
  while (!is_over_.load()) {
    call_.wait(seen);
    seen = call_.load();
    answered_.store(asked_.load());
  }
}

}  // namespace flatpose::daemon
