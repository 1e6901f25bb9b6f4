#include "flatpose/job/command.hpp"

namespace flatpose::job {
namespace {

constexpr Named kCommands[] = {
    {1, "locate", "new scan, search, best pose"},
    {2, "next", "the next match of the same scan"},
    {3, "capture", "new scan only; scanned_number tells that robot or belt may move"},
    {4, "locate_in_last", "search in the last scan"},
    {5, "cancel", "end what is running; the only command taken while BUSY"},
    {6, "clear_error", "drop the ERROR bit"},
    {7, "verify_alignment", "new scan, does the alignment still hold"},
    {8, "save_scan", "keep the last scan on disk"},
    {9, "report_pick", "tell how the pick went: pick_number, pick_outcome"},
    {10, "reload_jobs", "read the jobs again: all, or the old ones stay"},
};
constexpr Named kRefusals[] = {
    {0, "none", "not refused"},
    {1, "busy", "a command is running: wait for it, or cancel"},
    {2, "not_ready", "search or scan source do not live"},
    {3, "not_owner", "another master holds the lease"},
    {4, "bad_job", "there is no such job"},
    {5, "bad_command", "there is no such command, or with report_pick no such pick_outcome"},
    {6, "stale_session", "command_session is not session_id: flatpose was started again"},
};
constexpr Named kBits[] = {
    {0, "ready", "would take a command now"},
    {1, "ack", "the last trigger was accepted"},
    {2, "busy", "a command is running"},
    {3, "done", "there is an answer"},
    {4, "valid", "there is a pose, and it is fresh"},
    {5, "error", "a command was refused, or something is at fault"},
    {6, "simulated", "the scan, or its source, is simulated"},
    {7, "scan_repeated", "the scan is byte for byte the one before"},
};
constexpr Named kControlBits[] = {
    {0, "trigger", "raise to start, drop when ack is seen"},
    {1, "result_read", "raise when the result was read, drop when done has dropped"},
};
constexpr Named kPickOutcomes[] = {
    {1, "picked", "the part was gripped"},
    {2, "missed", "nothing was gripped"},
    {3, "collided", "the robot stopped on contact"},
    {4, "dropped", "gripped, then lost"},
};
constexpr Named kFrames[] = {
    {0, "scan", "as the sensor gave it"},
    {1, "work", "z up off the aligned work plane"},
    {2, "robot", "the robot's own, from touched points"},
};

}  // namespace

std::span<const Named> command_names() noexcept { return kCommands; }
std::span<const Named> refusal_names() noexcept { return kRefusals; }
std::span<const Named> bit_names() noexcept { return kBits; }
std::span<const Named> control_bit_names() noexcept { return kControlBits; }
std::span<const Named> pick_outcome_names() noexcept { return kPickOutcomes; }
std::span<const Named> frame_names() noexcept { return kFrames; }

const char* name_of(std::span<const Named> names, int value) noexcept {
  for (const Named& named : names) {
    if (named.value == value) return named.name;
  }
  return "unknown";
}

}  // namespace flatpose::job
