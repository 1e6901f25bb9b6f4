#pragma once
// Which files of a folder are finished and certainly began after a mark: bookkeeping of what the
// system tells of a folder, without the system.
//
// A file begins when it is created, or moved in from elsewhere, and is finished when whoever wrote
// it closes it; one that is moved in counts as finished. What is renamed within the folder stays
// the file that it was. A file whose beginning was not seen began before every mark.

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace flatpose::daemon {

inline constexpr std::size_t kArrivalsMax = 1024;

struct Arrival {
  std::int64_t began_us = 0;  ///< When its beginning was seen.
  bool is_finished = false;
  bool is_from_elsewhere = false;  ///< Moved in: when it was begun to be written nobody saw.
};

class Arrivals {
 public:
  /// What began until now began before the mark.
  void mark();

  void created(const std::string& name, std::int64_t now_us);
  void closed(const std::string& name);
  /// `cookie` joins the two halves of a renaming; one half alone goes to, or comes from, elsewhere.
  void moved_out(const std::string& name, std::uint32_t cookie);
  void moved_in(const std::string& name, std::uint32_t cookie, std::int64_t now_us);
  void removed(const std::string& name);
  /// Some of the above may have been missed: what is not finished is not known any more.
  void forget();

  /// Began and were finished since the mark, in the order of their finishing.
  [[nodiscard]] const std::vector<std::string>& fresh() const noexcept { return fresh_; }
  /// Null: not known.
  [[nodiscard]] const Arrival* find(const std::string& name) const;
  /// One that was finished since the mark but began before it; empty: none.
  [[nodiscard]] const std::string& stale() const noexcept { return stale_; }
  void let_go(const std::string& name);

 private:
  struct Known {
    Arrival arrival;
    std::uint64_t mark = 0;  ///< Of those made before it began.
  };
  void add(const std::string& name, const Known& known);
  void finished(const std::string& name, const Known& known);

  std::map<std::string, Known> known_;
  std::vector<std::string> fresh_;
  std::string stale_;
  std::uint64_t marks_ = 1;
  std::uint32_t moving_cookie_ = 0;
  Known moving_;
};

}  // namespace flatpose::daemon
