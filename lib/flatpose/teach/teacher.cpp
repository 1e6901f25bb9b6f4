#include "flatpose/teach/teacher.hpp"

#include <algorithm>
#include <cmath>

#include "flatpose/image/canny.hpp"
#include "flatpose/image/fill.hpp"
#include "flatpose/model/landmarks.hpp"
#include "flatpose/rectify/survey.hpp"
#include "flatpose/teach/assess.hpp"
#include "flatpose/teach/clouds.hpp"
#include "flatpose/teach/sharpen.hpp"
#include "flatpose/teach/symmetry.hpp"

namespace flatpose::teach {
namespace {

// The finest level resolves a part of any size about equally: so many cells a side of a square of
// its area.
constexpr double kCellsAcross = 128.0;
constexpr double kNoiseMin_per_pitch = 0.01;

struct Measured {
  double pitch_mm = 0.0;
  double noise_mm = 0.0;
};

/// One lesson: what is done with the scans, in order.
class Lesson {
 public:
  Lesson(std::span<const TeachScan> scans, const TeachConfig& config, const locate::Limits& limits,
         std::span<std::byte> memory, model::Template& part, TeachReport& report) noexcept
      : scans_(scans),
        config_(config),
        limits_(limits),
        memory_(memory),
        part_(part),
        report_(report) {}

  Status run() noexcept {
    if (const Status s = extract(scans_[0]); s != Status::kOk) return s;
    if (const Status s = average_scans(); s != Status::kOk) return s;
    find_weakness(part_);
    return assess(scans_[0]);
  }

 private:
  // The first scan: cells, frame, clouds.
  Status extract(const TeachScan& source) noexcept {
    Arena arena(memory_);
    Measured measured;
    scene::Scene scene;
    Status s = see(source, 0.0, arena, measured, scene);
    if (s != Status::kOk) return s;
    PartMask mask = take_part_mask(arena, scene.map.grid);
    if (arena.failed()) return Status::kOutOfMemory;
    s = config_.labels.empty() ? find_part(scene, source.frames, config_.region, arena, mask)
                               : mask_from_labels(scene, config_.labels, mask);
    if (s != Status::kOk) return s;
    describe(measured, scene.map.grid, mask);

    SurfaceSamples samples;
    if (s = sample_surface(scene, mask, measured.noise_mm, arena, samples); s != Status::kOk)
      return s;
    const std::span<double> scratch = arena.take<double>(kSampleCountMax);
    if (arena.failed()) return Status::kOutOfMemory;
    const double tolerance_mm = 3.0 * measured.noise_mm;
    const Plane plane = dominant_plane(
        samples.samples.first(static_cast<std::size_t>(samples.count)), tolerance_mm, scratch);
    report_.flatness_rms_mm = flatness(samples, plane, 3.0 * tolerance_mm);
    place_object(source, plane, scene.map.grid, mask);

    if (s = build_contour_cloud(scene, mask, work_T_object_, arena, part_); s != Status::kOk)
      return s;
    const double margin_mm = std::max(1.5 * part_.cell_mm, 3.0 * scene.map.grid.cell_mm);
    if (s = build_surface_cloud(samples, mask, scene.map.grid, work_T_object_, margin_mm, arena,
                                part_);
        s != Status::kOk)
      return s;
    if (s = place_anchors(samples, work_T_object_, 3.0 * tolerance_mm, part_); s != Status::kOk)
      return s;
    measure_steps();
    sharpen(source, scene);
    if (const Status found = place_symmetry(source); found != Status::kOk) return found;
    snap_anchor(samples.stride_mm);
    measure_extent();
    part_.scan_T_object = source.frames.face_T_work * work_T_object_;
    part_.landmarks = model::find_landmarks(part_);
    return Status::kOk;
  }

  /// Surveys a scan and builds its scene at the scan's own resolution, or at the part's.
  Status see(const TeachScan& source, double cell_mm, Arena& arena, Measured& measured,
             scene::Scene& scene) noexcept {
    const Result<rectify::Survey> survey =
        rectify::survey(source.scan, source.frames.work_T_scan, arena);
    if (!survey) return survey.status();
    measured.pitch_mm = std::max(survey->pitch_along_row_mm, survey->pitch_along_column_mm);
    if (survey->valid_count == 0 || !(measured.pitch_mm > 0.0)) return Status::kTooFewPoints;
    measured.noise_mm = std::max(survey->noise_sigma_mm, kNoiseMin_per_pitch * measured.pitch_mm);
    rectify::GridConfig grid_config;
    grid_config.cell_mm = cell_mm > 0.0 ? cell_mm : measured.pitch_mm;
    grid_config.cells_max = limits_.cell_count;
    const Result<rectify::Grid> grid = rectify::choose_grid(*survey, grid_config);
    if (!grid) return grid.status();
    scene::SceneConfig scene_config;
    scene_config.noise_mm = measured.noise_mm;
    scene_config.pitch_mm = measured.pitch_mm;
    return scene::build_scene(source.scan, source.frames, *grid, scene_config, arena, scene);
  }

