#include "flatpose/rectify/survey.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>

#include "flatpose/rectify/row_kernels.hpp"
#include "flatpose/rectify/scan_row.hpp"
#include "flatpose/rectify/slots.hpp"

namespace flatpose::rectify {
namespace {

// ---- the pass over all points ----

Affine affine_of(const Pose& pose) noexcept {
  Affine affine{};
  const double t_mm[] = {pose.position_mm.x, pose.position_mm.y, pose.position_mm.z};
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) affine[4 * i + k] = static_cast<float>(pose.rotation.m[3 * i + k]);
    affine[4 * i + 3] = static_cast<float>(t_mm[i]);
  }
  return affine;
}

Vec3 to_vec3(const std::array<float, 3>& p_mm) noexcept {
  return {static_cast<double>(p_mm[0]), static_cast<double>(p_mm[1]), static_cast<double>(p_mm[2])};
}

void write_extent(const Extent& extent, Survey& out) noexcept {
  out.valid_count = extent.valid_count;
  if (out.valid_count == 0) return;
  out.min_mm = to_vec3(extent.min_mm);
  out.max_mm = to_vec3(extent.max_mm);
  out.missing_share = 1.0 - static_cast<double>(out.valid_count) / out.point_count;
}

// ---- the sample ----

constexpr int kSampleSide = 64;                                // rows and columns sampled, at least
constexpr int kSampleSideMax = 2 * kSampleSide + 1;            // side / (side / 64) is below 128
constexpr double kLowerHalfMean_sigma = 0.32465;               // of a normal distribution
constexpr double kSecondDifferenceSigmas = 2.449489742783178;  // sqrt(1 + 4 + 1)

/// The value that `n` others come before in order; none is negative or NaN, so their bits are in
/// the order of the values. They are counted by their upper, middle and lower bits in turn.
float nth_smallest(std::span<const float> values, std::size_t n) noexcept {
  constexpr int kDigitBits = 11;
  constexpr std::uint32_t kDigits = 1U << kDigitBits;
  std::array<std::uint32_t, kDigits> counts;
  std::uint32_t found = 0, known = 0;  // the bits found, and which they are
  for (const int shift : {21, 10, 0}) {
    counts.fill(0);
    for (const float value : values) {
      const auto bits = std::bit_cast<std::uint32_t>(value);
      if ((bits & known) == found) ++counts[bits >> shift & (kDigits - 1)];
    }
    std::uint32_t digit = 0;
    while (n >= counts[digit]) n -= counts[digit++];
    found |= digit << shift;
    known |= (kDigits - 1) << shift;
  }
  return std::bit_cast<float>(found);
}

/// Values from the rows sampled, each row's in a place of its own: rows may be sampled in any
/// order.
class Sample {
 public:
  explicit Sample(Arena& arena) noexcept
      : values_(arena.take<float>(kSampleSideMax * kSampleSideMax)),
        counts_(arena.take<std::int32_t>(kSampleSideMax)) {
    std::fill(counts_.begin(), counts_.end(), 0);
  }

  void add(int row, double value) noexcept {
    std::int32_t& count = counts_[static_cast<std::size_t>(row)];
    if (std::isfinite(value) && count < kSampleSideMax)
      values_[static_cast<std::size_t>(row * kSampleSideMax + count++)] = static_cast<float>(value);
  }
  /// One close to the other, when all are there.
  void gather() noexcept {
    for (int row = 0; row < kSampleSideMax; ++row) {
      const float* from = values_.data() + row * kSampleSideMax;
      const auto count = static_cast<std::size_t>(counts_[static_cast<std::size_t>(row)]);
      std::copy_n(from, count, values_.data() + count_);
      count_ += count;
    }
  }
  /// 0 for none.
  [[nodiscard]] double median() const noexcept {
    return count_ == 0 ? 0.0 : static_cast<double>(nth_smallest(values_.first(count_), count_ / 2));
  }

  /// Mean of the smaller half; 0 for none.
  [[nodiscard]] double lower_half_mean() const noexcept {
    if (count_ == 0) return 0.0;
    const std::size_t half = (count_ + 1) / 2;
    const float middle = nth_smallest(values_.first(count_), half - 1);
    // The sum must not depend on the order of the values: count in whole nanometres.
    static constexpr double kSteps_per_mm = 1e6;
    static constexpr double kMax_mm = 1e6;
    const auto steps = [](float value) {
      return static_cast<std::int64_t>(std::min(static_cast<double>(value), kMax_mm) *
                                       kSteps_per_mm);
    };
    std::int64_t sum = 0;
    std::size_t below_count = 0;
    for (const float value : values_.first(count_)) {
      const bool is_below = value < middle;
      sum += is_below ? steps(value) : 0;
      below_count += is_below ? 1 : 0;
    }
    sum += static_cast<std::int64_t>(half - below_count) * steps(middle);
    return static_cast<double>(sum) / kSteps_per_mm / static_cast<double>(half);
  }

