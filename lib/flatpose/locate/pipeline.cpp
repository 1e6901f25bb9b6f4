#include "flatpose/locate/pipeline.hpp"

#include <algorithm>
#include <cmath>

#include "flatpose/core/maths.hpp"
#include "flatpose/locate/acceptance.hpp"
#include "flatpose/locate/features.hpp"
#include "flatpose/locate/pose_set.hpp"
#include "flatpose/locate/refinement.hpp"
#include "flatpose/locate/settings.hpp"
#include "flatpose/locate/workspace.hpp"
#include "flatpose/rectify/survey.hpp"

namespace flatpose::locate {
namespace {

// Below this share of valid points a scan says nothing about what is there.
constexpr double kValidShareMin = 0.02;
// Candidates that are refined before it is asked whether there are enough.
constexpr int kRoundCount = 4;
// No polish makes so much of a pose.
constexpr double kPolishGain = 0.3;

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
        host_(host),
        arena_(arena),
        result_(result),
        verifier_(part),
        refinement_(part, work_.fine, settings_, verifier_),
        acceptance_(part, frames, config, settings_, verifier_, work_.fine, work_.claimed, result),
        start_us_(host.clock.now_us()),
        lap_us_(start_us_) {}

  Status run() noexcept {
    const Status s = run_stages();
    result_.timings.total_us = host_.clock.now_us() - start_us_;
    result_.peak_bytes = arena_.peak_bytes();
    return s;
  }

 private:
  Status run_stages() noexcept {
    if (const Status s = look(); s != Status::kOk || is_over_) return s;
    if (const Status s = build_images(); s != Status::kOk) return s;
    for (int anchor = 0; anchor < part_.anchor_count; ++anchor) {
      if (anchor > 0 && (has_enough() || is_late())) break;
      if (const Status s = search(anchor); s != Status::kOk) return s;
      refine_and_polish();
    }
    accept();
    report();
    return Status::kOk;
  }

  // Survey the scan, choose the grid, rectify and find edges.
  Status look() noexcept {
    const Result<rectify::Survey> survey =
        rectify::survey(scan_, frames_.work_T_scan, arena_, limits_.vector_path, host_.executor);
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
    settings_.scene.vector_path = limits_.vector_path;
    settings_.polish.vector_path = limits_.vector_path;
    scene::SceneConfig scene_config = settings_.scene;
    scene_config.reach = &survey->reach;
    const Status s =
        scene::build_scene(scan_, frames_, *grid, scene_config, arena_, scene_, host_.executor);
    result_.timings.rectify_us = lap();
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
      const Box box = bounding_box(config_.region);
      const Vec3 a = frames_.work_T_face() * Vec3{box.x0_mm, box.y0_mm, 0.0};
      const Vec3 b = frames_.work_T_face() * Vec3{box.x1_mm, box.y1_mm, 0.0};
      grid_config.region = {std::min(a.x, b.x), std::min(a.y, b.y), std::max(a.x, b.x),
                            std::max(a.y, b.y)};
      // The region bounds the origin; the part may reach beyond it.
      grid_config.margin_mm = 2.0 * part_.radius_mm;
    }
    const Result<rectify::Grid> grid = rectify::choose_grid(survey, grid_config);
    if (grid && (grid->width_px > kMapSideMax_px || grid->height_px > kMapSideMax_px))
      return Status::kTooLarge;
    return grid;
  }

  Status build_images() noexcept {
    work_ = take_workspace(arena_, scene_.map.grid);
    if (arena_.failed()) return Status::kOutOfMemory;
    // Starts that are no farther apart than the search's steps lead to the same pose.
    const double place_step_mm = settings_.places.stride_px * work_.coarse.grid.cell_mm;
    instances_ = Instances(work_.instances);
    tried_ = PoseSet(work_.starts, place_step_mm, settings_.search.angle_step_rad);
    const Status s = build_features(scene_, settings_, arena_, host_.executor, work_);
    result_.timings.features_us = lap();
    return s;
  }

  Status search(int anchor) noexcept {
    const auto wanted =
        static_cast<std::size_t>(std::min(kCandidateCountMax, 42 + 6 * config_.max_matches));
    const Result<search::GridSearchResult> found =
        search::grid_search(work_.coarse, work_.tilt, work_.places, part_, anchor, settings_.search,
                            arena_, work_.candidates.first(wanted), host_.executor);
    if (!found) return found.status();
    candidate_count_ = found->candidate_count;
    result_.hypothesis_count += found->hypothesis_count;
    result_.evaluated_count += found->evaluated_count;
    result_.candidate_count += candidate_count_;
    result_.timings.search_us += lap();
    return Status::kOk;
  }

  // Best candidates first, in rounds: when enough are beyond doubt, of the rest only those count
  // that may turn out to be better in the place of one.
  void refine_and_polish() noexcept {
    bool is_enough = false;
    for (int begin = 0; begin < candidate_count_ && !is_late(); begin += kRoundCount) {
      refine(begin, std::min(begin + kRoundCount, candidate_count_), is_enough);
      polish_best();
      is_enough = has_enough();
    }
  }

