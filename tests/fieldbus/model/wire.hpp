#pragma once
// What passes between a PLC and the server: requests and responses in order on a connection, which
// may break, with what lies in the server's buffer still to come.

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "tests/fieldbus/model/block.hpp"

namespace flatpose::model {

using Words = std::array<std::uint16_t, 4>;  ///< command_number, command_session, command, job

struct Message {
  std::optional<Words> write;  ///< None: read the result block.
  // Not on the wire:
  int use = 0;                ///< Which of the PLC's commands it is for; 0: none.
  std::vector<int> given_up;  ///< With a claim: the commands that the PLC has given up by now.
};

struct Reply {
  bool is_write = false;
  bool is_refused = false;  ///< Exception 6.
  Block block{};            ///< Of a read.
  std::int64_t made_us = 0;
};

struct Connection {
  std::uint64_t serial = 0;
  std::uint32_t address = 0;
  bool is_broken = false;  ///< Replies come to nobody.
  std::deque<Message> to_server;
  std::deque<Reply> to_plc;
};

class Random {  // SplitMix64
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits() {
    state_ += 0x9e3779b97f4a7c15ULL;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }
  int below(int limit) { return static_cast<int>(bits() % static_cast<std::uint64_t>(limit)); }
  bool one_in(int n) { return below(n) == 0; }

 private:
  std::uint64_t state_;
};

}  // namespace flatpose::model
