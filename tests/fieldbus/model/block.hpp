#pragma once
// The result block as a PLC has it after one read: words, found by the names of the map.

#include <array>
#include <cstdint>
#include <cstring>
#include <string>

#include "flatpose/result_map/table.hpp"

namespace flatpose::model {

using Block = std::array<std::uint16_t, result_map::kResultWords>;

/// Where in the block the register of that name stands.
inline int place_of(const std::string& name) {
  for (const result_map::Entry& entry : result_map::entries()) {
    if (entry.block == 0 && entry.name == name) return entry.address - result_map::kResultAddress;
  }
  return -1;
}

#define FLATPOSE_MODEL_WORD(name)                  \
  inline std::uint16_t name(const Block& block) {  \
    static const int place = place_of(#name);      \
    return block[static_cast<std::size_t>(place)]; \
  }
#define FLATPOSE_MODEL_LONG(name)                                                        \
  inline std::uint32_t name(const Block& block) {                                        \
    static const int place = place_of(#name);                                            \
    return static_cast<std::uint32_t>(block[static_cast<std::size_t>(place)]) * 65536U + \
           block[static_cast<std::size_t>(place + 1)];                                   \
  }
FLATPOSE_MODEL_WORD(done_number)
FLATPOSE_MODEL_WORD(done_number_tail)
FLATPOSE_MODEL_WORD(status)
FLATPOSE_MODEL_WORD(bits)
FLATPOSE_MODEL_WORD(accepted_number)
FLATPOSE_MODEL_WORD(refused_number)
FLATPOSE_MODEL_WORD(last_number)
FLATPOSE_MODEL_WORD(session_id)
FLATPOSE_MODEL_WORD(reader_is_owner)
FLATPOSE_MODEL_WORD(result_is_readers)
FLATPOSE_MODEL_WORD(result_job)
FLATPOSE_MODEL_WORD(match_index)
FLATPOSE_MODEL_WORD(match_count)
FLATPOSE_MODEL_LONG(answer_by_ms)
FLATPOSE_MODEL_LONG(scan_number)
FLATPOSE_MODEL_LONG(age_ms)
FLATPOSE_MODEL_LONG(position_x)
FLATPOSE_MODEL_LONG(position_y)
FLATPOSE_MODEL_LONG(position_z)
FLATPOSE_MODEL_LONG(position_x_f)
FLATPOSE_MODEL_LONG(rotation_1)
#undef FLATPOSE_MODEL_WORD
#undef FLATPOSE_MODEL_LONG

enum : std::uint16_t { kBusyBit = 4, kDoneBit = 8, kValidBit = 16 };
inline constexpr std::uint32_t kNoneLong = 0x80000000U;

inline bool has_pose(const Block& block) { return position_x(block) != kNoneLong; }

}  // namespace flatpose::model