 private:
  std::span<float> values_;
  std::span<std::int32_t> counts_;  // by row
  std::size_t count_ = 0;
};

struct Samples {
  Sample along_row, along_column, bend_along_row, bend_along_column;
  explicit Samples(Arena& arena) noexcept
      : along_row(arena), along_column(arena), bend_along_row(arena), bend_along_column(arena) {}
  void gather() noexcept {
    for (Sample* sample : {&along_row, &along_column, &bend_along_row, &bend_along_column})
      sample->gather();
  }
};

double distance_xy(const Vec3& a, const Vec3& b) noexcept {
  return std::sqrt((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y));
}

/// The step from pixel p to the next along a direction, and the bend there.
void sample_along(const RangeImageView& scan, const Pose& work_T_scan, const Vec3& p, int column,
                  int row, int right, int down, int sampled_row, Sample& step,
                  Sample& bend) noexcept {
  if (!scan.contains(column + right, row + down)) return;
  const Vec3 next = work_T_scan * scan(column + right, row + down);
  step.add(sampled_row, distance_xy(p, next));
  if (!scan.contains(column - right, row - down)) return;
  const Vec3 last = work_T_scan * scan(column - right, row - down);
  bend.add(sampled_row, std::fabs(last.z - 2.0 * p.z + next.z));
}

/// Samples row r, if it is one of those that are.
void sample_row(const RangeImageView& scan, const Pose& work_T_scan, int r, Samples& out) noexcept {
  const int column_step = std::max(1, scan.width_px / kSampleSide);
  const int row_step = std::max(1, scan.height_px / kSampleSide);
  if (r < 0 || r % row_step != 0) return;
  // Sampled columns move on from row to row, lest a pattern in the columns be all there is.
  for (int c = r / row_step % column_step; c < scan.width_px; c += column_step) {
    const Vec3 p = work_T_scan * scan(c, r);
    sample_along(scan, work_T_scan, p, c, r, 1, 0, r / row_step, out.along_row, out.bend_along_row);
    sample_along(scan, work_T_scan, p, c, r, 0, 1, r / row_step, out.along_column,
                 out.bend_along_column);
  }
}

void add(const Extent& part, Extent& extent) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    extent.min_mm[axis] = std::min(extent.min_mm[axis], part.min_mm[axis]);
    extent.max_mm[axis] = std::max(extent.max_mm[axis], part.max_mm[axis]);
  }
  extent.valid_count += part.valid_count;
  extent.has_wild |= part.has_wild;
}

ScanReach::Box box_of(const Extent& extent) noexcept {
  return {extent.min_mm[0], extent.max_mm[0], extent.min_mm[1], extent.max_mm[1]};
}

// What the box's floats may be off by: some roundings of the terms of a coordinate.
float rounding_mm(const Extent& extent, const Pose& work_T_scan) noexcept {
  constexpr float kRoundings = 1e-5F;
  float most_mm = 2.0F * static_cast<float>(norm(work_T_scan.position_mm));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    most_mm += std::max(std::fabs(extent.min_mm[axis]), std::fabs(extent.max_mm[axis]));
  }
  return kRoundings * most_mm;
}

/// The pass over all points, in chunks of whole groups of rows.
class Surveyor {
 public:
  Surveyor(const RangeImageView& scan, const Pose& work_T_scan, VectorPath path, Samples& samples,
           ScanReach& reach) noexcept
      : scan_(scan),
        work_T_scan_(work_T_scan),
        affine_(affine_of(work_T_scan)),
        kernels_(row_kernels(path)),
        samples_(samples),
        reach_(reach) {
    reach_.scan_height_px = scan.height_px;
  }

  Result<Extent> run(const Budget& budget) noexcept {
    const RowChunks chunks(scan_.height_px, reach_.rows_per_group());
    std::array<Extent, kChunkCountMax> extents;
    auto body = [&](int chunk) {
      extents[static_cast<std::size_t>(chunk)] =
          look(chunks.begin(chunk), chunks.end(chunk), budget);
    };
    if (!for_each_chunk(budget, chunks.count(), body)) return Status::kStopped;
    Extent extent;
    for (const Extent& part : extents) add(part, extent);
    reach_.rounding_mm = rounding_mm(extent, work_T_scan_);
    return extent;
  }

