#include "port/linux/daemon/can_node.hpp"

#include <stdexcept>

#include "port/linux/can/interface.hpp"

namespace flatpose::daemon {

CanNode::CanNode(const CanConfig& config, job::Machine& machine, std::int64_t now_us)
    : link_(config.place, config.interface, config.node.node),
      device_(machine),
      station_(device_, link_) {
  const port::CanInterface interface = port::look_at_can(config.interface);
  port::check_can(config.place, config.interface, interface, config.bit_rate_per_s);
  name_ = "CANopen node " + std::to_string(config.node.node) + " on " +
          port::to_text(config.interface, interface);
  can::Config node = config.node;
  node.software = FLATPOSE_VERSION;
  if (device_.init(node, now_us) != Status::kOk)
    throw std::runtime_error("the CAN node refuses its config");
}

}  // namespace flatpose::daemon
