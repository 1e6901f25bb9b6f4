#pragma once
// Who may write: one master at a time, by a lease that any request of its renews. Closing a
// connection changes nothing; the same address goes on with a new one.

#include <cstdint>

#include "flatpose/job/master.hpp"

namespace flatpose::job {

class Ownership {
 public:
  explicit Ownership(std::int64_t lease_us = 0) noexcept : lease_us_(lease_us) {}

  /// Any sound request of a master, after it was judged: renews the owner's lease, and shows that
  /// its connection lives.
  void hear(const Master& master, std::int64_t now_us) noexcept {
    if (is_held(now_us) && owner_ == master.address) held_until_us_ = now_us + lease_us_;
    MasterRecord* record = book_.find(master.address);
    if (record != nullptr && master.connection < record->newest_connection)
      record->revived_connection = master.connection;
  }

  /// Nobody else holds the lease; and a connection older than the one that wrote last was heard
  /// since: what a master left behind in an abandoned one is a single request.
  [[nodiscard]] bool may_write(const Master& master, std::int64_t now_us) const noexcept {
    if (master.address == kNobody) return false;
    if (is_held(now_us) && owner_ != master.address) return false;
    const MasterRecord* record = book_.find(master.address);
    return record == nullptr || master.connection >= record->newest_connection ||
           master.connection == record->revived_connection;
  }

  /// Whether a write by this master would be the first after another's.
  [[nodiscard]] bool is_change(const Master& master) const noexcept {
    return owner_ != master.address;
  }

  /// Takes or renews the lease.  Needs may_write().
  MasterRecord& take(const Master& master, std::int64_t now_us) noexcept {
    owner_ = master.address;
    held_until_us_ = now_us + lease_us_;
    MasterRecord& record = book_.open(master.address, now_us);
    record.newest_connection = master.connection;
    record.revived_connection = kNoConnection;
    return record;
  }

  /// Ends the lease of a master that is known to be gone.  Returns whether it had it.
  bool release(Address address, std::int64_t now_us) noexcept {
    if (address == kNobody || holder(now_us) != address) return false;
    held_until_us_ = now_us;
    return true;
  }

  [[nodiscard]] bool is_held(std::int64_t now_us) const noexcept {
    return owner_ != kNobody && now_us < held_until_us_;
  }
  [[nodiscard]] Address holder(std::int64_t now_us) const noexcept {
    return is_held(now_us) ? owner_ : kNobody;
  }
  [[nodiscard]] std::int64_t held_until_us() const noexcept { return held_until_us_; }
  [[nodiscard]] std::uint16_t last_number(Address address) const noexcept {
    const MasterRecord* record = book_.find(address);
    return record == nullptr ? std::uint16_t{0} : record->last_number;
  }

 private:
  std::int64_t lease_us_;
  Address owner_ = kNobody;  ///< Also after the lease ran out: who had it last.
  std::int64_t held_until_us_ = 0;
  MasterBook book_;
};

}  // namespace flatpose::job
