#pragma once
// Scans from a camera driver, a process of its own that speaks flatpose/camera_protocol.h over a
// Unix socket and writes points into memory that it was handed. One driver at a time: a second is
// told so, unless the first is dead or hangs.
//
// A driver that dies, or was never there, ends the command that waits for it at once, and READY
// drops; one that hangs is left to answer_by. What a driver says wrong costs it the connection.

#include <array>
#include <atomic>
#include <thread>

#include "port/linux/clock/steady_clock.hpp"
#include "port/linux/daemon/driver_line.hpp"
#include "port/linux/daemon/driver_listener.hpp"
#include "port/linux/daemon/event_file.hpp"
#include "port/linux/daemon/scan_handover.hpp"
#include "port/linux/daemon/scan_source.hpp"

namespace flatpose::daemon {

class DriverSource final : public ScanSource {
 public:
  /// Listens from now on.  Fails: port::InputError, std::system_error.
  DriverSource(const Config& config, const ScanBuffers& buffers, Doorbell& taker, int wake,
               Log& log);
  ~DriverSource() override;

  void start() override;
  void ask() noexcept override;
  void request(const ScanOrder& order) noexcept override;
  [[nodiscard]] const HeldScan* take(std::int64_t now_us) noexcept override;
  void abandon() noexcept override;
  [[nodiscard]] const HeldScan* last() const noexcept override { return handover_.last(); }

 private:
  /// Connections that have not said hello yet.
  static constexpr int kWaitingMax = 4;

  void work() noexcept;
  void turn();
  void wait_for_something() noexcept;
  void take_request();
  void begin(const ScanOrder& order);
  void stop_capture() noexcept;
  void hear_driver();
  void take_message(const DriverMessage& message);
  void take_scan(const flatpose_camera_done_message& done);
  void fail(const std::string& why);
  void lose_driver(const std::string& why);
  void accept_newcomer();
  void hear_newcomers();
  void greet(DriverLine& line, const flatpose_camera_hello_message& hello);
  void turn_away(DriverLine& line, const std::string& why);
  void tell_life() noexcept;
  [[nodiscard]] bool driver_is_fresh() const noexcept;
  [[nodiscard]] std::int64_t next_us() const noexcept;

  const locate::Limits limits_;
  const std::optional<port::Up> up_;
  Log& log_;
  port::SteadyClock clock_;
  DriverListener listener_;
  EventFile event_;
  ScanHandover handover_;
  Latest<ScanOrder> requests_;
  std::atomic<bool> is_asked_{false};
  std::atomic<bool> is_over_{false};
  std::uint32_t wanted_ticket_ = 0;  ///< The taker's.

  // The source's thread.
  std::array<DriverLine, kWaitingMax> waiting_;
  DriverLine driver_;
  ScanOrder order_;
  bool is_capturing_ = false;
  bool was_fresh_ = false;
  std::int64_t now_us_ = 0;
  std::int64_t deaf_until_us_ = 0;
  std::string turned_away_;          ///< Why the last was.
  std::int64_t turned_away_us_ = 0;  ///< When a line of the log was spent on that.
  DriverMessage message_;
  std::thread thread_;
};

}  // namespace flatpose::daemon
