#include "port/linux/daemon/scan_source.hpp"

#include "port/linux/daemon/driver_source.hpp"
#include "port/linux/daemon/event_file.hpp"
#include "port/linux/daemon/replay_source.hpp"
#include "port/linux/daemon/watch_source.hpp"

namespace flatpose::daemon {

bool ScanSource::hear(job::SearchEvent& event) noexcept {
  SourceLife life;
  if (!life_.take(life)) return false;
  using Kind = job::SearchEvent::Kind;
  event = {};
  event.kind = life.is_alive ? Kind::kSourceAlive : Kind::kSourceGone;
  event.result.is_simulated = life.is_simulated;
  return true;
}

void ScanSource::tell(const SourceLife& life) noexcept {
  life_.put(life);
  ring_event(wake_);
}

std::unique_ptr<ScanSource> make_scan_source(const Config& config, const ScanBuffers& buffers,
                                             Doorbell& taker, int wake, Log& log) {
  if (!config.source.driver.empty())
    return std::make_unique<DriverSource>(config, buffers, taker, wake, log);
  if (!config.source.watch.empty())
    return std::make_unique<WatchSource>(config, buffers, taker, wake, log);
  if (config.source.replay.empty()) return nullptr;
  return std::make_unique<ReplaySource>(config, buffers, taker, wake);
}

}  // namespace flatpose::daemon
