#pragma once
// Reads [[part]] and [[job]] again while the daemon runs: all of them, or the old ones stay. On the
// thread that waits for signals; SIGHUP and the master's reload_jobs come to it alike.

#include <functional>
#include <memory>
#include <utility>

#include "port/linux/daemon/config.hpp"
#include "port/linux/daemon/log.hpp"
#include "port/linux/daemon/search_engine.hpp"

namespace flatpose::daemon {

class Reloader {
 public:
  /// `read` gives the config as it is now, or fails with port::InputError. Refers to all of these,
  /// which must outlive it. Without a bus sets come into force at once.
  Reloader(const Config& running, std::function<Config()> read, SearchEngine& engine, bool has_bus,
           Log& log)
      : running_(running), read_(std::move(read)), engine_(engine), has_bus_(has_bus), log_(log) {}

  /// Somebody asks: reads the jobs, now.
  void ask();
  /// Whether a set waits for the search to end, or for the bus.
  [[nodiscard]] bool is_busy() const noexcept { return waiting_ != nullptr || is_offered_; }
  /// Gets on with it, as far as that can be.
  void step();

 private:
  [[nodiscard]] std::shared_ptr<const JobSet> load();
  void answer(bool is_done);
  void give_up();

  const Config& running_;
  std::function<Config()> read_;
  SearchEngine& engine_;
  const bool has_bus_;
  Log& log_;
  std::shared_ptr<const JobSet> waiting_;
  bool is_offered_ = false;
  bool is_asked_again_ = false;
  std::uint32_t ticket_ = 0;  ///< Of the master's command; 0: a signal asked.
};

}  // namespace flatpose::daemon