  void describe(const Measured& measured, const rectify::Grid& grid,
                const PartMask& mask) noexcept {
    part_.name = config_.name;
    part_.symmetry.order = config_.symmetry_order;
    part_.up = config_.up;
    part_.frame = config_.frame;
    part_.pitch_mm = measured.pitch_mm;
    part_.noise_mm = measured.noise_mm;
    part_.area_mm2 = mask.cell_count * grid.cell_mm * grid.cell_mm;
    part_.cell_mm = config_.cell_mm > 0.0
                        ? config_.cell_mm
                        : std::max(measured.pitch_mm, std::sqrt(part_.area_mm2) / kCellsAcross);
    part_.weakness = mask.lies_below ? model::kWeakBelowSurroundings : 0U;
  }

  static double flatness(const SurfaceSamples& samples, const Plane& plane,
                         double reach_mm) noexcept {
    double sum = 0.0;
    int count = 0;
    for (int i = 0; i < samples.count; ++i) {
      const SurfaceSample& s = samples.samples[i];
      const double off_mm = s.z_mm - plane.z_at(s.x_mm, s.y_mm);
      if (std::fabs(off_mm) > reach_mm) continue;
      sum += off_mm * off_mm;
      ++count;
    }
    return std::sqrt(sum / std::max(1, count));
  }

  // Origin on the main plane under the given or default point, z along its normal, x as taught.
  void place_object(const TeachScan& source, const Plane& plane, const rectify::Grid& grid,
                    const PartMask& mask) noexcept {
    Vec3 origin = centroid(grid, mask);
    if (config_.origin.is_given) {
      origin = source.frames.work_T_face() * Vec3{config_.origin.x_mm, config_.origin.y_mm, 0.0};
    } else if (config_.label_origin_px.is_given) {
      const Vec3 seen = source.scan(static_cast<int>(config_.label_origin_px.x_mm + 0.5),
                                    static_cast<int>(config_.label_origin_px.y_mm + 0.5));
      if (is_valid(seen)) origin = source.frames.work_T_scan * seen;
    }
    origin.z = plane.z_at(origin.x, origin.y);
    const Vec3 x_face = config_.x_axis.is_given
                            ? Vec3{config_.x_axis.x_mm, config_.x_axis.y_mm, 0.0}
                            : Vec3{1, 0, 0};
    const Vec3 x_work = source.frames.work_T_face().rotation * x_face;
    work_T_object_ = {rotation_from_z_and_x(plane.normal(), x_work), origin};
  }

  static Vec3 centroid(const rectify::Grid& grid, const PartMask& mask) noexcept {
    double x_sum = 0.0;
    double y_sum = 0.0;
    for (int y = 0; y < grid.height_px; ++y) {
      for (int x = 0; x < grid.width_px; ++x) {
        if (mask.is_part(x, y) == 0) continue;
        x_sum += x;
        y_sum += y;
      }
    }
    const double count = std::max(1, mask.cell_count);
    return {grid.x_of(x_sum / count), grid.y_of(y_sum / count), 0.0};
  }

  [[nodiscard]] Vec3 given_center(const TeachScan& source) const noexcept {
    if (!config_.symmetry_center.is_given) return symmetry_center(part_);
    const Pose work_T_face = source.frames.work_T_face();
    const Vec3 above =
        work_T_face * Vec3{config_.symmetry_center.x_mm, config_.symmetry_center.y_mm, 0.0};
    // Straight down along work z onto the object's plane.
    const Vec3 n = work_T_object_.rotation.column(2);
    const Vec3 to_origin = work_T_object_.position_mm - above;
    const Vec3 on_plane = above + Vec3{0, 0, dot(n, to_origin) / n.z};
    const Vec3 center = work_T_object_.inverse() * on_plane;
    return {center.x, center.y, 0.0};
  }

