#include "flatpose/can/device.hpp"

#include <algorithm>

namespace flatpose::can {
namespace {

constexpr bool is_synchronous(std::uint8_t type) noexcept { return type <= 240; }

}  // namespace

Status Device::init(const Config& config, std::int64_t now_us) noexcept {
  const Status status = validate(config);
  if (status != Status::kOk) return status;
  config_ = config;
  now_us_ = now_us;
  bus_ = BusState::kActive;
  carries_fd_ = config.carries_fd;
  judgement_ = {};
  spent_number_ = 0;
  has_twin_ = false;
  report_ = report_of(machine_.snapshot(master()), judgement_);
  boot(now_us);
  return Status::kOk;
}

void Device::boot(std::int64_t now_us) noexcept {
  parameters_ = Parameters::at_start(config_);
  log_ = {};
  sdo_.reset();
  has_rpdo_ = false;
  told_fault_of_ = 0;
  owes_boot_up_ = true;
  producer_.restart(parameters_.heartbeat_ms, now_us);
  consumer_.restart(parameters_.watched_node, parameters_.watched_ms);
  enter(NetworkState::kPreOperational, now_us);
}

void Device::enter(NetworkState state, std::int64_t now_us) noexcept {
  const bool was_operational = allows_pdo(state_);
  state_ = state;
  if (!allows_sdo(state)) sdo_.reset();
  if (allows_pdo(state) == was_operational && allows_pdo(state)) return;
  has_rpdo_ = false;
  now_us_ = std::max(now_us_, now_us);
  for (int i = 0; i < kTpdoCount; ++i) restart_pdo(i);
  restart_fd();
}

void Device::restart_pdo(int index) noexcept {
  if (!allows_pdo(state_)) return tpdos_[index].stop();
  tpdos_[index].restart(parameters_.tpdos[index], now_us_);
  tpdos_[index].event();
}

void Device::restart_fd() noexcept {
  fd_bytes_ = fd_bytes(machine_.snapshot(master()), judgement_);
  looked_us_ = now_us_;
  if (!allows_pdo(state_)) return fd_pdo_.stop();
  fd_pdo_.restart(parameters_.fd, now_us_);
  fd_pdo_.event();
}

job::Outputs Device::process(std::int64_t now_us, const Inputs& inputs) noexcept {
  now_us_ = std::max(now_us_, now_us);
  job_ = {};
  was_run_ = false;
  pass_time();
  if (inputs.bus != nullptr) take_bus(*inputs.bus);
  if (inputs.frame != nullptr) take_frame(*inputs.frame);
  if (!was_run_) run({});
  look();
  return job_;
}

// The machine may be called more than once in a call: its newest order counts, as everywhere.
void Device::run(const job::Inputs& inputs) noexcept {
  const job::Outputs out = machine_.process(now_us_, inputs);
  was_run_ = true;
  job_.verdict = out.verdict;
  job_.next_us = out.next_us;
  if (out.order.kind != job::Order::Kind::kNone) job_.order = out.order;
}

void Device::hear() noexcept {
  const job::Request heard{{master(), 0}, false, {}, false, false};
  run({.request = &heard});
}

void Device::pass_time() noexcept {
  sdo_.pass_time(now_us_);
  if (!consumer_.take_loss(now_us_)) return;
  log_.raise(Fault::kMasterSilent);
  run({.lost_master = master()});
  if (allows_pdo(state_)) enter(NetworkState::kPreOperational, now_us_);
}

std::int64_t Device::next_us() const noexcept {
  std::int64_t next = std::min({producer_.next_us(), consumer_.next_us(), sdo_.next_us()});
  if (carries_fd_) next = std::min(next, fd_pdo_.next_us());
  for (const TransmitPdo& tpdo : tpdos_) next = std::min(next, tpdo.next_us());
  return next;
}

// --- what comes in

void Device::take_bus(const BusEvent& event) noexcept {
  carries_fd_ = event.carries_fd;
  if (event.has_lost_frames) log_.pulse(Fault::kFramesLost);
  if (event.state == BusState::kErrorPassive) {
    log_.raise(Fault::kErrorPassive);
  } else {
    log_.clear(Fault::kErrorPassive);
  }
  if (event.state == BusState::kOff && bus_ != BusState::kOff && allows_pdo(state_))
    enter(NetworkState::kPreOperational, now_us_);
  if (bus_ == BusState::kOff && event.state != BusState::kOff) log_.pulse(Fault::kBusWasOff);
  bus_ = event.state;
}

void Device::take_frame(const Frame& frame) noexcept {
  const bool is_classic = !frame.is_fd && frame.size <= kClassicBytesMax;
  if (!is_classic || frame.is_extended || frame.is_remote) return;
  if (frame.id == kNmtId) return take_network_command(frame);
  if (frame.id == kSyncId) return take_sync();
  if (frame.id == kRpdoBase + config_.node) return take_rpdo(frame);
  if (frame.id == kSdoRequestBase + config_.node) return take_sdo(frame);
  if (frame.id > kHeartbeatBase && frame.id <= kHeartbeatBase + kNodeMax)
    return take_heartbeat(frame);
}

void Device::take_network_command(const Frame& frame) noexcept {
  const bool is_ours = frame.size == 2 && (frame.data[1] == 0 || frame.data[1] == config_.node);
  if (!is_ours) return;
  switch (static_cast<NetworkCommand>(frame.data[0])) {
    case NetworkCommand::kStart: enter(NetworkState::kOperational, now_us_); break;
    case NetworkCommand::kStop: enter(NetworkState::kStopped, now_us_); break;
    case NetworkCommand::kEnterPreOperational: enter(NetworkState::kPreOperational, now_us_); break;
    case NetworkCommand::kResetNode:
      run({.lost_master = master()});
      boot(now_us_);
      return;
    case NetworkCommand::kResetCommunication: boot(now_us_); return;
    default: return;
  }
  hear();
}

void Device::take_sync() noexcept {
  if (!allows_pdo(state_)) return;
  if (has_rpdo_) {
    has_rpdo_ = false;
    take_command(rpdo_);
  }
  if (!was_run_) run({});
  look();
  for (TransmitPdo& tpdo : tpdos_) tpdo.sync();
  fd_pdo_.sync();
}

void Device::take_heartbeat(const Frame& frame) noexcept {
  const auto node = static_cast<std::uint8_t>(frame.id - kHeartbeatBase);
  if (node == config_.node) {
    has_twin_ = true;
    return log_.raise(Fault::kTwin);
  }
  const bool is_life = frame.size == 1 && (frame.data[0] & 0x7f) != 0;  // else it boots
  if (!is_life) return;
  consumer_.heard(node, now_us_);
  if (consumer_.is_watched(node)) log_.clear(Fault::kMasterSilent);
  if (node == config_.master || consumer_.is_watched(node)) hear();
}

void Device::take_rpdo(const Frame& frame) noexcept {
  if (!allows_pdo(state_) || !parameters_.rpdo_is_valid) return;
  if (frame.size < kClassicBytesMax) return log_.raise(Fault::kCommandShort);
  log_.clear(Fault::kCommandShort);
  if (!is_synchronous(parameters_.rpdo_type)) return take_command(frame);
  rpdo_ = frame;
  has_rpdo_ = true;
}

void Device::take_command(const Frame& frame) noexcept {
  const auto word = [&frame](std::size_t at) {
    return static_cast<std::uint16_t>(number_at(frame.data, at, 2));
  };
  const std::uint16_t number = word(0);
  const bool was_seen =
      number == spent_number_ || number == machine_.snapshot(master()).last_number;
  if (number == 0 || was_seen) return hear();
  job::CommandImage image = machine_.image_for({master(), 0});
  image.command_number = number;
  image.command_session = word(2);
  image.command = frame.data[4];
  image.pick_outcome = frame.data[5];
  const bool is_report = image.command == static_cast<std::uint16_t>(job::Command::kReportPick);
  (is_report ? image.pick_number : image.job) = word(6);
  spent_number_ = 0;
  const job::Verdict verdict = command(image, true, false);
  if (verdict == job::Verdict::kGranted) return;
  spent_number_ = number;
  judgement_ = {number, verdict == job::Verdict::kNotOwner ? job::Refusal::kNotOwner
                                                           : job::Refusal::kBadCommand};
}

job::Verdict Device::command(const job::CommandImage& image, bool touches_number,
                             bool touches_control) noexcept {
  const job::Request wish{{master(), 0}, true, image, touches_number, touches_control};
  run({.request = &wish});
  if (job_.verdict != job::Verdict::kGranted) return job_.verdict;
  const job::Snapshot seen = machine_.snapshot(master());
  const bool is_refused = seen.last_number != 0 && seen.refused_number == seen.last_number;
  judgement_ = {seen.last_number, is_refused ? seen.refused_status : job::Refusal::kNone};
  return job_.verdict;
}

void Device::take_sdo(const Frame& frame) noexcept {
  if (!allows_sdo(state_) || frame.size != kClassicBytesMax) return;
  hear();
  const SdoServer::Step step = sdo_.take(frame, now_us_);
  std::array<std::uint8_t, kObjectBytesMax> bytes{};
  std::size_t size = 0;
  Object object;
  Abort why = Abort::kNone;
  switch (step.kind) {
    case SdoServer::Step::Kind::kNone: return;
    case SdoServer::Step::Kind::kRead:
      why = read_object(step.index, step.subindex, bytes, size);
      if (why == Abort::kNone) return sdo_.give(std::span(bytes).first(size), now_us_);
      break;
    case SdoServer::Step::Kind::kProbe: why = may_write(step, object); break;
    case SdoServer::Step::Kind::kWrite:
      why = write_object(step);
      if (why == Abort::kNone) return sdo_.written();
      break;
  }
  if (why != Abort::kNone) sdo_.refuse(why);
}

// --- what goes out

// A result that has changed gets the next sequence number. Its pose frames are told if there is a
// pose, or to take the one before back.
void Device::look() noexcept {
  const job::Snapshot snapshot = machine_.snapshot(master());
  tell_fault(snapshot);
  Report fresh = report_of(snapshot, judgement_);
  const std::int32_t sequence = report_[ReportField::kSequence];
  fresh[ReportField::kSequence] = is_same_result(fresh, report_) ? sequence : (sequence + 1) & 0xff;
  look_at_fd(snapshot, fresh);
  if (fresh == report_) return;
  const bool is_new = fresh[ReportField::kSequence] != sequence;
  const bool concerns_pose = is_new && (has_pose(fresh) || has_pose(report_));
  report_ = fresh;
  tpdos_[0].event();
  for (int i = 1; i < kTpdoCount && concerns_pose; ++i) tpdos_[i].event();
}

// The FD frame tells more: what differs there alone is another result too.
void Device::look_at_fd(const job::Snapshot& snapshot, Report& fresh) noexcept {
  if (!parameters_.fd.is_valid) return;
  const FdBytes before = fd_bytes_;
  fd_bytes_ = fd_bytes(snapshot, judgement_);
  looked_us_ = now_us_;
  std::int32_t& sequence = fresh[ReportField::kSequence];
  const bool is_counted = sequence != report_[ReportField::kSequence];
  if (!is_counted && !is_same_result(fd_bytes_, before)) sequence = (sequence + 1) & 0xff;
  if (!(fresh == report_)) fd_pdo_.event();
}

void Device::tell_fault(const job::Snapshot& snapshot) noexcept {
  const bool is_at_fault =
      snapshot.done_number != 0 && (snapshot.bits & job::kError) != 0 && is_fault(snapshot.answer);
  if (!is_at_fault || told_fault_of_ != snapshot.done_number) log_.clear(Fault::kAnswer);
  told_fault_of_ = is_at_fault ? snapshot.done_number : std::uint16_t{0};
  if (!is_at_fault) return;
  const int status = static_cast<int>(snapshot.answer);
  const auto code = static_cast<std::uint16_t>(0xff00 - status);
  std::array<std::uint8_t, 5> detail{};
  put_number(detail, 0, 2, snapshot.done_number);
  detail[2] = static_cast<std::uint8_t>(status);
  log_.raise(Fault::kAnswer, code, detail);
}

// The time of sending may be later than that of what was last taken in, which stays as it is.
bool Device::next_frame(std::int64_t now_us, Frame& frame) noexcept {
  now_us = std::max(now_us_, now_us);
  frame = {};
  if (owes_boot_up_ || producer_.is_due(now_us)) {
    frame.id = kHeartbeatBase + config_.node;
    frame.size = 1;
    frame.data[0] = owes_boot_up_ ? std::uint8_t{0} : static_cast<std::uint8_t>(state_);
    if (!owes_boot_up_) producer_.sent(now_us);
    owes_boot_up_ = false;
    return true;
  }
  if (allows_emergency(state_) && log_.has_message()) {
    frame.fill(log_.take_message());
    frame.id = kEmergencyBase + config_.node;
    if (parameters_.emergency_is_valid) return true;
  }
  if (next_fd(now_us, frame)) return true;
  for (int i = 0; i < kTpdoCount && allows_pdo(state_); ++i) {
    if (!tpdos_[i].is_due(now_us)) continue;
    tpdos_[i].sent(now_us);
    frame.id = tpdo_id(i, config_.node);
    frame.fill(tpdo_bytes(report_, i));
    return true;
  }
  if (!allows_sdo(state_) || !sdo_.has_answer()) return false;
  frame.id = kSdoAnswerBase + config_.node;
  frame.fill(sdo_.take_answer());
  return true;
}

bool Device::next_fd(std::int64_t now_us, Frame& frame) noexcept {
  if (!allows_pdo(state_) || !carries_fd_ || !fd_pdo_.is_due(now_us)) return false;
  fd_pdo_.sent(now_us);
  FdBytes bytes = fd_bytes_;
  bytes[0] = static_cast<std::uint8_t>(report_[ReportField::kSequence]);
  grow_older(bytes, now_us - looked_us_);
  frame.id = parameters_.fd_id;
  frame.is_fd = true;
  frame.has_bit_rate_switch = config_.fd_bit_rate_switch;
  frame.fill(bytes);
  return true;
}

}  // namespace flatpose::can
