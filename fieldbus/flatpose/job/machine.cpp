#include "flatpose/job/machine.hpp"

#include <algorithm>
#include <cmath>

namespace flatpose::job {
namespace {

constexpr JobRule kNoJob{.job = 0};

bool needs_job(Command command) noexcept {
  return command == Command::kLocate || command == Command::kCapture ||
         command == Command::kLocateInLast || command == Command::kVerifyAlignment;
}

bool needs_source(Command command) noexcept {
  return command == Command::kLocate || command == Command::kCapture ||
         command == Command::kVerifyAlignment;
}

bool needs_search(Command command) noexcept {
  return command != Command::kNext && command != Command::kCancel &&
         command != Command::kClearError;
}

bool makes_pose(Command command) noexcept {
  return command == Command::kLocate || command == Command::kLocateInLast;
}

bool leaves_scan(Command command) noexcept {
  return !needs_search(command) || command == Command::kSaveScan || command == Command::kReportPick;
}

bool is_finite(const FoundMatch& match) noexcept {
  const Vec3& p = match.frame_T_pick.position_mm;
  double sum = p.x + p.y + p.z + match.score + match.visible;
  for (const double m : match.frame_T_pick.rotation.m) sum += m;
  return std::isfinite(sum);
}

bool are_finite(const ScanResult& result) noexcept {
  for (int i = 0; i < result.match_count; ++i) {
    if (!is_finite(result.matches[i])) return false;
  }
  return true;
}

}  // namespace

Status Machine::init(const Config& config, const JobTable& jobs, std::int64_t now_us) noexcept {
  Status status = validate(config);
  if (status == Status::kOk) status = validate(jobs);
  if (status != Status::kOk) return status;
  *this = {};
  config_ = config;
  jobs_ = jobs;
  started_us_ = now_us_ = now_us;
  ownership_ = Ownership(config.lease_us);
  return Status::kOk;
}

Outputs Machine::process(std::int64_t now_us, const Inputs& inputs) noexcept {
  now_us_ = std::max(now_us_, now_us);
  order_ = {};
  Outputs out;
  pass_time(now_us_);
  if (inputs.lost_master != kNobody && ownership_.release(inputs.lost_master, now_us_))
    pass_time(now_us_);
  if (inputs.jobs != nullptr) jobs_ = *inputs.jobs;
  if (inputs.event != nullptr) take_event(*inputs.event);
  if (inputs.request != nullptr) {
    if (inputs.request->is_write) out.verdict = take_write(*inputs.request);
    ownership_.hear(inputs.request->master, now_us_);
  }
  out.order = order_;
  out.next_us = next_us();
  return out;
}

// --- time

void Machine::pass_time(std::int64_t now_us) noexcept {
  if (!running_.is_active) return;
  const std::int64_t lease_end_us = ownership_.held_until_us();
  const bool lease_is_out = now_us >= lease_end_us;
  const bool is_late = now_us >= running_.answer_by_us;
  if (is_late && (!lease_is_out || running_.answer_by_us <= lease_end_us)) {
    end_running(Answer::kAnswerLate);
  } else if (lease_is_out) {
    end_running(Answer::kCancelled);
  }
}

std::int64_t Machine::next_us() const noexcept {
  std::int64_t next = board_.expires_us(now_us_);
  if (running_.is_active) next = std::min(next, running_.answer_by_us);
  if (ownership_.is_held(now_us_)) next = std::min(next, ownership_.held_until_us());
  if (search_lives()) next = std::min(next, search_alive_us_ + config_.liveness_limit_us);
  if (source_lives()) next = std::min(next, source_alive_us_ + config_.liveness_limit_us);
  return next;
}

// --- the search

bool Machine::search_lives() const noexcept {
  return search_was_alive_ && now_us_ - search_alive_us_ < config_.liveness_limit_us;
}

bool Machine::source_lives() const noexcept {
  return source_was_alive_ && now_us_ - source_alive_us_ < config_.liveness_limit_us;
}

void Machine::take_event(const SearchEvent& event) noexcept {
  take_life(event);
  // What bears another ticket was cancelled, or is of a life before: nobody's.
  if (!running_.is_active || event.ticket != running_.ticket) return;
  if (event.kind == SearchEvent::Kind::kScanned) scanned_number_ = running_.number;
  if (event.kind == SearchEvent::Kind::kFinished) take_finish(event.result);
}

void Machine::take_life(const SearchEvent& event) noexcept {
  if (event.kind == SearchEvent::Kind::kSourceGone) {
    source_was_alive_ = source_has_beaten_ = false;
    return;
  }
  if (event.kind == SearchEvent::Kind::kSourceAlive) {
    source_is_simulated_ = event.result.is_simulated;
  }
  if (event.kind == SearchEvent::Kind::kSourceAlive || event.kind == SearchEvent::Kind::kScanned) {
    source_was_alive_ = source_has_beaten_ = true;
    source_alive_us_ = now_us_;
  } else {
    search_was_alive_ = search_has_beaten_ = true;
    search_alive_us_ = now_us_;
  }
  if (!search_has_beaten_ || !source_has_beaten_) return;
  search_has_beaten_ = source_has_beaten_ = false;
  ++heartbeat_;
}

// The result is held against what was asked: a pose of an old scan, in another frame or of no
// number is none.
Answer Machine::judged(const ScanResult& result) const noexcept {
  if (!may_have_pose(result.answer)) return result.answer;
  if (needs_source(running_.command)) {
    if (!result.has_scan || result.acquired_us < running_.accepted_us) return Answer::kNoScan;
  }
  if (!makes_pose(running_.command)) return result.answer;
  const bool is_sound = result.has_scan && result.match_count > 0 &&
                        result.match_count <= kMatchesPerScanMax &&
                        result.frame == running_.rule.frame && are_finite(result);
  if (!is_sound) return Answer::kInternal;
  return result.is_simulated && !config_.allow_simulated ? Answer::kSimulated : result.answer;
}

void Machine::take_finish(const ScanResult& result) noexcept {
  ScanResult kept = result;
  kept.answer = judged(result);
  if (!makes_pose(running_.command)) kept.match_count = 0;
  if (leaves_scan(running_.command)) {
    board_.post(running_.number, running_.asker, running_.rule, kept.answer);
  } else {
    board_.post_scan(running_.number, running_.asker, running_.rule, kept);
  }
  running_.is_active = false;
  answered(kept.answer);
}

void Machine::end_running(Answer answer) noexcept {
  board_.post(running_.number, running_.asker, running_.rule, answer);
  running_.is_active = false;
  order_ = {};
  order_.kind = Order::Kind::kStop;
  order_.ticket = ++last_ticket_;
  answered(answer);
}

void Machine::answered(Answer answer) noexcept {
  has_error_ = has_error_ || is_fault(answer);
  result_is_unread_ = config_.handshake == Handshake::kBits;
}

// --- the masters

CommandImage Machine::image_for(const Master& master) const noexcept {
  return ownership_.is_change(master) ? CommandImage{} : image_;
}

Verdict Machine::take_write(const Request& request) noexcept {
  if (!ownership_.may_write(request.master, now_us_)) return Verdict::kNotOwner;
  const bool by_bits = config_.handshake == Handshake::kBits;
  const bool has_number = request.touches_number && request.image.command_number != 0;
  const bool has_control = request.touches_control && request.image.control != 0;
  if (by_bits ? has_number : has_control) return Verdict::kBadValue;

  if (ownership_.is_change(request.master)) {  // nothing of another's is left to be misread
    board_.clear();
    board_.forget_scan();
    accepted_number_ = refused_number_ = scanned_number_ = cancelled_number_ = 0;
    refused_status_ = Refusal::kNone;
    trigger_was_low_ = trigger_is_acked_ = result_is_unread_ = false;
  }
  MasterRecord& record = ownership_.take(request.master, now_us_);
  image_ = request.image;
  if (by_bits) {
    if (request.touches_control) take_control(request, record);
  } else if (has_number && request.image.command_number != record.last_number) {
    record.last_number = request.image.command_number;
    take_number(request.image.command_number, request.master);
  }
  return Verdict::kGranted;
}

// Four phases: TRIGGER up, ACK up, TRIGGER down, ACK down; then DONE up, RESULT_READ up, DONE down.
void Machine::take_control(const Request& request, MasterRecord& record) noexcept {
  const bool trigger = (request.image.control & kTrigger) != 0;
  if ((request.image.control & kResultRead) != 0) result_is_unread_ = false;
  if (trigger && trigger_was_low_) {
    if (++record.last_number == 0) record.last_number = 1;
    take_number(record.last_number, request.master);
    trigger_is_acked_ = refused_number_ != record.last_number;
  }
  if (!trigger) trigger_is_acked_ = false;
  trigger_was_low_ = !trigger;
}

void Machine::take_number(std::uint16_t number, const Master& master) noexcept {
  const auto command = static_cast<Command>(image_.command);
  const Refusal why = judged(command);
  if (why != Refusal::kNone) {
    refuse(number, why);
  } else {
    accept(number, command, master);
  }
}

Refusal Machine::judged(Command command) const noexcept {
  const bool has_session = image_.command_session != 0;
  if (has_session && image_.command_session != config_.session_id) return Refusal::kStaleSession;
  if (!is_command(image_.command)) return Refusal::kBadCommand;
  if (command == Command::kReportPick && !is_pick_outcome(image_.pick_outcome))
    return Refusal::kBadCommand;
  if (running_.is_active && command != Command::kCancel) return Refusal::kBusy;
  if (needs_job(command) && jobs_.find(image_.job) == nullptr) return Refusal::kBadJob;
  if (needs_search(command) && !search_lives()) return Refusal::kNotReady;
  if (needs_source(command) && !source_lives()) return Refusal::kNotReady;
  return Refusal::kNone;
}

void Machine::refuse(std::uint16_t number, Refusal why) noexcept {
  refused_number_ = number;
  refused_status_ = why;
  has_error_ = true;
  if (!running_.is_active) board_.clear();
}

void Machine::accept(std::uint16_t number, Command command, const Master& master) noexcept {
  accepted_number_ = number;
  refused_number_ = 0;
  refused_status_ = Refusal::kNone;
  scanned_number_ = 0;
  has_error_ = false;
  result_is_unread_ = false;
  if (command == Command::kCancel && running_.is_active) {
    cancelled_number_ = running_.number;
    end_running(Answer::kCancelled);
  }
  board_.clear();
  if (!leaves_scan(command)) board_.forget_scan();
  if (needs_search(command)) {
    start(number, command, master);
  } else if (command == Command::kNext) {
    answered(board_.post_next(number, master.address));
  } else {
    board_.post(number, master.address, kNoJob, Answer::kOk);
    answered(Answer::kOk);
  }
}

void Machine::start(std::uint16_t number, Command command, const Master& master) noexcept {
  const JobRule* rule = needs_job(command) ? jobs_.find(image_.job) : nullptr;
  running_ = {true, number, ++last_ticket_, command, master.address, {}, now_us_, 0};
  running_.rule = rule != nullptr ? *rule : kNoJob;
  running_.answer_by_us = now_us_ + running_.rule.answer_by_us;
  answer_by_ms_ = static_cast<std::uint32_t>((running_.rule.answer_by_us + 999) / 1000);
  order_ = {Order::Kind::kStart,
            running_.ticket,
            command,
            number,
            running_.rule.job,
            image_.pick_number,
            image_.pick_outcome,
            now_us_,
            running_.answer_by_us};
}

// --- what is seen

std::uint16_t Machine::bits() const noexcept {
  const bool by_bits = config_.handshake == Handshake::kBits;
  const bool lives = search_lives() && source_lives();
  const bool trigger_is_up = by_bits && (image_.control & kTrigger) != 0;
  const bool is_acked = by_bits ? trigger_is_acked_ : accepted_number_ != 0 && refused_number_ == 0;
  const bool is_done = board_.number() != 0 && (!by_bits || result_is_unread_);
  unsigned bits = 0;
  if (lives && !running_.is_active && !result_is_unread_ && !trigger_is_up) bits |= kReady;
  if (is_acked) bits |= kAck;
  if (running_.is_active) bits |= kBusy;
  if (is_done) bits |= kDone;
  if (board_.is_valid(now_us_)) bits |= kValid;
  if (has_error_) bits |= kError;
  if (board_.is_simulated() || source_is_simulated_) bits |= kSimulated;
  if (board_.is_repeated()) bits |= kScanRepeated;
  return static_cast<std::uint16_t>(bits);
}

Snapshot Machine::snapshot(Address reader) const noexcept {
  Snapshot s;
  s.image = image_;
  s.bits = bits();
  board_.show(now_us_, reader, s);
  s.accepted_number = accepted_number_;
  s.refused_number = refused_number_;
  s.refused_status = refused_status_;
  s.scanned_number = scanned_number_;
  s.cancelled_number = cancelled_number_;
  s.last_number = ownership_.last_number(reader);
  s.session_id = config_.session_id;
  s.boot_count = config_.boot_count;
  s.heartbeat = heartbeat_;
  s.uptime_s = static_cast<std::uint32_t>((now_us_ - started_us_) / 1'000'000);
  s.owner_address = ownership_.holder(now_us_);
  s.reader_is_owner = reader != kNobody && s.owner_address == reader;
  s.answer_by_ms = answer_by_ms_;
  return s;
}

}  // namespace flatpose::job
