#include "port/sim/can/can_bus.hpp"

#include <algorithm>
#include <utility>

namespace flatpose::sim {

class CanBus::End final : public can::Link {
 public:
  End(CanBus& bus, int index) : bus_(bus), index_(index) {}

  Received receive() noexcept override {
    if (inbox_.empty()) return {};
    const Received first = inbox_.front();
    inbox_.pop_front();
    return first;
  }
  bool send(const can::Frame& frame) noexcept override {
    if (is_off() || sent_in_step_ >= bus_.faults_.room) return false;
    if (frame.is_fd && !bus_.carries_fd_) return true;
    ++sent_in_step_;
    return bus_.take(index_, frame);
  }

  [[nodiscard]] bool is_off() const noexcept { return state_ == can::BusState::kOff; }
  void put(const can::Frame& frame) {
    inbox_.push_back({Received::Kind::kFrame, frame, {}, bus_.now_us_});
  }
  void set(can::BusState state) {
    state_ = state;
    const can::BusEvent event{.state = state, .carries_fd = bus_.carries_fd_};
    inbox_.push_back({Received::Kind::kBus, {}, event, bus_.now_us_});
  }
  [[nodiscard]] can::BusState state() const noexcept { return state_; }
  void step() { sent_in_step_ = 0; }

 private:
  CanBus& bus_;
  int index_;
  can::BusState state_ = can::BusState::kActive;
  int sent_in_step_ = 0;
  std::deque<Received> inbox_;
};

can::Link& CanBus::attach() {
  ends_.push_back(std::make_shared<End>(*this, static_cast<int>(ends_.size())));
  return *ends_.back();
}

bool CanBus::take(int from, const can::Frame& frame) {
  ++sent_count_;
  for (int to = 0; to < static_cast<int>(ends_.size()); ++to) {
    if (to == from || random_.uniform() < faults_.lost) continue;
    const int copies = random_.uniform() < faults_.doubled ? 2 : 1;
    for (int i = 0; i < copies; ++i) {
      int steps = random_.uniform() < faults_.late ? 2 + random_.index(3) : 1;
      for (const Flying& before : flying_) {
        const bool is_alike = before.from == from && before.to == to && before.frame.id == frame.id;
        if (is_alike) steps = std::max(steps, before.steps);
      }
      flying_.push_back({from, to, steps, frame});
    }
  }
  return true;
}

void CanBus::step(std::int64_t now_us) {
  now_us_ = now_us;
  std::deque<Flying> still;
  for (Flying& flying : flying_) {
    if (ends_[static_cast<std::size_t>(flying.from)]->is_off()) continue;
    End& reader = *ends_[static_cast<std::size_t>(flying.to)];
    if (--flying.steps > 0) {
      still.push_back(flying);
    } else if (!reader.is_off()) {
      reader.put(flying.frame);
    }
  }
  flying_ = std::move(still);
  for (const auto& end : ends_) end->step();
}

void CanBus::set_fd(bool carries_fd) {
  carries_fd_ = carries_fd;
  for (const auto& end : ends_) end->set(end->state());
}

void CanBus::set_state(int end, can::BusState state) {
  ends_[static_cast<std::size_t>(end)]->set(state);
}

}  // namespace flatpose::sim
