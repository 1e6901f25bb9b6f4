#include "flatpose/locate/pipeline.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "flatpose/core/budget.hpp"
#include "flatpose/locate/contest.hpp"
#include "flatpose/locate/features.hpp"
#include "flatpose/locate/settings.hpp"
#include "flatpose/locate/stopwatch.hpp"
#include "flatpose/locate/workspace.hpp"
#include "flatpose/rectify/survey.hpp"

namespace flatpose::locate {
namespace {

// Below this share of valid points a scan says nothing about what is there.
constexpr double kValidShareMin = 0.02;

// What of the work frame a box of the face's x and y may cover at the heights of the scan: the box
// stands along the face's z, which need not be the work's.
rectify::Region region_in_work(const Box& box, const Pose& work_T_face,
                               const rectify::Survey& survey, double margin_mm) noexcept {
  constexpr double kUprightMin = 0.1;
  const Vec3 along = work_T_face.rotation.column(2);
  rectify::Region all;
  if (survey.valid_count == 0 || !(std::fabs(along.z) > kUprightMin)) return all;
  Vec3 low{1e300, 1e300, 0.0};
  Vec3 high{-1e300, -1e300, 0.0};
  for (const double x_mm : {box.x0_mm, box.x1_mm}) {
    for (const double y_mm : {box.y0_mm, box.y1_mm}) {
      const Vec3 corner = work_T_face * Vec3{x_mm, y_mm, 0.0};
      for (const double z_mm : {survey.min_mm.z - margin_mm, survey.max_mm.z + margin_mm}) {
        const Vec3 p = corner + ((z_mm - corner.z) / along.z) * along;
        low = {std::min(low.x, p.x), std::min(low.y, p.y), 0.0};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), 0.0};
      }
    }
  }
  return {low.x - margin_mm, low.y - margin_mm, high.x + margin_mm, high.y + margin_mm};
}

/// One search from scan to result. Lives on the stack of locate().
class Pipeline {
 public:
  Pipeline(const model::Template& part, const RangeImageView& scan, const Frames& frames,
           const LocateConfig& config, const Limits& limits, const Host& host, Arena& arena,
           LocateResult& result) noexcept
      : part_(part),
        scan_(scan),
        frames_(frames),
        config_(config),
        limits_(limits),
        arena_(arena),
        result_(result),
        watch_(host.clock),
        budget_(host,
                config.deadline_us > 0 ? watch_.start_us() + config.deadline_us : Budget::kNoEnd) {}

  Status run() noexcept {
    Status s = run_stages();
    if (s == Status::kStopped) s = Status::kOk;  // an outcome, and what was found until then counts
    report();
    result_.timings.total_us = watch_.total_us();
    result_.peak_bytes = arena_.peak_bytes();
    return s;
  }

 private:
  Status run_stages() noexcept {
    if (const Status s = look(); s != Status::kOk || is_over_) return s;
    if (const Status s = build_images(); s != Status::kOk) return s;
    return contest();
  }

  // Survey the scan, choose the grid, rectify and find edges.
  Status look() noexcept {
    const Result<rectify::Survey> survey =
        rectify::survey(scan_, frames_.work_T_scan, arena_, limits_.vector_path, budget_);
    if (!survey) return survey.status();
    if (1.0 - survey->missing_share < kValidShareMin) return end(Outcome::kScanPoor);
    const double pitch_mm = std::max(survey->pitch_along_row_mm, survey->pitch_along_column_mm);
    if (!(pitch_mm > 0.0)) return end(Outcome::kScanPoor);
    // A map finer than the scan shows nothing more.
    constexpr double kCellsPerPitch = 0.75;
    const double cell_mm = std::max(config_.cell_mm > 0.0 ? config_.cell_mm : part_.cell_mm,
                                    kCellsPerPitch * pitch_mm);
    const Result<rectify::Grid> grid = choose_grid(*survey, cell_mm);
    if (!grid)
      return grid.status() == Status::kTooFewPoints ? end(Outcome::kScanPoor) : grid.status();

    const double noise_mm = std::max({survey->noise_sigma_mm, 0.01 * pitch_mm, 0.02 * cell_mm});
    settings_ = derive_settings(part_, config_, noise_mm, pitch_mm, cell_mm);
    settings_.search.vector_path = limits_.vector_path;
    bound_origins(cell_mm);
    settings_.scene.vector_path = limits_.vector_path;
    settings_.polish.vector_path = limits_.vector_path;
    scene::SceneConfig scene_config = settings_.scene;
    scene_config.reach = &survey->reach;
    const Status s =
        scene::build_scene(scan_, frames_, *grid, scene_config, arena_, scene_, budget_);
    result_.timings.rectify_us = watch_.lap_us();
    if (s == Status::kTooFewPoints) return end(Outcome::kScanPoor);  // points, but no surface
    if (s != Status::kOk) return s;
    // Fewer edges than a quarter of the contour: an empty floor.
    constexpr double kContourShareMin = 0.25;
    const double contour_px = std::sqrt(part_.area_mm2) * 3.5 / cell_mm;
    return static_cast<double>(scene_.edges.size()) < kContourShareMin * contour_px
               ? end(Outcome::kEmptyScene)
               : Status::kOk;
  }

