#pragma once
// Sets of jobs on their way into force, without a lock. A new set and its table come into force in
// one moment, that in which the bus's thread gives the table to the job machine: an order given
// before is of the old set, however long it runs, and one given after is of the new.
//
//   who loads:  offer(set) ------> bus: offered(), then adopt() ---orders bear a generation--->
//   search: has_room() <--------------------------- use(generation): older ones are let go
//   ------------'

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>

#include "port/linux/daemon/job_set.hpp"

namespace flatpose::daemon {

class JobShelf {
 public:
  explicit JobShelf(std::shared_ptr<const JobSet> first) : tables_{first->rules(), {}} {
    sets_[0] = std::move(first);
  }

  // --- who loads

  /// Whether the search uses none but the set in force, and none is on its way.
  [[nodiscard]] bool has_room() const noexcept {
    const std::uint32_t generation = generation_.load(std::memory_order_acquire);
    return used_.load(std::memory_order_acquire) == generation && offered_.load() == generation;
  }
  /// Needs has_room(). Lets go of the set before.
  void offer(std::shared_ptr<const JobSet> set) {
    const std::uint32_t next = generation_.load() + 1;
    tables_[next % 2] = set->rules();
    sets_[next % 2] = std::move(set);
    offered_.store(next, std::memory_order_release);
  }
  /// Whether what was offered last is in force.
  [[nodiscard]] bool is_adopted() const noexcept {
    return generation_.load(std::memory_order_acquire) == offered_.load();
  }

  // --- the bus

  /// The table that the machine is to be given; null: none.
  [[nodiscard]] const job::JobTable* offered() const noexcept {
    const std::uint32_t offered = offered_.load(std::memory_order_acquire);
    return offered == generation_.load(std::memory_order_relaxed) ? nullptr : &tables_[offered % 2];
  }
  /// The machine has it.
  void adopt() noexcept { generation_.store(offered_.load(), std::memory_order_release); }

  // --- the search, and the bus for its orders

  [[nodiscard]] std::uint32_t generation() const noexcept {
    return generation_.load(std::memory_order_acquire);
  }
  /// The set of an order. It stays until one of a later generation is used.
  [[nodiscard]] const JobSet& use(std::uint32_t generation) noexcept {
    used_.store(generation, std::memory_order_release);
    return *sets_[generation % 2];
  }

 private:
  std::array<std::shared_ptr<const JobSet>, 2> sets_;
  std::array<job::JobTable, 2> tables_;
  std::atomic<std::uint32_t> offered_{0};
  std::atomic<std::uint32_t> generation_{0};  ///< In force.
  std::atomic<std::uint32_t> used_{0};
};

}  // namespace flatpose::daemon
