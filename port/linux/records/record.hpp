#pragma once
// All that there is to keep of a command: what was asked, the scan, what the search found and what
// was told of it.

#include <array>
#include <cstdint>
#include <memory>

#include "flatpose/geometry/frames.hpp"
#include "flatpose/job/order.hpp"
#include "flatpose/locate/locator.hpp"
#include "flatpose/model/template.hpp"
#include "port/linux/tool/loaded_scan.hpp"

namespace flatpose::port {

inline constexpr int kPartsPerSearchMax = 8;

struct SearchedPart {
  std::shared_ptr<const model::Template> part;
  locate::LocateResult result;
};

/// A job's searches, part by part.
struct SearchTrace {
  Frames frames;
  job::FrameName face = job::FrameName::kScan;  ///< That its poses are in.
  std::array<SearchedPart, kPartsPerSearchMax> parts;
  int part_count = 0;

  void clear() noexcept { part_count = 0; }
  /// Of the parts that there are: the rest is long.
  void take(const SearchTrace& other) noexcept {
    frames = other.frames;
    face = other.face;
    clear();
    for (int i = 0; i < other.part_count; ++i) {
      const SearchedPart& searched = other.parts[static_cast<std::size_t>(i)];
      add(searched.part, searched.result);
    }
  }
  void add(const std::shared_ptr<const model::Template>& part,
           const locate::LocateResult& result) noexcept {
    if (part_count == kPartsPerSearchMax) return;
    SearchedPart& place = parts[static_cast<std::size_t>(part_count++)];
    place.part = part;
    place.result = result;
  }
};

/// On the steady clock; 0: it did not come to that.
struct RecordTimes {
  std::int64_t begun_us = 0;   ///< The scan was in memory, the search began.
  std::int64_t ended_us = 0;   ///< The search returned.
  std::int64_t said_us = 0;    ///< The bus was told.
  std::int64_t copied_us = 0;  ///< This record was handed over.
  std::int64_t posted_us = 0;  ///< The bus had it on its board.
};

struct Record {
  job::Order order;
  job::ScanResult result;
  SearchTrace trace;
  tool::LoadedScan loaded;  ///< Without pixels: there was no scan.
  std::size_t arena_bytes = 0;
  RecordTimes times;
  std::int64_t since_1970_us = 0;
  std::uint64_t dropped_count = 0;  ///< Records that found no time to be written before this one.

  [[nodiscard]] bool has_scan() const noexcept { return loaded.scan.width_px > 0; }
};

}  // namespace flatpose::port
