#include "port/linux/daemon/can_node.hpp"

#include <stdexcept>

#include "port/linux/can/interface.hpp"

namespace flatpose::daemon {

CanNode::CanNode(const CanConfig& config, job::Machine& machine, std::int64_t now_us)
    : link_(config.place, config.interface, config.node.node, config.need()),
      device_(machine),
      station_(device_, link_) {
  const port::CanInterface found = port::look_at_can(config.interface);
  name_ = "CANopen node " + std::to_string(config.node.node) + " on " +
          port::to_text(config.interface, found);
  doubt_ = port::doubt_of(config.interface, found, config.need()).value_or("");
  can::Config node = config.node;
  node.software = FLATPOSE_VERSION;
  node.carries_fd = link_.carries_fd();
  if (device_.init(node, now_us) != Status::kOk)
    throw std::runtime_error("the CAN node refuses its config");
}

}  // namespace flatpose::daemon