 private:
  Extent look(int row_begin, int row_end, const Budget& budget) noexcept {
    Extent extent;
    const int group_rows = reach_.rows_per_group();
    for (int begin = row_begin; begin < row_end; begin += group_rows) {
      Extent group;
      for (int r = begin; r < std::min(begin + group_rows, row_end); ++r) {
        if (budget.is_over_at(r)) return extent;
        kernels_.add_extent(scan_, r, affine_, group);
        // While it and its neighbours are at hand.
        if (r > row_begin) sample_row(scan_, work_T_scan_, r - 1, samples_);
      }
      reach_.boxes[static_cast<std::size_t>(begin / group_rows)] = box_of(group);
      add(group, extent);
    }
    sample_row(scan_, work_T_scan_, row_end - 1, samples_);
    return extent;
  }

  const RangeImageView& scan_;
  const Pose& work_T_scan_;
  Affine affine_;
  const RowKernels& kernels_;
  Samples& samples_;
  ScanReach& reach_;
};

bool is_within(double value, double low, double high) noexcept {
  return value >= low && value <= high;
}

}  // namespace

std::size_t survey_required_bytes() noexcept {
  Arena arena = Arena::measuring();
  (void)Samples(arena);
  return arena.required_bytes();
}

Result<Survey> survey(const RangeImageView& scan, const Pose& work_T_scan, Arena& scratch,
                      VectorPath path, const Budget& budget) noexcept {
  if (const Status status = check_scan(scan, work_T_scan); status != Status::kOk) return status;
  const ArenaScope scope(scratch);
  Samples samples(scratch);
  if (scratch.failed()) return Status::kOutOfMemory;
  Survey result;
  result.point_count = static_cast<int>(scan.size());
  if (result.point_count == 0) return result;
  const Result<Extent> extent =
      Surveyor(scan, work_T_scan, path, samples, result.reach).run(budget);
  if (!extent) return extent.status();
  if (extent->has_wild) return Status::kNotFinite;
  write_extent(*extent, result);
  samples.gather();
  result.pitch_along_row_mm = samples.along_row.median();
  result.pitch_along_column_mm = samples.along_column.median();
  result.noise_sigma_mm = std::max(samples.bend_along_row.lower_half_mean(),
                                   samples.bend_along_column.lower_half_mean()) /
                          (kLowerHalfMean_sigma * kSecondDifferenceSigmas);
  return result;
}

Result<Grid> choose_grid(const Survey& survey, const GridConfig& config) noexcept {
  const Region& region = config.region;
  if (!is_within(config.cell_mm, 1e-6, 1e6) || !is_within(config.margin_mm, 0.0, 1e6) ||
      !(region.x_min_mm <= region.x_max_mm) || !(region.y_min_mm <= region.y_max_mm))
    return Status::kInvalidArgument;
  if (survey.valid_count == 0) return Status::kTooFewPoints;
  const double x_min_mm = std::max(survey.min_mm.x, region.x_min_mm);
  const double y_min_mm = std::max(survey.min_mm.y, region.y_min_mm);
  const double x_max_mm = std::min(survey.max_mm.x, region.x_max_mm);
  const double y_max_mm = std::min(survey.max_mm.y, region.y_max_mm);
  if (x_min_mm > x_max_mm || y_min_mm > y_max_mm) return Status::kTooFewPoints;
  const double column_begin = std::floor((x_min_mm - config.margin_mm) / config.cell_mm);
  const double row_begin = std::floor((y_min_mm - config.margin_mm) / config.cell_mm);
  // One more than the last cell that holds a point, also one on its upper border.
  const double width_px =
      std::floor((x_max_mm + config.margin_mm) / config.cell_mm) + 1.0 - column_begin;
  const double height_px =
      std::floor((y_max_mm + config.margin_mm) / config.cell_mm) + 1.0 - row_begin;
  if (!(width_px <= kSideMax_px) || !(height_px <= kSideMax_px) ||
      !(width_px * height_px <= config.cells_max))
    return Status::kTooLarge;
  return Grid{(column_begin + 0.5) * config.cell_mm, (row_begin + 0.5) * config.cell_mm,
              config.cell_mm, static_cast<int>(width_px), static_cast<int>(height_px)};
}

}  // namespace flatpose::rectify
