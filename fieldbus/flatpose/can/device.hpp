#pragma once
// flatpose as a CANopen node (CiA 301) with the job machine behind it. No socket, no clock: frames
// and time come in, frames and the time of the next call go out.
//
//   pass_on(device.process(now, {.frame = &frame}));   a frame of the bus, or time alone
//   while (...room... && device.next_frame(now, frame)) send(frame);
//   wait until device.next_us()
//
// Nothing waits in a queue: what is to be sent is made when it is asked for, so a bus that was
// blocked gets the newest state, not a history of it. Call process() also after the machine was
// called by others: it looks at the machine anew each time.
//
//   NMT         boot-up, start, stop, pre-operational, reset node and communication
//   SDO         the whole dictionary, expedited and segmented
//   RPDO1       a command in eight bytes; a new command_number triggers, as everywhere
//   TPDO1..4    state and result (report.hpp), at events or with SYNC
//   FD frame    the whole result in one (fd_report.hpp), as the TPDOs and before them; off at start
//               unless the config says otherwise, for a classic controller on the bus answers FD
//               frames with error frames. What FD frames others send is none of a node's.
//   EMCY        see emergency.hpp
//   heartbeat   our own; the master's, whose loss cancels what it asked for; and one that bears our
//               number and is another node's, for a link does not give back what it was given
//
// RPDO1: command_number (2 bytes), command_session (2), command (1), pick_outcome (1), argument
// (2): the job, or with report_pick the pick_number. A number that is 0 or the master's last only
// shows that the master lives, and the last may have been refused, also because another master
// holds the lease. An older number is a command again: count upwards.
//
// The master is an owner like any host (job/ownership.hpp), by its node id. Any command, SDO
// request, NMT command but a reset, or heartbeat of its renews the lease.
//
// Thread: the machine's.  Memory: some 4 kB, none of it allocated.

#include <array>
#include <cstdint>
#include <span>

#include "flatpose/can/config.hpp"
#include "flatpose/can/dictionary.hpp"
#include "flatpose/can/emergency.hpp"
#include "flatpose/can/fd_report.hpp"
#include "flatpose/can/frame.hpp"
#include "flatpose/can/heartbeat.hpp"
#include "flatpose/can/network_state.hpp"
#include "flatpose/can/parameters.hpp"
#include "flatpose/can/report.hpp"
#include "flatpose/can/sdo_server.hpp"
#include "flatpose/can/transmit_pdo.hpp"
#include "flatpose/job/machine.hpp"

namespace flatpose::can {

/// The controller's own state, as the link learns it.
enum class BusState : std::uint8_t { kActive, kErrorPassive, kOff };

struct BusEvent {
  BusState state = BusState::kActive;
  bool has_lost_frames = false;  ///< Frames came that could not be read.
  bool carries_fd = false;       ///< The link can send FD frames.
};

/// At most one of each; null: none.
struct Inputs {
  const BusEvent* bus = nullptr;
  const Frame* frame = nullptr;
};

class Device {
 public:
  /// Refers to the machine, which must outlive it.
  explicit Device(job::Machine& machine) noexcept : machine_(machine) {}

  /// Boots: the first frame to send is the boot-up message.  Texts in the config must outlive it.
  /// Fails: kInvalidArgument.
  [[nodiscard]] Status init(const Config& config, std::int64_t now_us) noexcept;

  /// Returns what the machine said: an order for the search, and when it wants to be called.
  /// Cost: microseconds.  Fails: never; what no node would answer is passed over.
  job::Outputs process(std::int64_t now_us, const Inputs& inputs) noexcept;

  /// The next frame that may go out now, in the order of their weight.  Returns whether there is
  /// one. Do not ask while the bus is off.
  [[nodiscard]] bool next_frame(std::int64_t now_us, Frame& frame) noexcept;

  /// The FD frame that next_frame() gave found no room: it is made anew, of then.
  void take_back_fd() noexcept { fd_pdo_.not_sent(); }

  /// Call process(), then next_frame(), at this time at the latest.
  [[nodiscard]] std::int64_t next_us() const noexcept;

  [[nodiscard]] NetworkState state() const noexcept { return state_; }
  [[nodiscard]] const Config& config() const noexcept { return config_; }
  [[nodiscard]] std::uint8_t error_register() const noexcept { return log_.error_register(); }
  /// Whether another node's heartbeat or boot-up bore this node's number, since init().
  [[nodiscard]] bool has_twin() const noexcept { return has_twin_; }

 private:
  void boot(std::int64_t now_us) noexcept;
  void enter(NetworkState state, std::int64_t now_us) noexcept;
  void pass_time() noexcept;
  void take_bus(const BusEvent& event) noexcept;
  void take_frame(const Frame& frame) noexcept;
  void take_network_command(const Frame& frame) noexcept;
  void take_sync() noexcept;
  void take_heartbeat(const Frame& frame) noexcept;
  void take_rpdo(const Frame& frame) noexcept;
  void take_command(const Frame& frame) noexcept;
  void take_sdo(const Frame& frame) noexcept;

  void run(const job::Inputs& inputs) noexcept;
  void hear() noexcept;
  [[nodiscard]] job::Verdict command(const job::CommandImage& image, bool touches_number,
                                     bool touches_control) noexcept;
  void look() noexcept;
  void look_at_fd(const job::Snapshot& snapshot, Report& fresh) noexcept;
  void restart_pdo(int index) noexcept;
  void restart_fd() noexcept;
  [[nodiscard]] bool next_fd(std::int64_t now_us, Frame& frame) noexcept;
  void tell_fault(const job::Snapshot& snapshot) noexcept;
  [[nodiscard]] job::Address master() const noexcept { return config_.master; }

  // objects.cpp
  [[nodiscard]] Abort read_object(std::uint16_t index, std::uint8_t subindex,
                                  std::span<std::uint8_t, kObjectBytesMax> bytes,
                                  std::size_t& size) const noexcept;
  [[nodiscard]] const char* text_of(std::uint16_t index) const noexcept;
  [[nodiscard]] std::uint32_t number_of(const Object& object) const noexcept;
  [[nodiscard]] std::size_t whole_result(std::span<std::uint8_t> bytes) const noexcept;
  [[nodiscard]] Abort may_write(const SdoServer::Step& step, Object& object) const noexcept;
  [[nodiscard]] Abort write_object(const SdoServer::Step& step) noexcept;
  [[nodiscard]] Abort write_command(const Object& object,
                                    std::span<const std::uint8_t> bytes) noexcept;

  job::Machine& machine_;
  Config config_;
  std::int64_t now_us_ = 0;
  job::Outputs job_;      ///< Of this call.
  bool was_run_ = false;  ///< Whether the machine was called in this call.

  NetworkState state_ = NetworkState::kPreOperational;
  bool owes_boot_up_ = false;
  bool has_twin_ = false;
  BusState bus_ = BusState::kActive;
  Parameters parameters_;
  EmergencyLog log_;
  HeartbeatProducer producer_;
  HeartbeatConsumer consumer_;
  SdoServer sdo_;
  std::array<TransmitPdo, kTpdoCount> tpdos_;
  Frame rpdo_;  ///< Waits for SYNC.
  bool has_rpdo_ = false;

  Judgement judgement_;
  std::uint16_t spent_number_ = 0;  ///< The last, if refused before the machine saw it.
  Report report_;
  TransmitPdo fd_pdo_;
  FdBytes fd_bytes_{};  ///< While it is on: of the last look, sequence 0.
  std::int64_t looked_us_ = 0;
  bool carries_fd_ = false;
  std::uint16_t told_fault_of_ = 0;
};

}  // namespace flatpose::can
