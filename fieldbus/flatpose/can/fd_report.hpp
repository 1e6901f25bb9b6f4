#pragma once
// The whole result in one CAN FD frame of 64 bytes, in the registers' numbers and scales: a
// quaternion, far poses and sigma fit here, which the TPDOs have no room for. Of one moment by
// itself: no sequence need be compared.
//
//    0  as TPDO1: sequence, status, bits, refused_status, judged_number, done_number
//    8  position_x, position_y, position_z                4 bytes each, signed
//   20  rotation_1, rotation_2, rotation_3, rotation_4    4 bytes each, signed
//   36  sigma_x, sigma_y, sigma_z, sigma_turn_x, .._y, .._z       2 bytes each
//   48  score, visible                                    2 bytes each, signed
//   52  age_ms                                            4 bytes: when the frame was sent
//   56  part, tool, pick, match_index                     1 byte each
//   60  session_id                                        2 bytes
//   62  convention, frame                                 1 byte each
//
// What there is none of reads as in the registers, in one byte 255. Parts and tools from the 255th
// on do not fit: then the status is out_of_range, as in the TPDOs, and there is no pose.

#include <array>
#include <cstdint>
#include <span>

#include "flatpose/can/frame.hpp"
#include "flatpose/can/report.hpp"
#include "flatpose/job/snapshot.hpp"
#include "flatpose/result_map/entry.hpp"

namespace flatpose::can {

using FdBytes = std::array<std::uint8_t, kFdBytesMax>;

/// What stands after the first eight bytes; all else of a line is its register's.
struct FdLine {
  result_map::Field field;
  std::uint8_t bytes;
};
/// In the order of the frame.
[[nodiscard]] std::span<const FdLine> fd_lines() noexcept;

/// What the reader of the snapshot may be told: of another's result nothing. The sequence is 0.
[[nodiscard]] FdBytes fd_bytes(const job::Snapshot& snapshot, const Judgement& judgement) noexcept;

/// Adds what has passed to the age, if there is one.
void grow_older(FdBytes& bytes, std::int64_t time_us) noexcept;

/// Whether both tell of the same result; bits, judgement and age may differ.
[[nodiscard]] bool is_same_result(const FdBytes& a, const FdBytes& b) noexcept;

}  // namespace flatpose::can
