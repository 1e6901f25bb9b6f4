#pragma once
// Who speaks: a master is an address, not a socket. What must outlive its connections is written
// down here: the last number, so that it is not executed again when it is written again, and the
// connection that wrote last, so that what still lies in an older one's buffer cannot come after.

#include <array>
#include <cstdint>

namespace flatpose::job {

/// An IPv4 address as a number (192.0.2.1 is 0xc0000201). A CAN master is its node id alone: no
/// host has an address below 1.0.0.0.
using Address = std::uint32_t;
inline constexpr Address kNobody = 0;

struct Master {
  Address address = kNobody;
  std::uint64_t connection = 0;  ///< Counts up with each connection that is accepted.
};

inline constexpr std::uint64_t kNoConnection = ~std::uint64_t{0};

struct MasterRecord {
  Address address = kNobody;
  std::uint16_t last_number = 0;
  std::uint64_t newest_connection = 0;               ///< The one that wrote last.
  std::uint64_t revived_connection = kNoConnection;  ///< An older one, heard since: it lives.
  std::int64_t wrote_us = 0;
};

class MasterBook {
 public:
  /// So many masters are remembered; then the one that has not written for longest is forgotten.
  static constexpr int kMasterCountMax = 32;

  [[nodiscard]] const MasterRecord* find(Address address) const noexcept {
    for (const MasterRecord& record : records_) {
      if (record.address == address && address != kNobody) return &record;
    }
    return nullptr;
  }

  [[nodiscard]] MasterRecord* find(Address address) noexcept {
    return const_cast<MasterRecord*>(static_cast<const MasterBook&>(*this).find(address));
  }

  /// The master's record, made if there is none.
  MasterRecord& open(Address address, std::int64_t now_us) noexcept {
    MasterRecord* chosen = &records_[0];
    for (MasterRecord& record : records_) {
      if (record.address == address) {
        record.wrote_us = now_us;
        return record;
      }
      const bool is_better = record.address == kNobody
                                 ? chosen->address != kNobody
                                 : chosen->address != kNobody && record.wrote_us < chosen->wrote_us;
      if (is_better) chosen = &record;
    }
    *chosen = {address, 0, 0, kNoConnection, now_us};
    return *chosen;
  }

 private:
  std::array<MasterRecord, kMasterCountMax> records_{};
};

}  // namespace flatpose::job
