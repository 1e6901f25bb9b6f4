#pragma once
// A job in a scan: each of its parts searched, what was found put in order, held against the job's
// limits, and told as the job machine wants it.

#include <array>
#include <memory>
#include <string>

#include "flatpose/core/arena.hpp"
#include "flatpose/core/host.hpp"
#include "flatpose/job/order.hpp"
#include "flatpose/locate/locator.hpp"
#include "port/linux/daemon/job_set.hpp"
#include "port/linux/daemon/scan_source.hpp"
#include "port/linux/records/record.hpp"

namespace flatpose::daemon {

class JobSearch {
 public:
  /// Refers to both, which must outlive it.
  JobSearch(const JobSet& set, locate::Locator& locator)
      : set_(&set), locator_(locator), found_(std::make_unique<locate::LocateResult>()) {}

  /// Another set: what was verified in the old one is forgotten.
  void use(const JobSet& set) noexcept {
    if (set_ == &set) return;
    set_ = &set;
    has_moved_ = {};
  }

  /// Until the order's time is over, or the host cancels.  Memory: none.  Fails: never, see answer.
  [[nodiscard]] job::ScanResult run(const job::Order& order, const HeldScan& scan,
                                    const Host& host) noexcept;

  /// Whether the order's job has a work plane that can be verified.
  [[nodiscard]] bool can_verify(const job::Order& order) const noexcept;
  /// Holds the scan's plane against that of the order's job: while it does not hold, every job on
  /// the same plane is answered kAlignmentMoved.  Memory: the arena's.  `told` is a line for the
  /// log.
  [[nodiscard]] job::ScanResult verify(const job::Order& order, const HeldScan& scan, Arena arena,
                                       const Host& host, std::string& told) noexcept;

  /// What the last run searched for and found, for the records.
  [[nodiscard]] const port::SearchTrace& trace() const noexcept { return trace_; }

 private:
  /// The result's head, of the order's job. False: there is none, and the result says so.
  [[nodiscard]] bool begin(const job::Order& order, const Host& host) noexcept;
  void search_part(int part, int index, const job::Order& order, const HeldScan& scan,
                   const Host& host) noexcept;
  void add_matches(const Part& part, int index) noexcept;
  void add(const job::FoundMatch& added, double merit) noexcept;
  [[nodiscard]] std::size_t place_of(const Job& job) const noexcept;
  [[nodiscard]] job::Answer without_match() const noexcept;

  const JobSet* set_;
  locate::Locator& locator_;
  std::unique_ptr<locate::LocateResult> found_;
  const Job* job_ = nullptr;
  Frames frames_;
  job::ScanResult result_;
  std::array<double, job::kMatchesPerScanMax> merits_{};  ///< Of the result's matches.
  port::SearchTrace trace_;
  std::int64_t start_us_ = 0;
  int outside_count_ = 0;
  std::array<bool, job::kJobCountMax> has_moved_{};  ///< By the job's place in the set.
};

}  // namespace flatpose::daemon
