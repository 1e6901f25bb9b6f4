#include "bench/speed/station.hpp"

#include <stdexcept>

#include "port/linux/clock/steady_clock.hpp"

namespace flatpose::bench {

locate::LocateResult Station::locate(const Shot& shot, const model::Template& part,
                                     const locate::LocateConfig& config, VectorPath path) {
  locate::Limits limits = tool::limits_for(shot.loaded.scan);
  limits.vector_path = path;
  const std::size_t size_bytes = locate::Locator::required_bytes(limits);
  if (!memory_ || memory_->size_bytes() < size_bytes)
    memory_ = std::make_unique<tool::Memory>(size_bytes);
  locate::Locator locator;
  locate::LocateResult result;
  Status status = locator.init(limits, memory_->span());
  if (status == Status::kOk)
    status = locator.locate(part, shot.loaded.scan.view(), shot.loaded.frames, config,
                            port::SteadyClock{}, result);
  if (status != Status::kOk) throw std::runtime_error(std::string("locate: ") + to_string(status));
  return result;
}

}  // namespace flatpose::bench
