#include "flatpose/locate/locator.hpp"

#include <algorithm>
#include <cmath>

#include "flatpose/core/maths.hpp"
#include "flatpose/locate/settings.hpp"
#include "flatpose/locate/workspace.hpp"
#include "flatpose/model/equivalents.hpp"
#include "flatpose/model/template_file.hpp"
#include "flatpose/rectify/survey.hpp"

namespace flatpose::locate {
namespace {

// Below this share of valid points a scan says nothing about what is there.
constexpr double kValidShareMin = 0.02;
// What is this far below the threshold does not rise above it any more.
constexpr double kHopelessShare = 0.6;
// Matches may share this much of their visible surface: what leans on each other, not what lies in
// each other.
constexpr double kClaimedShareMax = 0.3;

/// One search from scan to result. Lives on the stack of locate().
class Pipeline {
 public:
  Pipeline(const model::Template& part, const RangeImageView& scan, const Frames& frames,
           const LocateConfig& config, const Limits& limits, const Clock& clock, Arena& arena,
           LocateResult& result) noexcept
      : part_(part),
        scan_(scan),
        frames_(frames),
        config_(config),
        limits_(limits),
        clock_(clock),
        arena_(arena),
        result_(result),
        start_us_(clock.now_us()),
        lap_us_(start_us_) {}

  Status run() noexcept {
    const Status s = run_stages();
    result_.timings.total_us = clock_.now_us() - start_us_;
    result_.peak_bytes = arena_.peak_bytes();
    return s;
  }

 private:
  Status run_stages() noexcept {
    if (const Status s = look(); s != Status::kOk || is_over_) return s;
    if (const Status s = build_images(); s != Status::kOk) return s;
    for (int anchor = 0; anchor < part_.anchor_count; ++anchor) {
      if (anchor > 0 && (accepted_count_ >= config_.max_matches || is_late())) break;
      if (const Status s = search(anchor); s != Status::kOk) return s;
      refine_all();
      accept();
    }
    report();
    return Status::kOk;
  }

  // Survey the scan, choose the grid, rectify and find edges.
  Status look() noexcept {
    const Result<rectify::Survey> survey = rectify::survey(scan_, frames_.work_T_scan, arena_);
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
    const Status s = scene::build_scene(scan_, frames_, *grid, settings_.scene, arena_, scene_);
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
    Status s = refine::build_fine_images(scene_, arena_, work_.fine);
    if (s != Status::kOk) return s;
    s = search::build_search_images(scene_, settings_.verify.height_tolerance_mm, arena_,
                                    work_.coarse);
    if (s != Status::kOk) return s;
    s = search::fit_tilt_field(work_.coarse.filled_mm, work_.coarse.grid.cell_mm,
                               settings_.tilt_radius_px, arena_, work_.tilt);
    for (int y = 0; y < work_.claimed.height_px; ++y)
      std::fill_n(work_.claimed.row(y), work_.claimed.width_px, 0);
    result_.timings.features_us = lap();
    return s;
  }

  Status search(int anchor) noexcept {
    const std::size_t wanted =
        static_cast<std::size_t>(std::min(kCandidateCountMax, 24 + 6 * config_.max_matches));
    const Result<search::GridSearchResult> found =
        search::grid_search(work_.coarse, work_.tilt, part_, anchor, settings_.search, arena_,
                            work_.candidates.first(wanted));
    if (!found) return found.status();
    candidate_count_ = found->candidate_count;
    result_.hypothesis_count += found->hypothesis_count;
    result_.candidate_count += candidate_count_;
    result_.timings.search_us += lap();
    return Status::kOk;
  }

  // Levenberg-Marquardt from every candidate; what comes to the same pose is kept once.
  void refine_all() noexcept {
    const refine::PoseProblem wide(part_, work_.fine, settings_.wide);
    const refine::PoseProblem narrow(part_, work_.fine, settings_.narrow);
    refine::LevenbergMarquardtConfig lm;
    lm.iteration_limit = 15;
    lm.step_tolerance = 1e-5;
    lm.cost_tolerance = 1e-5;
    instance_count_ = 0;
    for (int i = 0; i < candidate_count_ && !is_late(); ++i) {
      // A candidate that does not hold even loosely is not worth its refinement.
      const Pose& start = work_.candidates[i].work_T_object;
      if (verify(part_, work_.fine, {}, start, settings_.screen).score <
          kHopelessShare * settings_.score_threshold) {
        continue;
      }
      const auto first = refine::minimize<6>(wide, start, lm);
      const auto second = refine::minimize<6>(narrow, first.x, lm);
      if (is_known(second.x)) continue;
      Instance& instance = work_.instances[instance_count_++];
      instance.work_T_object = second.x;
      instance.verification = verify(part_, work_.fine, {}, second.x, settings_.verify);
    }
    std::sort(work_.instances.begin(), work_.instances.begin() + instance_count_, precedes);
    result_.timings.refine_us += lap();
  }