  // What comes to the same pose is kept once.
  void refine(int begin, int end, bool only_rivals) noexcept {
    std::array<Pose, kRoundCount> starts;
    int count = 0;
    for (int i = begin; i < end; ++i) {
      const Pose& start = work_.candidates[i].work_T_object;
      // What lies on a part beyond doubt is that part.
      if (is_explained(work_.candidates[i]) || (only_rivals && !is_rival(start)) ||
          tried_.contains(start))
        continue;
      starts[count++] = start;
    }
    std::array<Refined, kRoundCount> refined;
    auto refine_one = [&](int i) { refined[i] = refinement_(starts[i]); };
    for_each_chunk(host_.executor, count, refine_one);
    const double near_mm = 2.0 * scene_.map.grid.cell_mm;
    for (int i = 0; i < count; ++i) {
      if (!refined[i].is_moved) continue;
      const Pose& pose = refined[i].work_T_object;
      tried_.add(starts[i]);
      if (refined[i].verification.score >= settings_.score_threshold) tried_.add(pose);
      if (refined[i].is_found && !instances_.is_full() &&
          !instances_.contains(pose, near_mm, part_.radius_mm))
        instances_.add(pose, refined[i].verification);
    }
    instances_.sort();
    result_.timings.refine_us += lap();
  }

  // Whether a start lies in the place of a part beyond doubt.
  [[nodiscard]] bool is_rival(const Pose& start) const noexcept {
    for (int i = 0; i < instances_.count(); ++i) {
      const Instance& instance = instances_[i];
      if (is_beyond_doubt(instance) && is_same_place(instance.work_T_object, start)) return true;
    }
    return false;
  }

  // The last step for those likely to be asked for: what they are worth on the raw points decides
  // over their order.
  void polish_best() noexcept {
    const int wanted = 6 + 2 * config_.max_matches;
    int count = 0;
    for (int i = 0; i < instances_.count() && count < wanted && !is_late(); ++i) {
      if (has_enough()) break;
      count += polish(instances_[i]) ? 1 : 0;
    }
    instances_.sort();
    result_.timings.verify_us += lap();
  }

  [[nodiscard]] bool is_beyond_doubt(const Instance& instance) const noexcept {
    constexpr double kShare = 0.95;
    // One that is hardly visible enough does not end the search: a better one may lie in the open.
    constexpr double kVisibleMargin = 0.05;
    return instance.is_polished && instance.verification.score >= kShare * part_.self_score &&
           instance.verification.visible >= config_.min_visible + kVisibleMargin &&
           acceptance_.judge(instance.polished, instance.verification) == Verdict::kMatch;
  }

  // Whether as many as are asked for are beyond doubt, each in a place of its own: other anchors
  // are not searched then.
  [[nodiscard]] bool has_enough() const noexcept {
    int count = 0;
    for (int i = 0; i < instances_.count(); ++i) {
      if (!is_beyond_doubt(instances_[i])) continue;
      bool is_new = true;
      for (int j = 0; j < i && is_new; ++j)
        is_new = !is_same_place(instances_[j].work_T_object, instances_[i].work_T_object);
      count += is_new ? 1 : 0;
    }
    return count >= config_.max_matches;
  }

  // Whether the candidate's anchor stands on the surface of a part that an earlier anchor has found
  // beyond doubt. (Poses from one anchor compete: a turned part stands in its own place.)
  [[nodiscard]] bool is_explained(const search::Candidate& candidate) const noexcept {
    if (candidate.anchor == 0) return false;
    const model::Anchor& anchor = part_.anchors[candidate.anchor];
    const Vec3 p_work_mm = candidate.work_T_object * Vec3{anchor.x_mm, anchor.y_mm, 0.0};
    for (int i = 0; i < instances_.count(); ++i) {
      const Instance& instance = instances_[i];
      if (is_beyond_doubt(instance) &&
          is_on_surface(instance.polished.work_T_object.inverse() * p_work_mm)) {
        return true;
      }
    }
    return false;
  }

  [[nodiscard]] bool is_on_surface(const Vec3& p_object_mm) const noexcept {
    const double spacing_mm = std::sqrt(part_.area_mm2 / std::max(1, part_.surface_count));
    for (const model::SurfacePoint& p : part_.surface_points()) {
      const Vec3 apart = p_object_mm - Vec3{p.x_mm, p.y_mm, p.z_mm};
      if (std::fabs(apart.x) <= spacing_mm && std::fabs(apart.y) <= spacing_mm &&
          std::fabs(apart.z) <= settings_.verify.surface_tolerance_mm) {
        return true;
      }
    }
    return false;
  }

  // The last step on the raw points, and the verdict, best first. A match explains why the contour
  // of a part that adjoins it cannot be seen there, so those left are looked at again while there
  // are new ones.
  void accept() noexcept {
    constexpr int kRoundsMax = kMatchCountMax;
    bool has_new = true;
    for (int round = 0; has_new && round < kRoundsMax; ++round) {
      has_new = false;
      for (int i = 0; i < instances_.count() && !acceptance_.is_full() && !is_late(); ++i)
        has_new |= consider(i);
    }
    result_.timings.verify_us += lap();
  }

