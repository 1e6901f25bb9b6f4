#pragma once
// Scans from a folder into which a camera's program writes finished files: *.pcd, *.png with its
// NAME.json, *.json as sick_json.hpp reads it. Nothing is ever written there, or removed.
//
// A file counts for a command when the command was accepted before the file began, that is, was
// created in the folder or moved into it; when two or more do, the first to be finished. What was
// there before, was being written, or is written over in place, does not count: when its scan was
// acquired cannot be told. Of a file moved in from elsewhere the file system is asked for its time
// of birth, if it keeps one. Hidden files and *.tmp, *.part are none; what they are renamed to in
// the same folder began when they did.

#include <atomic>
#include <optional>
#include <thread>

#include "port/linux/clock/steady_clock.hpp"
#include "port/linux/daemon/arrivals.hpp"
#include "port/linux/daemon/event_file.hpp"
#include "port/linux/daemon/folder_watch.hpp"
#include "port/linux/daemon/scan_file.hpp"
#include "port/linux/daemon/scan_handover.hpp"
#include "port/linux/daemon/scan_source.hpp"

namespace flatpose::daemon {

class WatchSource final : public ScanSource {
 public:
  /// Fails: std::system_error.
  WatchSource(const Config& config, const ScanBuffers& buffers, Doorbell& taker, int wake,
              Log& log);
  ~WatchSource() override;

  void start() override;
  void ask() noexcept override;
  void request(const ScanOrder& order) noexcept override;
  [[nodiscard]] const HeldScan* take(std::int64_t now_us) noexcept override;
  void abandon() noexcept override;
  [[nodiscard]] const HeldScan* last() const noexcept override { return handover_.last(); }

 private:
  struct Wanted {
    ScanOrder order;
    FolderWatch::Mark mark = FolderWatch::kNoMark;
    std::int64_t accepted_real_us = 0;  ///< By the clock that files are dated by.
  };

  void work() noexcept;
  void turn();
  void attach();
  void tell_life() noexcept;
  void take_request();
  void search_folder();
  [[nodiscard]] bool is_complete(const std::string& name) const;
  [[nodiscard]] bool is_too_old(const std::string& name) const;
  void load(const std::string& name);
  void fail(const std::string& why);

  const std::string path_;
  const ScanFileReader reader_;
  Log& log_;
  port::SteadyClock clock_;
  FolderWatch watch_;
  EventFile event_;
  ScanHandover handover_;
  Latest<Wanted> requests_;
  std::atomic<bool> is_asked_{false};
  std::atomic<bool> is_over_{false};
  std::uint32_t wanted_ticket_ = 0;  ///< The taker's.

  // The source's thread.
  Arrivals arrivals_;
  Wanted wanted_;
  bool is_wanted_ = false;
  std::optional<bool> was_there_;
  bool is_simulated_ = false;  ///< What the last file said.
  std::thread thread_;
};

/// Whether the folder lies on a file system that other machines write to unseen.
[[nodiscard]] bool is_on_network(const std::string& path) noexcept;

}  // namespace flatpose::daemon