  [[nodiscard]] bool is_known(const Pose& pose) const noexcept {
    const double near_mm = 2.0 * scene_.map.grid.cell_mm;
    for (int i = 0; i < instance_count_; ++i) {
      const Pose& other = work_.instances[i].work_T_object;
      const bool near =
          norm(other.position_mm - pose.position_mm) < near_mm &&
          angle_between_rad(other.rotation, pose.rotation) * part_.radius_mm < near_mm;
      if (near) return true;
    }
    return false;
  }

  static double rank(const Verification& v) noexcept { return v.score * v.visible; }

  static bool precedes(const Instance& a, const Instance& b) noexcept {
    if (rank(a.verification) != rank(b.verification))
      return rank(a.verification) > rank(b.verification);
    const Vec3& p = a.work_T_object.position_mm;
    const Vec3& q = b.work_T_object.position_mm;
    if (p.x != q.x) return p.x < q.x;
    if (p.y != q.y) return p.y < q.y;
    return a.work_T_object.rotation.m < b.work_T_object.rotation.m;
  }

  // The last step on the raw points, and the verdict, best first.
  void accept() noexcept {
    for (int i = 0; i < instance_count_ && accepted_count_ < config_.max_matches && !is_late();
         ++i) {
      const Instance& instance = work_.instances[i];
      if (instance.verification.score < kHopelessShare * settings_.score_threshold) {
        note_rejected(instance.verification.score);
        continue;
      }
      const refine::RawScan raw{scan_, frames_.work_T_scan, &scene_.map};
      const Result<refine::PolishResult> polished =
          refine::polish(part_, raw, instance.work_T_object, settings_.polish, work_.crossings);
      if (polished) consider(*polished);
    }
    result_.timings.verify_us += lap();
  }

  void note_rejected(double score) noexcept {
    result_.best_rejected_score = std::max(result_.best_rejected_score, score);
  }

  void consider(const refine::PolishResult& polished) noexcept {
    const Pose& pose = polished.work_T_object;
    const Verification v = verify(part_, work_.fine, work_.claimed, pose, settings_.verify);
    if (v.surface.claimed_count > kClaimedShareMax * v.surface.visible_count) {
      note_rival(v.score, pose);
      return;
    }
    if (v.score < settings_.score_threshold || v.visible < config_.min_visible ||
        !is_allowed(pose)) {
      note_rejected(v.score);
      return;
    }
    result_.matches[accepted_count_++] = to_match(polished, v);
    claim(part_, work_.fine, pose, settings_.verify, work_.claimed);
  }

  /// A second pose in the place of a match that is no equivalent of it.
  void note_rival(double score, const Pose& work_T_object) noexcept {
    constexpr double kScoreGap = 0.02;
    constexpr double kAngleGap_rad = 10.0 * kRadPerDeg;
    // The nearest match is the one whose place it takes; seen from there, turned by the symmetry as
    // little as can be.
    Pose match_T_rival;
    int nearest = -1;
    for (int i = 0; i < accepted_count_; ++i) {
      const Pose relative = model::canonical_equivalent(
          result_.matches[i].face_T_object.inverse() * (frames_.face_T_work * work_T_object),
          part_.symmetry);
      if (nearest >= 0 && norm(relative.position_mm) >= norm(match_T_rival.position_mm)) continue;
      match_T_rival = relative;
      nearest = i;
    }
    if (nearest < 0 || norm(match_T_rival.position_mm) >= part_.radius_mm) return;
    if (angle_between_rad(match_T_rival.rotation, Rotation{}) <= kAngleGap_rad) return;
    result_.rival_score = std::max(result_.rival_score, score);
    is_ambiguous_ |= nearest == 0 && score > result_.matches[0].score - kScoreGap;
  }

  [[nodiscard]] bool is_allowed(const Pose& work_T_object) const noexcept {
    if (arc_cosine(work_T_object.rotation.m[8]) > config_.max_tilt_rad) return false;
    const Vec3 origin_mm = (frames_.face_T_work * work_T_object).position_mm;
    return config_.region.contains(origin_mm.x, origin_mm.y);
  }

