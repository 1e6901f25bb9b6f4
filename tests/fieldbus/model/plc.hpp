#pragma once
// A PLC that does as the documentation tells it to, and as FB_Flatpose does:
//   claim:  on every new connection first write command_number 0 (nothing of an older one comes
//           after that), then read: session_id, last_number.
//   ask:    a number that is not last_number, with session, command and job, in one write.
//   poll:   read the whole block; the answer is there when done_number is the number, at head and
//           tail, result_is_readers is 1 and the session is the one asked in.
// Sends again, with the same number, what it cannot know to have arrived.

#include <functional>
#include <optional>

#include "tests/fieldbus/model/judge.hpp"
#include "tests/fieldbus/model/wire.hpp"

namespace flatpose::model {

class Plc {
 public:
  Plc(std::uint32_t address, Judge& judge) : address_(address), judge_(judge) {}

  std::uint32_t address() const { return address_; }
  Use* use(int id) { return id > 0 ? &uses_[static_cast<std::size_t>(id - 1)] : nullptr; }
  int answer_count() const { return answer_count_; }
  bool is_idle() const { return state_ == State::kIdle; }

  /// Forgets all; its address stays.
  void restart() {
    hang_up();
    give_up();
    state_ = State::kClaim;
    session_ = last_number_ = 0;
  }

  /// The server has seen a claim: what was given up before it must not be executed any more.
  void on_claim_served(const Message& claimed) {
    for (const int id : claimed.given_up) {
      use(id)->is_given_up = true;
      given_up_.erase(id);
    }
  }

  /// One cycle. `connect` gives a new connection.
  void tick(std::int64_t now_us, Random& random, bool is_eager,
            const std::function<Connection*()>& connect) {
    if (line_ == nullptr) {
      line_ = connect();
      claim(now_us);
    } else if (!line_->to_plc.empty()) {
      const Reply reply = line_->to_plc.front();
      line_->to_plc.pop_front();
      take(reply, now_us, random);
    } else if (waits_for_reply_ && now_us - sent_us_ > kReplyTimeout_us) {
      hang_up();
    } else if (!waits_for_reply_) {
      go_on(now_us, random, is_eager);
    }
  }

  /// The line is gone, noticed or not.
  void hang_up() {
    if (line_ != nullptr) line_->is_broken = true;
    line_ = nullptr;
    waits_for_reply_ = false;
  }

 private:
  enum class State { kClaim, kLookRound, kIdle, kAsk, kPoll };
  static constexpr std::int64_t kReplyTimeout_us = 400'000;

  void send(const Message& message, std::int64_t now_us) {
    line_->to_server.push_back(message);
    waits_for_reply_ = true;
    sent_us_ = now_us;
  }
  void claim(std::int64_t now_us) {
    state_ = State::kClaim;
    send({Words{0, 0, 1, 1}, 0, {given_up_.begin(), given_up_.end()}}, now_us);
  }
  void ask(std::int64_t now_us) {
    const Use& u = *use(current_);
    state_ = State::kAsk;
    send({Words{u.number, session_, u.command, u.job}, current_, {}}, now_us);
  }
  // Some exchange all their outputs in every cycle, changed or not.
  bool is_cyclic(Random& random, bool is_eager) const {
    return !is_eager && !uses_.empty() && uses_.back().number == last_number_ && random.one_in(4);
  }
  void ask_again(int id, std::int64_t now_us) {
    const Use& u = *use(id);
    send({Words{u.number, session_, u.command, u.job}, id, {}}, now_us);
  }
  void give_up() {
    if (current_ > 0) given_up_.insert(current_);
    current_ = 0;
  }

  void go_on(std::int64_t now_us, Random& random, bool is_eager) {
    if (state_ == State::kClaim) {
      if (now_us - sent_us_ > 500'000) claim(now_us);
    } else if (state_ == State::kIdle && is_cyclic(random, is_eager)) {
      ask_again(static_cast<int>(uses_.size()), now_us);
    } else if (state_ == State::kPoll && is_cyclic(random, is_eager)) {
      ask_again(current_, now_us);
    } else if (state_ != State::kIdle) {
      send({}, now_us);
    } else if (is_eager || random.one_in(3)) {
      start_new(now_us, random, is_eager);
    }
  }

  void start_new(std::int64_t now_us, Random& random, bool is_eager) {
    static constexpr std::uint16_t kMix[] = {1, 1, 1, 1, 1, 2, 2, 3, 4, 5, 6, 9, 12};
    const auto command = is_eager ? std::uint16_t{1} : kMix[random.below(13)];
    const auto job = static_cast<std::uint16_t>(1 + random.below(is_eager ? 2 : 3));
    begin(command, job, now_us);
  }

  void begin(std::uint16_t command, std::uint16_t job, std::int64_t now_us) {
    if (++last_number_ == 0) last_number_ = 1;
    uses_.push_back({.number = last_number_, .command = command, .job = job, .sent_us = now_us});
    current_ = static_cast<int>(uses_.size());
    ask(now_us);
  }

  void take(const Reply& reply, std::int64_t now_us, Random& random) {
    waits_for_reply_ = false;
    if (reply.is_refused) {  // the lease is another's, and so is what is seen
      give_up();
      state_ = State::kClaim;
      return;
    }
    switch (state_) {
      case State::kClaim: state_ = State::kLookRound; break;
      case State::kAsk: state_ = State::kPoll; break;
      case State::kLookRound: look_round(reply.block, now_us); break;
      case State::kPoll: poll(reply.block, now_us, random); break;
      case State::kIdle: break;
    }
  }

  // After a new connection: what became of the command under way?
  void look_round(const Block& b, std::int64_t now_us) {
    const bool is_same_session = session_id(b) == session_;
    session_ = session_id(b);
    if (!is_same_session) give_up();
    if (current_ == 0) {
      last_number_ = last_number(b);
      state_ = State::kIdle;
    } else if (last_number(b) != use(current_)->number) {
      ask(now_us);  // never arrived
    } else {
      state_ = State::kPoll;
    }
  }

  void poll(const Block& b, std::int64_t now_us, Random& random) {
    Use& u = *use(current_);
    const bool is_same_session = session_id(b) == session_;
    const bool is_answer = is_same_session && done_number(b) == u.number &&
                           done_number_tail(b) == u.number && result_is_readers(b) == 1;
    if (is_answer) {
      judge_.on_answer(u, b);
      if (has_pose(b)) ++answer_count_;
      current_ = 0;
      state_ = State::kIdle;
    } else if (is_same_session && refused_number(b) == u.number && reader_is_owner(b) == 1) {
      judge_.on_refusal(u);
      current_ = 0;
      state_ = State::kIdle;
    } else if (!is_same_session || accepted_number(b) != u.number || reader_is_owner(b) == 0) {
      give_up();  // restarted, or another's lease came between
      state_ = State::kClaim;
    } else if (random.one_in(12)) {
      cancel(now_us);
    }
  }

  void cancel(std::int64_t now_us) {
    // Not given up: it was seen, and whether it was started is what the cancel is about.
    begin(5, 1, now_us);
  }

  std::uint32_t address_;
  Judge& judge_;
  std::deque<Use> uses_;
  std::set<int> given_up_;  ///< Not yet claimed over.
  State state_ = State::kClaim;
  Connection* line_ = nullptr;
  bool waits_for_reply_ = false;
  std::int64_t sent_us_ = 0;
  std::uint16_t session_ = 0;
  std::uint16_t last_number_ = 0;
  int current_ = 0;  ///< 0: no command under way.
  int answer_count_ = 0;
};

}  // namespace flatpose::model