  Status place_symmetry(const TeachScan& source) noexcept {
    if (part_.symmetry.order == 1) return Status::kOk;
    const Vec3 center = given_center(source);
    if (!std::isfinite(center.x) || !std::isfinite(center.y)) return Status::kNoContour;
    part_.symmetry.center_x_mm = center.x;
    part_.symmetry.center_y_mm = center.y;
    // Where nobody gave an origin it lies on the axis, so that equivalent poses share it.
    if (!config_.origin.is_given && !config_.label_origin_px.is_given) move_origin(center);
    return Status::kOk;
  }

  void move_origin(const Vec3& to) noexcept {
    const auto move = [&to](auto& p) {
      p.x_mm = static_cast<float>(p.x_mm - to.x);
      p.y_mm = static_cast<float>(p.y_mm - to.y);
    };
    for (int i = 0; i < part_.contour_count; ++i) move(part_.contour[i]);
    for (int i = 0; i < part_.surface_count; ++i) move(part_.surface[i]);
    for (int i = 0; i < part_.anchor_count; ++i) move(part_.anchors[i]);
    part_.symmetry.center_x_mm -= to.x;
    part_.symmetry.center_y_mm -= to.y;
    work_T_object_.position_mm = work_T_object_ * to;
  }

  // On a part of full symmetry the search needs no angles when the anchor is its centre.
  void snap_anchor(double stride_mm) noexcept {
    if (part_.symmetry.order != model::kFullSymmetry) return;
    const Vec3 center = symmetry_center(part_);
    model::Anchor& anchor = part_.anchors[0];
    const double dx = anchor.x_mm - center.x;
    const double dy = anchor.y_mm - center.y;
    if (dx * dx + dy * dy > 9.0 * stride_mm * stride_mm) return;
    anchor.x_mm = static_cast<float>(center.x);
    anchor.y_mm = static_cast<float>(center.y);
  }

  void measure_steps() noexcept {
    std::array<float, model::kContourPointCountMax> steps;
    for (int i = 0; i < part_.contour_count; ++i) steps[i] = part_.contour[i].step_mm;
    const auto quartile = steps.begin() + part_.contour_count / 4;
    std::nth_element(steps.begin(), quartile, steps.begin() + part_.contour_count);
    part_.step_mm = *quartile;
  }

  void measure_extent() noexcept {
    double radius2 = 0.0;
    const auto reach = [&](double x_mm, double y_mm) {
      const double dx = x_mm - part_.anchors[0].x_mm;
      const double dy = y_mm - part_.anchors[0].y_mm;
      radius2 = std::max(radius2, dx * dx + dy * dy);
    };
    for (const model::ContourPoint& p : part_.contour_points()) reach(p.x_mm, p.y_mm);
    for (const model::SurfacePoint& p : part_.surface_points()) reach(p.x_mm, p.y_mm);
    part_.radius_mm = std::sqrt(radius2);
  }

  [[nodiscard]] refine::RawContourConfig raw_config() const noexcept {
    const double tolerance_mm =
        std::min(3.5 * part_.noise_mm + 0.15 * part_.cell_mm, 0.5 * part_.step_mm);
    return {2.5 * std::max(part_.pitch_mm, 0.5 * part_.cell_mm), tolerance_mm};
  }

  void sharpen(const TeachScan& source, const scene::Scene& scene) noexcept {
    const refine::RawScan raw{source.scan, source.frames.work_T_scan, &scene.map};
    mean_ = {};
    mean_.add(part_, raw, work_T_object_, raw_config());
    report_.contour_rms_mm = mean_.apply(part_);
    report_.scan_count_used = 1;
  }

  // Every scan again, now with the part located in it: the mean of the contours.
  Status average_scans() noexcept {
    if (scans_.size() < 2) return Status::kOk;
    mean_ = {};
    report_.scan_count_used = 0;
    for (std::size_t i = 0; i < scans_.size(); ++i) {
      Pose work_T_object = work_T_object_;
      bool found = i == 0;
      if (!found) {
        if (const Status s = find(scans_[i], &work_T_object, &found); s != Status::kOk) return s;
      }
      if (!found) continue;
      Arena arena(memory_);
      Measured measured;
      scene::Scene scene;
      if (const Status s = see(scans_[i], part_.cell_mm, arena, measured, scene); s != Status::kOk)
        return s;
      const refine::RawScan raw{scans_[i].scan, scans_[i].frames.work_T_scan, &scene.map};
      mean_.add(part_, raw, work_T_object, raw_config());
      ++report_.scan_count_used;
    }
    (void)mean_.apply(part_);
    part_.landmarks = model::find_landmarks(part_);
    return Status::kOk;
  }

