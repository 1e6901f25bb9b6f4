#pragma once
// The bus's thread: the job machine, the Modbus server and the CAN node before it and the search
// behind it. It waits for sockets and for the search alike, in one place, and for nothing else.

#include <atomic>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "flatpose/job/machine.hpp"
#include "flatpose/modbus/server.hpp"
#include "port/linux/clock/steady_clock.hpp"
#include "port/linux/daemon/can_log.hpp"
#include "port/linux/daemon/can_node.hpp"
#include "port/linux/daemon/config.hpp"
#include "port/linux/daemon/search_engine.hpp"
#include "port/linux/modbus/executor.hpp"
#include "port/linux/modbus/tcp_server.hpp"

namespace flatpose::daemon {

class Bus final : private port::Responder {
 public:
  /// Listens from now on, on what the config names. Refers to the engine, which must outlive it.
  /// Fails: port::InputError when it cannot listen there, std::system_error.
  Bus(const Config& config, const job::JobTable& jobs, SearchEngine& engine,
      std::uint16_t boot_count);
  ~Bus();
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;

  void start();
  /// "Modbus TCP on 127.0.0.1:502; CANopen node 10 on can0 at 250 kbit/s"
  [[nodiscard]] std::string name() const;
  /// Counts the turns of the thread, of which there are some every second.
  [[nodiscard]] std::uint32_t turns() const noexcept { return turns_.load(); }

  [[nodiscard]] bool has_can() const noexcept { return can_log_.has_value(); }
  /// What has become of the CAN interface since the last call, for the log.  Call it now and then.
  /// Thread: one, not the bus's.
  [[nodiscard]] std::vector<std::string> news();

 private:
  std::size_t respond(const job::Master& master, const modbus::Adu& adu,
                      std::span<std::uint8_t, modbus::kAduBytesMax> response) noexcept override;
  [[nodiscard]] job::Address owner() const noexcept override;
  void work() noexcept;
  void wait(std::int64_t time_us) noexcept;
  void serve_can(std::int64_t now_us) noexcept;
  [[nodiscard]] std::int64_t machine_now_us() noexcept;
  void take_events() noexcept;
  void pass_on(const job::Outputs& outputs) noexcept;
  [[nodiscard]] std::int64_t next_us() const noexcept;

  SearchEngine& engine_;
  port::SteadyClock clock_;
  job::Machine machine_;
  port::LibmodbusExecutor executor_;
  modbus::Server modbus_;
  std::optional<port::TcpServer> server_;
  std::optional<CanNode> can_;
  job::SearchEvent event_;
  std::int64_t machine_us_ = 0;  ///< When the machine wants to be called.
  std::int64_t can_served_us_ = 0;
  std::int64_t ask_us_ = 0;  ///< When search and source are asked for a sign of life.
  std::atomic<port::CanCondition> can_condition_{};
  static_assert(std::atomic<port::CanCondition>::is_always_lock_free);
  std::string can_interface_;
  std::optional<CanLog> can_log_;
  bool has_told_doubt_ = false;
  std::atomic<bool> is_over_{false};
  std::atomic<std::uint32_t> turns_{0};
  std::thread thread_;
};

}  // namespace flatpose::daemon