  // Of the poses in the place of the next, the one that is best on the raw points: a part that is
  // nearly symmetric is often told from its turned self by these alone.
  bool consider(int index) noexcept {
    if (!polish(instances_[index])) return false;
    int best = index;
    for (int i = index + 1; i < instances_.count(); ++i) {
      if (is_same_place(instances_[i].work_T_object, instances_[index].work_T_object) &&
          instances_[i].rank() + kPolishGain > instances_[best].rank() && polish(instances_[i]) &&
          instances_[i].rank() > instances_[best].rank()) {
        best = i;
      }
    }
    bool has_new = false;
    for (const int i : {best, index}) {
      Instance& instance = instances_[i];
      if (!instance.is_open || !has_news(instance)) continue;
      instance.judged_at = result_.match_count;
      const Verdict verdict = acceptance_.consider(instance.polished, instance.verification);
      if (verdict == Verdict::kGuess) {
        close_place_of(instance);
        return has_new;
      }
      instance.is_open = verdict != Verdict::kMatch;
      has_new |= verdict == Verdict::kMatch;
    }
    return has_new;
  }

  // Whether a verdict on it may be another than last time.
  [[nodiscard]] bool has_news(const Instance& instance) const noexcept {
    return instance.judged_at < 0 ||
           acceptance_.is_claimed_near(instance.polished.work_T_object.position_mm,
                                       instance.judged_at);
  }

  // Where the best that fits is a guess, what fits less is none the better.
  void close_place_of(const Instance& guess) noexcept {
    for (int i = 0; i < instances_.count(); ++i) {
      Instance& instance = instances_[i];
      if (instance.rank() <= guess.rank() &&
          is_same_place(instance.work_T_object, guess.work_T_object))
        instance.is_open = false;
    }
  }

  [[nodiscard]] bool is_same_place(const Pose& a, const Pose& b) const noexcept {
    constexpr double kShare = 0.3;
    return norm(a.position_mm - b.position_mm) < kShare * part_.radius_mm;
  }

  /// Whether the instance is still in question; it is polished then.
  bool polish(Instance& instance) noexcept {
    if (!instance.is_open || instance.is_polished) return instance.is_open;
    instance.is_open = instance.verification.score >= kHopelessShare * settings_.score_threshold;
    if (!instance.is_open) {
      acceptance_.note_rejected(instance.verification.score);
      return false;
    }
    const refine::RawScan raw{scan_, frames_.work_T_scan, &scene_.map};
    const Result<refine::PolishResult> polished = refine::polish(
        part_, raw, instance.work_T_object, settings_.polish, work_.polish, host_.executor);
    instance.is_open = polished.status() == Status::kOk;
    if (!instance.is_open) return false;
    instance.polished = *polished;
    instance.is_polished = true;
    instance.verification =
        verifier_.verify(work_.fine, {}, polished->work_T_object, settings_.verify);
    return true;
  }

  void report() noexcept {
    acceptance_.sort();
    if (is_late()) {
      result_.outcome = Outcome::kDeadline;
      result_.is_exact = false;
      // No score is above one, and the search's costs bound no score.
      double best_score = 0.0;
      for (const Match& match : result_.found()) best_score = std::max(best_score, match.score);
      result_.bound_gap = 1.0 - best_score;
    } else if (result_.match_count == 0) {
      result_.outcome = Outcome::kNoMatch;
    } else {
      result_.outcome = acceptance_.is_ambiguous() ? Outcome::kAmbiguous : Outcome::kOk;
    }
  }

  Status end(Outcome outcome) noexcept {
    result_.outcome = outcome;
    is_over_ = true;
    return Status::kOk;
  }

  [[nodiscard]] bool is_late() const noexcept {
    return config_.deadline_us > 0 && host_.clock.now_us() - start_us_ >= config_.deadline_us;
  }

  std::int64_t lap() noexcept {
    const std::int64_t now_us = host_.clock.now_us();
    const std::int64_t lap_us = now_us - lap_us_;
    lap_us_ = now_us;
    return lap_us;
  }

  const model::Template& part_;
  const RangeImageView& scan_;
  const Frames& frames_;
  const LocateConfig& config_;
  const Limits& limits_;
  const Host& host_;
  Arena& arena_;
  LocateResult& result_;
  Settings settings_;
  scene::Scene scene_;
  Workspace work_;
  Verifier verifier_;
  Refinement refinement_;
  Acceptance acceptance_;
  Instances instances_;
  PoseSet tried_;
  int candidate_count_ = 0;
  bool is_over_ = false;
  std::int64_t start_us_;
  std::int64_t lap_us_;
};

}  // namespace

Status run_pipeline(const model::Template& part, const RangeImageView& scan, const Frames& frames,
                    const LocateConfig& config, const Limits& limits, const Host& host,
                    Arena& arena, LocateResult& result) noexcept {
  return Pipeline(part, scan, frames, config, limits, host, arena, result).run();
}

}  // namespace flatpose::locate
