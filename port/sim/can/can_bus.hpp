#pragma once
// A CAN bus in memory, with what goes wrong on real ones: frames lost, doubled and late, a sender
// without room, a node that is off. The seed says what happens when.

#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "flatpose/can/link.hpp"
#include "port/sim/random.hpp"

namespace flatpose::sim {

/// Shares from 0 to 1, of frames and readers of them.
struct CanFaults {
  double lost = 0.0;
  double doubled = 0.0;
  /// By one to three steps, so that others overtake it; never one of its own id and sender: that
  /// CAN does not do.
  double late = 0.0;
  int room = 1000;  ///< Frames that a node can send between two steps.
};

class CanBus {
 public:
  explicit CanBus(std::uint64_t seed, const CanFaults& faults = {})
      : random_(seed), faults_(faults) {}

  /// A node's end, for as long as the bus lives.
  can::Link& attach();

  /// Time goes on: what was sent arrives now.
  void step(std::int64_t now_us);

  /// The controller of the n-th end. Off: it neither sends nor gets, and what it had sent is lost.
  void set_state(int end, can::BusState state);
  /// Whether it is an FD bus; on a classic one FD frames are lost. All ends are told.
  void set_fd(bool carries_fd);

  void set_faults(const CanFaults& faults) { faults_ = faults; }
  [[nodiscard]] int sent_count() const noexcept { return sent_count_; }

 private:
  class End;
  struct Flying {
    int from = 0;
    int to = 0;
    int steps = 1;
    can::Frame frame;
  };

  bool take(int from, const can::Frame& frame);

  Random random_;
  CanFaults faults_;
  std::vector<std::shared_ptr<End>> ends_;
  std::deque<Flying> flying_;
  int sent_count_ = 0;
  std::int64_t now_us_ = 0;
  bool carries_fd_ = false;
};

}  // namespace flatpose::sim