  [[nodiscard]] Match to_match(const refine::PolishResult& polished,
                               const Verification& v) const noexcept {
    Match match;
    match.face_T_object =
        model::canonical_equivalent(frames_.face_T_work * polished.work_T_object, part_.symmetry);
    match.score = v.score;
    match.visible = v.visible;
    match.turn_is_free = polished.turn_is_free;
    match.edge_rms_mm = polished.edge_rms_mm;
    match.surface_rms_mm = polished.surface_rms_mm;
    const auto& c = polished.covariance;
    match.sigma_rad = {std::sqrt(c(0, 0)), std::sqrt(c(1, 1)), std::sqrt(c(2, 2))};
    const Rotation& r = match.face_T_object.rotation;
    const auto variance_along = [&](int axis) {
      double sum = 0.0;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) sum += r.m[3 * axis + i] * c(3 + i, 3 + j) * r.m[3 * axis + j];
      return sum;
    };
    match.sigma_mm = {std::sqrt(variance_along(0)), std::sqrt(variance_along(1)),
                      std::sqrt(variance_along(2))};
    return match;
  }

  void report() noexcept {
    result_.match_count = accepted_count_;
    const auto key = [this](const Match& m) {
      switch (config_.order) {
        case Order::kScore: return m.score * m.visible;
        case Order::kHeight: return (frames_.work_T_face() * m.face_T_object.position_mm).z;
        case Order::kVisible: return m.visible;
      }
      return 0.0;
    };
    // Insertion keeps equals in the order they were accepted, and needs no memory.
    for (int i = 1; i < accepted_count_; ++i) {
      const Match match = result_.matches[i];
      int at = i;
      for (; at > 0 && key(match) > key(result_.matches[at - 1]); --at)
        result_.matches[at] = result_.matches[at - 1];
      result_.matches[at] = match;
    }
    if (is_late()) {
      result_.outcome = Outcome::kDeadline;
    } else if (accepted_count_ == 0) {
      result_.outcome = Outcome::kNoMatch;
    } else {
      result_.outcome = is_ambiguous_ ? Outcome::kAmbiguous : Outcome::kOk;
    }
  }

  Status end(Outcome outcome) noexcept {
    result_.outcome = outcome;
    is_over_ = true;
    return Status::kOk;
  }

  [[nodiscard]] bool is_late() const noexcept {
    return config_.deadline_us > 0 && clock_.now_us() - start_us_ >= config_.deadline_us;
  }

  std::int64_t lap() noexcept {
    const std::int64_t now_us = clock_.now_us();
    const std::int64_t lap_us = now_us - lap_us_;
    lap_us_ = now_us;
    return lap_us;
  }

  const model::Template& part_;
  const RangeImageView& scan_;
  const Frames& frames_;
  const LocateConfig& config_;
  const Limits& limits_;
  const Clock& clock_;
  Arena& arena_;
  LocateResult& result_;
  Settings settings_;
  scene::Scene scene_;
  Workspace work_;
  int candidate_count_ = 0;
  int instance_count_ = 0;
  int accepted_count_ = 0;
  bool is_over_ = false;
  bool is_ambiguous_ = false;
  std::int64_t start_us_;
  std::int64_t lap_us_;
};

bool is_valid(const Limits& limits) noexcept {
  constexpr int kSideMax_px = 1 << 15;
  constexpr int kCellCountMax = kMapSideMax_px * kMapSideMax_px;
  return limits.scan_width_px >= 2 && limits.scan_width_px <= kSideMax_px &&
         limits.scan_height_px >= 2 && limits.scan_height_px <= kSideMax_px &&
         limits.cell_count >= 1 && limits.cell_count <= kCellCountMax;
}

}  // namespace

std::size_t Locator::required_bytes(const Limits& limits) noexcept {
  return is_valid(limits) ? workspace_required_bytes(limits) : 0;
}

Status Locator::init(const Limits& limits, std::span<std::byte> memory) noexcept {
  if (!is_valid(limits)) return Status::kInvalidArgument;
  if (memory.size() < required_bytes(limits)) return Status::kOutOfMemory;
  limits_ = limits;
  arena_ = Arena(memory);
  return Status::kOk;
}

Status Locator::locate(const model::Template& part, const RangeImageView& scan,
                       const Frames& frames, const LocateConfig& config, const Clock& clock,
                       LocateResult& result) noexcept {
  result = LocateResult{};
  if (const Status s = validate(config); s != Status::kOk) return s;
  if (!model::is_valid(part)) return Status::kInvalidArgument;
  if (scan.width_px > limits_.scan_width_px || scan.height_px > limits_.scan_height_px)
    return Status::kTooLarge;
  const ArenaScope scope(arena_);
  return Pipeline(part, scan, frames, config, limits_, clock, arena_, result).run();
}

}  // namespace flatpose::locate
