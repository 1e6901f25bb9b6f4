#pragma once
// Two PLCs, a machine, a search and a camera, and all that may go wrong between them. One step is
// one thing that happens to one of them; which, the seed decides.

#include <memory>
#include <vector>

#include "flatpose/job/machine.hpp"
#include "flatpose/result_map/registers.hpp"
#include "tests/fieldbus/model/plc.hpp"

namespace flatpose::model {

class World {
 public:
  explicit World(std::uint64_t seed) : random_(seed) { start_server(); }

  [[nodiscard]] const Judge& judge() const { return judge_; }
  [[nodiscard]] int answer_count() const {
    return plcs_[0].answer_count() + plcs_[1].answer_count();
  }
  [[nodiscard]] int start_count() const { return start_count_; }
  [[nodiscard]] int server_starts() const { return server_starts_; }

  void step() {
    pass(random_.below(10'000));
    if (!is_calm_) misfortune();
    live();
    const int what = random_.below(10);
    if (what < 4) {
      const int who = random_.below(2);
      if (now_us_ >= silent_until_us_[who]) tick(who);
    } else if (what < 7) {
      serve_someone();
    } else if (what < 9) {
      search();
    } else if (!told_.empty()) {
      const job::SearchEvent event = told_.front();
      told_.pop_front();
      process({.event = &event});
    }
  }

  /// All goes well for one PLC, and the other keeps silent: it must get a pose.
  void calm_for(int who) {
    constexpr int kPatience_steps = 16000;
    is_calm_ = true;
    silent_until_us_[who] = hung_until_us_ = now_us_;
    silent_until_us_[1 - who] = now_us_ + 3600 * kSecond_us;
    const int before = plcs_[who].answer_count();
    int steps = 0;
    while (plcs_[who].answer_count() == before && steps < kPatience_steps) {
      step();
      ++steps;
    }
    if (steps == kPatience_steps) judge_.on_dead_end("all is well and there is no pose");
    silent_until_us_[1 - who] = now_us_;
    is_calm_ = false;
  }

 private:
  static constexpr std::int64_t kSecond_us = 1'000'000;
  static constexpr std::int64_t kMaxAge_us = 3 * kSecond_us;
  static constexpr std::int64_t kAnswerBy_us = 2 * kSecond_us;

  void start_server() {
    ++server_starts_;
    session_ = static_cast<std::uint16_t>(session_ % 65000 + 1 + random_.below(500));
    job::JobTable jobs;
    jobs.count = 2;
    for (std::uint16_t i = 0; i < 2; ++i)
      jobs.rules[i] = {.job = static_cast<std::uint16_t>(i + 1),
                       .max_age_us = kMaxAge_us,
                       .answer_by_us = kAnswerBy_us};
    const Status status = machine_.init({.session_id = session_}, jobs, now_us_);
    if (status != Status::kOk) judge_.on_dead_end("the machine does not start");
    for (auto& connection : connections_) connection->is_broken = true;
    for (Plc& plc : plcs_) plc.hang_up();
    connections_.clear();
    order_ = working_ = {};
    told_.clear();
    taken_ticket_ = 0;
    alive_us_ = -kSecond_us;
    process({});
  }

  job::Outputs process(const job::Inputs& inputs) {
    const job::Outputs out = machine_.process(now_us_, inputs);
    next_us_ = out.next_us;
    if (out.order.kind != job::Order::Kind::kNone) order_ = out.order;
    if (out.order.kind == job::Order::Kind::kStart) {
      ++start_count_;
      started_us_ = now_us_;
    }
    return out;
  }

  void pass(std::int64_t us) {
    const std::int64_t until_us = now_us_ + us;
    while (next_us_ <= until_us) {
      now_us_ = std::max(now_us_, next_us_);
      process({});
      if (next_us_ > now_us_) continue;
      judge_.on_dead_end("wants to be called again and again");
      break;
    }
    now_us_ = until_us;
  }

  void misfortune() {
    if (random_.one_in(150)) plcs_[random_.below(2)].hang_up();
    if (random_.one_in(1500)) plcs_[random_.below(2)].restart();
    if (random_.one_in(6000)) start_server();
    if (random_.one_in(6000))
      silent_until_us_[random_.below(2)] = now_us_ + random_.below(12) * kSecond_us;
    if (random_.one_in(5000)) hung_until_us_ = now_us_ + random_.below(8) * kSecond_us;
    if (random_.one_in(5000)) lose_source();
  }

  // The camera's driver dies, whatever is going on; it comes back when the next sign of life does.
  void lose_source() {
    const job::SearchEvent event{job::SearchEvent::Kind::kSourceGone, 0, {}};
    process({.event = &event});
  }

  void live() {
    const bool is_due = now_us_ >= alive_us_ + kSecond_us / 2 && now_us_ >= hung_until_us_;
    if (!is_due) return;
    alive_us_ = now_us_;
    for (const auto kind :
         {job::SearchEvent::Kind::kSearchAlive, job::SearchEvent::Kind::kSourceAlive}) {
      const job::SearchEvent event{kind, 0, {}};
      process({.event = &event});
    }
  }

  void tick(int who) {
    plcs_[who].tick(now_us_, random_, is_calm_, [this, who] {
      connections_.push_back(std::make_unique<Connection>());
      connections_.back()->serial = ++last_serial_;
      connections_.back()->address = plcs_[who].address();
      return connections_.back().get();
    });
  }

  // What a broken line still holds comes later, or never.
  void serve_someone() {
    if (connections_.empty()) return;
    const auto i = static_cast<std::size_t>(random_.below(static_cast<int>(connections_.size())));
    Connection& line = *connections_[i];
    const bool is_lost = line.is_broken && random_.one_in(3);
    if (line.is_broken && (line.to_server.empty() || is_lost)) {
      connections_.erase(connections_.begin() + static_cast<std::ptrdiff_t>(i));
    } else if (!line.to_server.empty()) {
      const Message message = line.to_server.front();
      line.to_server.pop_front();
      serve(message, line);
    }
  }

  void serve(const Message& message, Connection& line) {
    Plc& plc = plcs_[line.address == plcs_[0].address() ? 0 : 1];
    job::Request request{{line.address, line.serial}, message.write.has_value(), {}, true, false};
    if (message.write) {
      request.image = machine_.image_for(request.master);
      result_map::write_registers(request.image, 0, *message.write);
    }
    const job::Outputs out = process({.request = &request});
    Reply reply{message.write.has_value(), out.verdict != job::Verdict::kGranted, {}, now_us_};
    if (message.write) {
      if (out.order.kind == job::Order::Kind::kStart) note_start(plc, message);
      if (!reply.is_refused && message.use == 0) plc.on_claim_served(message);
    } else {
      result_map::read_registers(machine_.snapshot(line.address), {}, result_map::kResultAddress,
                                 reply.block);
      judge_.on_block(reply.block, now_us_, kMaxAge_us);
      const bool is_busy = (bits(reply.block) & kBusyBit) != 0;
      if (is_busy && now_us_ > started_us_ + kLongest_us) judge_.on_dead_end("BUSY for ever");
    }
    line.to_plc.push_back(reply);
  }

  void note_start(Plc& plc, const Message& message) {
    if (message.use == 0) {
      judge_.on_dead_end("started by a claim");
    } else {
      judge_.on_start(*plc.use(message.use));
    }
  }

  // The search thread: takes the newest order, captures, searches; notices a newer order late.
  void search() {
    if (now_us_ < hung_until_us_ || now_us_ < slow_until_us_) return;
    const bool is_working = working_.kind == job::Order::Kind::kStart;
    if (!is_working) {
      if (order_.ticket == taken_ticket_) return;
      taken_ticket_ = order_.ticket;
      working_ = order_;
      has_captured_ = false;
      if (random_.one_in(4)) slow_until_us_ = now_us_ + 10'000 * random_.below(100);
    } else if (order_.ticket != working_.ticket && random_.one_in(4)) {
      working_ = {};
    } else if (!has_captured_ && needs_scan(working_.command)) {
      has_captured_ = true;
      if (!is_calm_ && random_.one_in(20)) return;  // the camera gives the scan it gave before
      last_acquired_us_ = now_us_;
      judge_.on_scan(++last_scan_, now_us_);
      told_.push_back({job::SearchEvent::Kind::kScanned, working_.ticket, {}});
    } else if (random_.one_in(3)) {
      told_.push_back({job::SearchEvent::Kind::kFinished, working_.ticket, result_of(working_)});
      working_ = {};
    }
  }

  static bool needs_scan(job::Command command) {
    return command == job::Command::kLocate || command == job::Command::kCapture ||
           command == job::Command::kVerifyAlignment;
  }

  job::ScanResult result_of(const job::Order& order) {
    job::ScanResult result;
    result.answer = job::Answer::kOk;
    if (!is_calm_ && random_.one_in(4)) result.answer = static_cast<job::Answer>(-random_.below(7));
    result.has_scan = last_scan_ > 0;
    result.scan_number = last_scan_;
    result.acquired_us = last_acquired_us_;
    result.match_count = 1 + random_.below(12);
    for (int i = 0; i < result.match_count; ++i) {
      result.matches[i].frame_T_pick.position_mm = {0.001 * Judge::x_of(last_scan_, i + 1),
                                                    0.001 * Judge::y_of(last_scan_),
                                                    0.001 * order.job};
    }
    return result;
  }

  static constexpr std::int64_t kLongest_us = 10 * kSecond_us + 1;  ///< Of a command without job.

  Random random_;
  Judge judge_;
  std::array<Plc, 2> plcs_{Plc{0xc0000201, judge_}, Plc{0xc0000202, judge_}};
  std::array<std::int64_t, 2> silent_until_us_{};
  std::vector<std::unique_ptr<Connection>> connections_;
  std::uint64_t last_serial_ = 0;

  job::Machine machine_;
  std::uint16_t session_ = 0;
  std::int64_t now_us_ = 1000 * kSecond_us;
  std::int64_t next_us_ = 0;
  std::int64_t alive_us_ = 0;
  bool is_calm_ = false;
  int start_count_ = 0;
  int server_starts_ = 0;
  std::int64_t started_us_ = 0;

  job::Order order_;    ///< What stands in the mailbox.
  job::Order working_;  ///< What the thread is at.
  std::uint32_t taken_ticket_ = 0;
  bool has_captured_ = false;
  std::uint32_t last_scan_ = 0;
  std::int64_t last_acquired_us_ = 0;
  std::int64_t hung_until_us_ = 0;
  std::int64_t slow_until_us_ = 0;
  std::deque<job::SearchEvent> told_;
};

}  // namespace flatpose::model