  Status find(const TeachScan& source, Pose* work_T_object, bool* found) noexcept {
    locate::Locator locator;
    locate::LocateConfig config;
    config.min_score = 0.6;
    if (const Status s = locator.init(limits_, memory_); s != Status::kOk) return s;
    const Status s =
        locator.locate(part_, source.scan, source.frames, config, StoppedClock{}, result_);
    if (s != Status::kOk) return s;
    *found = result_.match_count > 0;
    if (*found) *work_T_object = source.frames.work_T_face() * result_.matches[0].face_T_object;
    return Status::kOk;
  }

  // Looks for everything that resembles the part in the scan it was taught from.
  Status assess(const TeachScan& source) noexcept {
    locate::Locator locator;
    locate::LocateConfig config;
    config.max_matches = 16;
    config.min_score = 0.4;
    config.min_visible = 0.3;
    if (const Status s = locator.init(limits_, memory_); s != Status::kOk) return s;
    const Status s =
        locator.locate(part_, source.scan, source.frames, config, StoppedClock{}, result_);
    if (s != Status::kOk) return s;
    set_threshold(result_, part_.scan_T_object, part_);
    return Status::kOk;
  }

  std::span<const TeachScan> scans_;
  const TeachConfig& config_;
  const locate::Limits& limits_;
  std::span<std::byte> memory_;
  model::Template& part_;
  TeachReport& report_;
  Pose work_T_object_;
  ContourMean mean_;
  locate::LocateResult result_;
};

bool is_valid(const TeachConfig& config, const TeachScan& first) noexcept {
  constexpr int kSymmetryOrderMax = 64;
  const auto finite = [](const PlanePoint& p) {
    return !p.is_given || (std::isfinite(p.x_mm) && std::isfinite(p.y_mm));
  };
  const auto in_scan = [&first](const PlanePoint& p_px) {
    return p_px.x_mm >= 0.0 && p_px.y_mm >= 0.0 && p_px.x_mm < first.scan.width_px - 0.5 &&
           p_px.y_mm < first.scan.height_px - 0.5;
  };
  if (config.label_origin_px.is_given && !in_scan(config.label_origin_px)) return false;
  if (config.x_axis.is_given && config.x_axis.x_mm == 0.0 && config.x_axis.y_mm == 0.0)
    return false;
  return flatpose::is_valid(config.region) && config.symmetry_order >= 0 &&
         config.symmetry_order <= kSymmetryOrderMax && finite(config.origin) &&
         finite(config.x_axis) && finite(config.symmetry_center) && config.name.back() == '\0' &&
         config.cell_mm >= 0.0;
}

}  // namespace

std::size_t Teacher::required_bytes(const locate::Limits& limits) noexcept {
  rectify::Grid grid;
  grid.width_px = 4096;
  grid.height_px = limits.cell_count / grid.width_px + 1;
  Arena arena = Arena::measuring();
  std::span<image::EdgePoint> edge_memory;
  (void)scene::take_scene(arena, grid, edge_memory);
  (void)take_part_mask(arena, grid);
  (void)arena.take<double>(kSampleCountMax);
  {
    const ArenaScope scope(arena);
    reserve_mask_scratch(arena, grid);
  }
  reserve_cloud_scratch(arena, grid);
  return std::max(arena.required_bytes(), locate::Locator::required_bytes(limits));
}

Status Teacher::init(const locate::Limits& limits, std::span<std::byte> memory) noexcept {
  if (locate::Locator::required_bytes(limits) == 0) return Status::kInvalidArgument;
  if (memory.size() < required_bytes(limits)) return Status::kOutOfMemory;
  limits_ = limits;
  memory_ = memory;
  return Status::kOk;
}

Status Teacher::teach(std::span<const TeachScan> scans, const TeachConfig& config,
                      model::Template& part, TeachReport& report) noexcept {
  if (scans.empty() || !is_valid(config, scans[0])) return Status::kInvalidArgument;
  for (const TeachScan& s : scans) {
    if (s.scan.width_px > limits_.scan_width_px || s.scan.height_px > limits_.scan_height_px)
      return Status::kTooLarge;
  }
  if (!config.labels.empty() && (config.labels.width_px != scans[0].scan.width_px ||
                                 config.labels.height_px != scans[0].scan.height_px)) {
    return Status::kShapeMismatch;
  }
  part = model::Template{};
  report = TeachReport{};
  return Lesson(scans, config, limits_, memory_, part, report).run();
}

}  // namespace flatpose::teach
