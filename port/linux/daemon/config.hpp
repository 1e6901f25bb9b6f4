#pragma once
// What the daemon is told by its file. A section of the file is a file here (NAME_section.cpp) and
// a line in load_config().

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "flatpose/can/config.hpp"
#include "flatpose/job/rules.hpp"
#include "flatpose/locate/locator.hpp"
#include "flatpose/result_map/registers.hpp"
#include "port/linux/can/interface.hpp"
#include "port/linux/daemon/pick_pose.hpp"
#include "port/linux/files/scan.hpp"
#include "port/linux/modbus/allow_list.hpp"
#include "port/linux/realtime/config.hpp"
#include "port/linux/records/record_folder.hpp"

namespace flatpose::daemon {

class Section;

/// [search]
struct SearchConfig {
  int thread_count = 1;
  /// The largest scan, and cells of the finest height map: they decide how much memory is taken at
  /// the start. A scan beyond them is refused.
  locate::Limits limits;
  /// What loading a scan may take of memory.
  std::int64_t max_scan_bytes = 256 << 20;
};

/// [modbus]; without the section there is no server.
struct ModbusConfig {
  bool is_on = false;
  std::string place;  ///< "FILE:LINE" of the port, for messages.
  std::string bind = "0.0.0.0";
  int port = 502;  ///< 0: any that is free.
  port::AllowList allowed;
  std::uint8_t unit = 1;
  result_map::WireFormat format;
  job::Handshake handshake = job::Handshake::kNumber;
};

/// [can]; without the section there is no node.
struct CanConfig {
  bool is_on = false;
  std::string place;  ///< "FILE:LINE" of the interface, for messages.
  std::string interface = "can0";
  std::uint32_t bit_rate_per_s = 0;  ///< That the interface must have; 0: whatever it has.
  can::Config node;

  [[nodiscard]] port::CanNeed need() const noexcept { return {bit_rate_per_s, node.fd_frame}; }
};

/// [source]: where scans come from.
struct SourceConfig {
  // At most one of these; none: there is no source.
  std::string replay;  ///< A file, or a folder of them.
  std::string watch;   ///< A folder into which scans are written.
  std::string driver;  ///< The Unix socket for a camera driver.
  std::string place;
  std::optional<port::Up> up;
  bool allow_simulated = false;

  [[nodiscard]] bool is_any() const noexcept {
    return !replay.empty() || !watch.empty() || !driver.empty();
  }
};

/// [records]; without a folder nothing is kept.
struct RecordsConfig {
  std::string folder;
  port::RecordLimits limits;
  bool draws = true;       ///< last.png
  std::string state_file;  ///< Where starts are counted; empty: see state_file_of().
};

/// [[part]]
struct PartConfig {
  std::string name;
  std::string file;
  std::vector<PickPose> picks;  ///< By falling priority.
};

/// [[job]]
struct JobConfig {
  job::JobRule rule;
  std::vector<int> parts;       ///< Indices into Config::parts, searched in the same scan.
  locate::LocateConfig locate;  ///< Its deadline is the job's; exclusions are the next.
  std::vector<Region> exclusions;
  std::string work_file;   ///< Of frame "work"; with others it says where up is.
  std::string robot_file;  ///< Of frame "robot".
  ReportRule report;
  double verify_shift_mm = 1.0;       ///< What the work plane may have moved when it is verified.
  double verify_tilt_rad = 0.008727;  ///< Half a degree.
};

struct Config {
  std::string text;  ///< The file's own.
  SearchConfig search;
  port::RealtimeConfig realtime;
  ModbusConfig modbus;
  CanConfig can;
  /// Of masters on either bus, for there is one lease; none: the job machine's usual one.
  std::optional<std::int64_t> lease_us;
  SourceConfig source;
  RecordsConfig records;
  std::vector<PartConfig> parts;
  std::vector<JobConfig> jobs;
};

/// Fails: port::InputError, `FILE:LINE: WHAT; REMEDY`.
[[nodiscard]] Config load_config(const std::string& path);
[[nodiscard]] Config parse_config(const std::string& path, std::string_view text);

void read_search(Section section, Config& config);
/// After read_search(): there is a processor for each thread or none is given.
void read_realtime(Section section, Config& config);

void read_modbus(Section section, Config& config);
/// After read_modbus(): both follow one handshake.
void read_can(Section section, Config& config);
/// Of either: who writes it in both writes the same.
void read_lease(Section& section, Config& config);
void read_source(Section section, Config& config);
void read_records(Section section, Config& config);
void read_part(Section section, Config& config);
/// After all parts.
void read_job(Section section, Config& config);

/// Of the one arena that searches and verifications take turns in.
[[nodiscard]] std::size_t search_arena_bytes(const locate::Limits& limits) noexcept;
/// What the daemon holds in memory while it runs, stacks and loading apart.
[[nodiscard]] std::int64_t held_bytes(const Config& config);
/// What it may take at most, so that limits and machine should allow it.
[[nodiscard]] std::int64_t taken_bytes_max(const Config& config);
/// Where starts are counted: as configured, else in the service manager's folder of state (null:
/// none), else beside the records; empty: nowhere.
[[nodiscard]] std::string state_file_of(const RecordsConfig& records, const char* state_directory);
/// "2 search threads"
[[nodiscard]] std::string threads_text(const SearchConfig& search);

}  // namespace flatpose::daemon