  Result<rectify::Grid> choose_grid(const rectify::Survey& survey, double cell_mm) const noexcept {
    rectify::GridConfig grid_config;
    grid_config.cell_mm = cell_mm;
    grid_config.cells_max = limits_.cell_count;
    if (config_.region.kind != Region::Kind::kAll) {
      // The region bounds the origin; the part may reach beyond it, but not beyond the scan.
      grid_config.region = region_in_work(bounding_box(config_.region), frames_.work_T_face(),
                                          survey, 2.0 * part_.radius_mm);
    }
    const Result<rectify::Grid> grid = rectify::choose_grid(survey, grid_config);
    if (grid && (grid->width_px > kMapSideMax_px || grid->height_px > kMapSideMax_px))
      return Status::kTooLarge;
    return grid;
  }

  // The tilt read off an anchor is off by some degrees at worst, its place by a step of the
  // lattice.
  void bound_origins(double cell_mm) noexcept {
    constexpr double kTiltError_rad = 0.1;
    constexpr double kInfinite = std::numeric_limits<double>::infinity();
    settings_.origins = {frames_.face_T_work, config_.height_min_mm, config_.height_max_mm,
                         config_.exclusions};
    if (config_.exclusions.empty() && config_.height_min_mm == -kInfinite &&
        config_.height_max_mm == kInfinite)
      return;
    double lever_mm = 0.0;
    for (int i = 0; i < part_.anchor_count; ++i) {
      const model::Anchor& anchor = part_.anchors[i];
      lever_mm = std::max(lever_mm, std::sqrt(static_cast<double>(anchor.x_mm) * anchor.x_mm +
                                              static_cast<double>(anchor.y_mm) * anchor.y_mm));
    }
    const double turn_error_rad = std::max(settings_.search.angle_step_rad, kTiltError_rad);
    settings_.search.origins = &settings_.origins;
    settings_.search.origin_margin_mm =
        4.0 * settings_.places.stride_px * cell_mm + turn_error_rad * lever_mm;
  }

  Status build_images() noexcept {
    work_ = take_workspace(arena_, scene_.map.grid);
    if (arena_.failed()) return Status::kOutOfMemory;
    const Status s = build_features(scene_, settings_, arena_, budget_, work_);
    result_.timings.features_us = watch_.lap_us();
    return s;
  }

  // Anchor after anchor until there is enough beyond doubt, or no more time.
  Status contest() noexcept {
    const refine::RawScan raw{scan_, frames_.work_T_scan, &scene_.map};
    Contest contest({part_, frames_, config_, settings_, raw}, work_, budget_, watch_, result_);
    for (int anchor = 0; anchor < part_.anchor_count && !budget_.was_over(); ++anchor) {
      if (anchor > 0 && contest.has_enough()) break;
      const Result<search::GridSearchResult> found = search(anchor);
      if (found.status() == Status::kStopped) break;
      if (!found) return found.status();
      contest.enter(work_.candidates.first(static_cast<std::size_t>(found->candidate_count)));
    }
    contest.accept();
    is_ambiguous_ = contest.is_ambiguous();
    return Status::kOk;
  }

  Result<search::GridSearchResult> search(int anchor) noexcept {
    const auto wanted =
        static_cast<std::size_t>(std::min(kCandidateCountMax, 42 + 6 * config_.max_matches));
    const Result<search::GridSearchResult> found =
        search::grid_search(work_.coarse, work_.tilt, work_.places, part_, anchor, settings_.search,
                            arena_, work_.candidates.first(wanted), budget_);
    result_.timings.search_us += watch_.lap_us();
    if (!found) return found;
    result_.hypothesis_count += found->hypothesis_count;
    result_.evaluated_count += found->evaluated_count;
    result_.candidate_count += found->candidate_count;
    return found;
  }

  void report() noexcept {
    if (is_over_) return;
    if (budget_.was_over()) return report_stopped();
    if (result_.match_count == 0) {
      result_.outcome = Outcome::kNoMatch;
    } else {
      result_.outcome = is_ambiguous_ ? Outcome::kAmbiguous : Outcome::kOk;
    }
  }

  void report_stopped() noexcept {
    if (budget_.was_cancelled()) result_.match_count = 0;
    result_.outcome = budget_.was_cancelled() ? Outcome::kCancelled : Outcome::kDeadline;
    result_.is_exact = false;
    // No score is above one, and the search's costs bound no score.
    double best_score = 0.0;
    for (const Match& match : result_.found()) best_score = std::max(best_score, match.score);
    result_.bound_gap = 1.0 - best_score;
  }

  Status end(Outcome outcome) noexcept {
    result_.outcome = outcome;
    is_over_ = true;
    return Status::kOk;
  }

  const model::Template& part_;
  const RangeImageView& scan_;
  const Frames& frames_;
  const LocateConfig& config_;
  const Limits& limits_;
  Arena& arena_;
  LocateResult& result_;
  Stopwatch watch_;
  Budget budget_;
  Settings settings_;
  scene::Scene scene_;
  Workspace work_;
  bool is_over_ = false;  // before the search: there is nothing to search in
  bool is_ambiguous_ = false;
};

}  // namespace

Status run_pipeline(const model::Template& part, const RangeImageView& scan, const Frames& frames,
                    const LocateConfig& config, const Limits& limits, const Host& host,
                    Arena& arena, LocateResult& result) noexcept {
  return Pipeline(part, scan, frames, config, limits, host, arena, result).run();
}

}  // namespace flatpose::locate
