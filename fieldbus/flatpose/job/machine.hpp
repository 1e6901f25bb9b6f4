#pragma once
// The job machine: a master triggers, a search answers, and neither can be told anything twice, too
// late, or of another's doing. No socket, no clock, no thread: time and inputs come in, an order
// for the search and the time of the next call go out.
//
//   - A command_number that is not 0 and not the master's last is accepted or refused, then and
//     there, and used up either way. Both drop VALID and clear the result.
//   - An accepted number ends as done, exactly once: by the search, by cancel, by the end of the
//     owner's lease, or because answer_by passed.
//   - Each master's last number is remembered: written again it does nothing, whoever wrote
//     between. One before it is a new command again, so masters count upwards.
//
//                write, new number                 +--------------------------------------+
//     IDLE ------------------------------> judged -+ refused: refused_number, ERROR       |
//      ^  ^                                        | accepted: accepted_number, Order     |
//      |  | next, cancel, clear_error: done        v                                      |
//      |  +------------------------------------ BUSY --- a new number but cancel: refused-+
//      |                                         |
//      +-----------------------------------------+
//        finished | cancel | lease out | answer late: done_number, Answer
//
// Thread: one at a time. Every connection's requests go through one thread; what the search says
// comes as SearchEvent by a mailbox of the port's.

#include <cstdint>

#include "flatpose/job/order.hpp"
#include "flatpose/job/ownership.hpp"
#include "flatpose/job/result_board.hpp"
#include "flatpose/job/rules.hpp"
#include "flatpose/job/snapshot.hpp"

namespace flatpose::job {

/// One request of a master. A read has no write.
struct Request {
  Master master;
  bool is_write = false;
  CommandImage image;           ///< As it stands when all of the write is applied.
  bool touches_number = false;  ///< The request wrote command_number, changed or not.
  bool touches_control = false;
};

enum class Verdict : std::uint8_t {
  kGranted,
  kNotOwner,  ///< Nothing was applied: another master holds the lease, or this is what an old
              ///< connection held.
  kBadValue,  ///< Nothing was applied: this trigger is not the configured one.
};

/// At most one of each; null: none.
struct Inputs {
  Address lost_master = kNobody;   ///< Known to be gone: its lease, if it has it, ends now.
  const JobTable* jobs = nullptr;  ///< Validated; in force from now on.
  const SearchEvent* event = nullptr;
  const Request* request = nullptr;
};

struct Outputs {
  Verdict verdict = Verdict::kGranted;
  Order order;               ///< For the search; replaces every earlier one unless kNone.
  std::int64_t next_us = 0;  ///< Call again at this time at the latest.
};

class Machine {
 public:
  /// Fails: kInvalidArgument, kNotFinite (see validate).
  [[nodiscard]] Status init(const Config& config, const JobTable& jobs,
                            std::int64_t now_us) noexcept;

  /// Takes the inputs in, in the order of Inputs, after what time alone has brought about.
  /// Cost: microseconds.  Memory: none.  Fails: never; a clock that runs back stands still.
  Outputs process(std::int64_t now_us, const Inputs& inputs) noexcept;

  /// All that `reader` sees, at the time of the last process(): call that first.
  [[nodiscard]] Snapshot snapshot(Address reader) const noexcept;

  /// What a write of this master starts from: another's command, job and session are no defaults.
  [[nodiscard]] CommandImage image_for(const Master& master) const noexcept;

 private:
  struct Running {
    bool is_active = false;
    std::uint16_t number = 0;
    std::uint32_t ticket = 0;
    Command command = Command::kLocate;
    Address asker = kNobody;
    JobRule rule;
    std::int64_t accepted_us = 0;
    std::int64_t answer_by_us = 0;
  };

  void pass_time(std::int64_t now_us) noexcept;
  void take_event(const SearchEvent& event) noexcept;
  void take_life(const SearchEvent& event) noexcept;
  void take_finish(const ScanResult& result) noexcept;
  [[nodiscard]] Answer judged(const ScanResult& result) const noexcept;
  [[nodiscard]] Verdict take_write(const Request& request) noexcept;
  void take_control(const Request& request, MasterRecord& record) noexcept;
  void take_number(std::uint16_t number, const Master& master) noexcept;
  [[nodiscard]] Refusal judged(Command command) const noexcept;
  void refuse(std::uint16_t number, Refusal why) noexcept;
  void accept(std::uint16_t number, Command command, const Master& master) noexcept;
  void start(std::uint16_t number, Command command, const Master& master) noexcept;
  void end_running(Answer answer) noexcept;
  void answered(Answer answer) noexcept;
  [[nodiscard]] bool search_lives() const noexcept;
  [[nodiscard]] bool source_lives() const noexcept;
  [[nodiscard]] std::uint16_t bits() const noexcept;
  [[nodiscard]] std::int64_t next_us() const noexcept;

  Config config_;
  JobTable jobs_;
  std::int64_t started_us_ = 0;
  std::int64_t now_us_ = 0;
  Ownership ownership_;
  CommandImage image_;
  ResultBoard board_;
  Running running_;
  Order order_;  ///< Of this call.
  std::uint32_t last_ticket_ = 0;

  std::uint16_t accepted_number_ = 0;
  std::uint16_t refused_number_ = 0;
  Refusal refused_status_ = Refusal::kNone;
  std::uint16_t scanned_number_ = 0;
  std::uint16_t cancelled_number_ = 0;
  std::uint32_t answer_by_ms_ = 0;
  bool has_error_ = false;

  bool search_was_alive_ = false;
  bool source_was_alive_ = false;
  bool source_is_simulated_ = false;
  std::int64_t search_alive_us_ = 0;
  std::int64_t source_alive_us_ = 0;
  bool search_has_beaten_ = false;
  bool source_has_beaten_ = false;
  std::uint16_t heartbeat_ = 0;

  // handshake = "bits"
  bool trigger_was_low_ = false;  ///< Seen since start and since the owner changed.
  bool trigger_is_acked_ = false;
  bool result_is_unread_ = false;
};

}  // namespace flatpose::job
