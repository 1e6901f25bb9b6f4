#include "port/linux/daemon/config_map.hpp"

#include "port/linux/daemon/config.hpp"

namespace flatpose::daemon {

tool::ServedMap read_served_map(const std::string& config_path) {
  const Config config = load_config(config_path);
  tool::ServedMap served;
  served.config_path = config_path;
  served.format = config.modbus.format;
  served.handshake = config.modbus.handshake;
  served.node = config.can.node.node;
  served.fd_frame_id = config.can.node.fd_frame_id;
  for (const JobConfig& job : config.jobs) {
    tool::ServedJob shown{job.rule.job, {}, job.rule.frame, job.rule.convention};
    for (const int part : job.parts)
      shown.parts += (shown.parts.empty() ? "" : ", ") + config.parts[part].name;
    served.jobs.push_back(std::move(shown));
  }
  return served;
}

}  // namespace flatpose::daemon
