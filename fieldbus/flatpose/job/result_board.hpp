#pragma once
// The result that masters read, and the scan's other matches for `next`. Posted whole, cleared
// whole: there is never a number beside another number's pose.

#include <array>
#include <cstdint>

#include "flatpose/job/order.hpp"
#include "flatpose/job/rules.hpp"
#include "flatpose/job/snapshot.hpp"

namespace flatpose::job {

class ResultBoard {
 public:
  /// Nothing to read any more. The scan's matches stay for `next`.
  void clear() noexcept;
  /// Not even `next` finds anything now.
  void forget_scan() noexcept { matches_are_kept_ = false; }

  /// The answer of a search or a capture; matches are taken if the answer may have a pose.
  void post_scan(std::uint16_t number, Address asker, const JobRule& rule,
                 const ScanResult& result) noexcept;
  /// An answer without a scan.
  void post(std::uint16_t number, Address asker, const JobRule& rule, Answer answer) noexcept;
  /// The next match of the scan kept.  Returns how that ended.
  Answer post_next(std::uint16_t number, Address asker) noexcept;

  [[nodiscard]] std::uint16_t number() const noexcept { return number_; }
  [[nodiscard]] bool is_simulated() const noexcept { return shows_scan_ && scan_.is_simulated; }
  [[nodiscard]] bool is_repeated() const noexcept { return shows_scan_ && scan_.is_repeated; }
  /// Whether there is a pose that is not too old.
  [[nodiscard]] bool is_valid(std::int64_t now_us) const noexcept {
    return has_pose() && !is_expired(now_us);
  }
  /// When the pose will have expired; the far future when never, or when it has.
  [[nodiscard]] std::int64_t expires_us(std::int64_t now_us) const noexcept;

  /// Fills in what the board knows. An expired pose is not shown.
  void show(std::int64_t now_us, Address reader, Snapshot& snapshot) const noexcept;

 private:
  [[nodiscard]] bool has_pose() const noexcept { return number_ != 0 && match_.index != 0; }
  [[nodiscard]] bool is_expired(std::int64_t now_us) const noexcept;
  void turn_to(int index) noexcept;
  [[nodiscard]] ShownMatch shown(int index) const noexcept;

  std::uint16_t number_ = 0;
  Address asker_ = kNobody;
  Answer answer_ = Answer::kPending;
  JobRule rule_;
  bool shows_scan_ = false;
  ShownMatch match_;
  std::array<ShownMatch, kFurtherCount> further_{};

  ScanResult scan_;
  JobRule scan_rule_;  ///< `next` goes on in the frame and convention of the scan's job.
  bool matches_are_kept_ = false;
  int turned_to_ = 0;
};

}  // namespace flatpose::job
