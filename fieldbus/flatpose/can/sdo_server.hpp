#pragma once
// The SDO server's side of one transfer: expedited and segmented, both ways (CiA 301, 7.2.4). It
// knows nothing of objects: it says which one is to be read or written, is told what came of that,
// and has the answer for the wire. Block transfers are not offered.
//
//   step = take(frame);  if kRead: give(bytes) or refuse(abort);  if kWrite: written() or refuse()
//
// One transfer at a time; a new one ends the one before.

#include <array>
#include <cstdint>
#include <span>

#include "flatpose/can/abort.hpp"
#include "flatpose/can/frame.hpp"
#include "flatpose/can/heartbeat.hpp"

namespace flatpose::can {

/// No object is larger.
inline constexpr std::size_t kObjectBytesMax = 512;
/// What can be written at once, in segments.
inline constexpr std::size_t kWriteBytesMax = 32;
/// The next segment must come within this.
inline constexpr std::int64_t kSegmentLimit_us = 1'000'000;

class SdoServer {
 public:
  struct Step {
    /// kProbe: a download in segments begins; refuse() it or say nothing.
    enum class Kind : std::uint8_t { kNone, kRead, kProbe, kWrite };
    Kind kind = Kind::kNone;
    std::uint16_t index = 0;
    std::uint8_t subindex = 0;
    std::size_t size = 0;       ///< Of what is to be written.
    bool size_is_known = true;  ///< Else the object takes its own of the four bytes that there are.
    std::span<const std::uint8_t> bytes;  ///< To be written; until the next call of anything.
  };

  void reset() noexcept { *this = {}; }

  [[nodiscard]] Step take(const Frame& request, std::int64_t now_us) noexcept;

  /// The answers to a step.  `bytes` is copied: at most kObjectBytesMax.
  void give(std::span<const std::uint8_t> bytes, std::int64_t now_us) noexcept;
  void written() noexcept;
  void refuse(Abort why) noexcept;

  /// Ends a transfer whose next segment is overdue.
  void pass_time(std::int64_t now_us) noexcept;
  [[nodiscard]] std::int64_t next_us() const noexcept { return limit_us_; }

  [[nodiscard]] bool has_answer() const noexcept { return has_answer_; }
  /// Needs has_answer().
  [[nodiscard]] const std::array<std::uint8_t, 8>& take_answer() noexcept {
    has_answer_ = false;
    return answer_;
  }

 private:
  enum class State : std::uint8_t { kIdle, kDownload, kUpload };

  [[nodiscard]] Step begin_download(const Frame& request, std::int64_t now_us) noexcept;
  [[nodiscard]] Step go_on_with_download(const Frame& request, std::int64_t now_us) noexcept;
  void go_on_with_upload(const Frame& request, std::int64_t now_us) noexcept;
  void begin(State state, std::int64_t now_us) noexcept;
  void end() noexcept;
  void answer(std::uint8_t command) noexcept;
  void answer_with_object(std::uint8_t command) noexcept;

  State state_ = State::kIdle;
  std::uint16_t index_ = 0;
  std::uint8_t subindex_ = 0;
  bool is_segment_ = false;  ///< What is being written came in segments.
  bool toggle_ = false;      ///< That the next segment must have.
  std::size_t size_ = 0;
  std::size_t place_ = 0;
  std::array<std::uint8_t, kObjectBytesMax> buffer_{};
  std::int64_t limit_us_ = kNever_us;
  bool has_answer_ = false;
  std::array<std::uint8_t, 8> answer_{};
};

}  // namespace flatpose::can
