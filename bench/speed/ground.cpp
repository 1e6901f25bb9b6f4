#include "bench/speed/ground.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "flatpose/core/maths.hpp"
#include "flatpose/image/chamfer.hpp"
#include "flatpose/image/normals.hpp"
#include "flatpose/locate/settings.hpp"
#include "flatpose/rectify/survey.hpp"
#include "flatpose/scene/scene.hpp"

namespace flatpose::bench {
namespace {

constexpr double kCell_mm = 1.0;      // two of them make a place
constexpr int kFieldPlacesMax = 240;  // as many as the simulator's field is deep
constexpr double kSteepest = 1.0;     // slope
constexpr double kOutsideThird_px = 255.0;

void check(Status status, const char* what) {
  if (status != Status::kOk) throw std::runtime_error(std::string(what) + ": " + to_string(status));
}

Arena take_memory(Ground& ground, std::size_t size_bytes) {
  return Arena(ground.memory.emplace_back(size_bytes).span());
}

/// The middle of the simulator's field, which has its origin there.
rectify::Grid middle_of_field(int places_per_side) {
  const int side_px = 2 * places_per_side;
  const double first_mm = -0.5 * (side_px - 1) * kCell_mm;
  return {first_mm, first_mm, kCell_mm, side_px, side_px};
}

/// A scene with the settings that locate would have.
struct Field {
  tool::Memory memory;
  Arena arena;
  scene::Scene scene;
  locate::Settings settings;

  explicit Field(std::size_t size_bytes) : memory(size_bytes), arena(memory.span()) {}
};

std::unique_ptr<Field> build_field(const Shot& shot, const model::Template& part, int side) {
  const RangeImageView scan = shot.loaded.scan.view();
  const Frames& frames = shot.loaded.frames;
  auto field =
      std::make_unique<Field>(locate::Locator::required_bytes(tool::limits_for(shot.loaded.scan)));
  const auto survey = rectify::survey(scan, frames.work_T_scan, field->arena);
  check(survey.status(), "survey");
  const double pitch_mm = std::max(survey->pitch_along_row_mm, survey->pitch_along_column_mm);
  field->settings = locate::derive_settings(part, {}, survey->noise_sigma_mm, pitch_mm, kCell_mm);
  check(scene::build_scene(scan, frames, middle_of_field(side), field->settings.scene, field->arena,
                           field->scene),
        "scene");
  return field;
}

/// Chamfer distances to all edges on the coarse level, and normals: of floats, as the thesis.
void keep_for_thesis(const Field& field, Arena& arena, Ground& ground) {
  const int side = ground.field_px;
  ground.chamfer_px = arena.take_image<float>(side, side);
  ground.normal_x = arena.take_image<float>(side, side);
  ground.normal_y = arena.take_image<float>(side, side);
  const auto mask = arena.take_image<std::uint8_t>(side, side);
  const auto third_px = arena.take_image<std::uint16_t>(side, side);
  if (arena.failed()) throw std::runtime_error("thesis images: out of memory");
  std::fill_n(mask.data, side * side, std::uint8_t{0});
  for (const image::EdgePoint& edge : field.scene.edges) mask(edge.column / 2, edge.row / 2) = 1;
  check(image::chamfer_distance(mask, third_px), "chamfer");
  for (int i = 0; i < side * side; ++i)
    ground.chamfer_px.data[i] = static_cast<float>(third_px.data[i]) / 3.0F;
  check(
      image::normal_map(ground.images.filled_mm, 2.0 * kCell_mm, ground.normal_x, ground.normal_y),
      "normals");
}

/// Every place becomes a hypothesis: see the header.
void open_gate(int margin_px, const search::TiltField& field) {
  const int w = field.rms_mm.width_px;
  const int h = field.rms_mm.height_px;
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      const int from_x = std::clamp(x, margin_px, w - 1 - margin_px);
      const int from_y = std::clamp(y, margin_px, h - 1 - margin_px);
      const float steepness =
          std::max(1.0F, std::hypot(field.slope_x(from_x, from_y), field.slope_y(from_x, from_y)) /
                             static_cast<float>(kSteepest));
      field.plane_mm(x, y) = field.plane_mm(from_x, from_y);
      field.rms_mm(x, y) = 0.0F;
      // Sources beyond the margin are read before or after they are written: either is bounded.
      field.slope_x(x, y) = field.slope_x(from_x, from_y) / steepness;
      field.slope_y(x, y) = field.slope_y(from_x, from_y) / steepness;
    }
  }
}

void level(const search::TiltField& field) {
  for (int y = 0; y < field.rms_mm.height_px; ++y) {
    std::fill_n(field.slope_x.row(y), field.rms_mm.width_px, 0.0F);
    std::fill_n(field.slope_y.row(y), field.rms_mm.width_px, 0.0F);
  }
}

int reach_px(const model::Template& part) {
  return static_cast<int>(part.radius_mm / (2.0 * kCell_mm)) + 3;
}

search::GridSearchConfig search_config(const GroundConfig& config,
                                       const search::GridSearchConfig& usual) {
  search::GridSearchConfig search = usual;
  if (config.first_share > 0.0) search.first_share = config.first_share;
  search.score.contour_count = config.point_count / 2;
  search.score.surface_count = config.point_count - config.point_count / 2;
  // A little more than the step itself, so that rounding makes no angle more.
  search.angle_step_rad = 2.0 * kPi / config.angle_count * (1.0 + 1e-9);
  return search;
}

/// The ground of a field that is not repeated.
void build(const Field& field, Ground& ground) {
  const GroundConfig& config = ground.config;
  const rectify::Grid& fine = field.scene.map.grid;
  const auto lay_out = [&](Arena& arena) {
    ground.images = search::take_search_images(arena, fine, config.node_side > 0);
    const int w = ground.images.grid.width_px;
    const int h = ground.images.grid.height_px;
    ground.field = search::take_tilt_field(arena, w, h);
    ground.places = search::take_places(arena, w, h);
    for (int i = 0; i < 8; ++i) (void)arena.take_image<float>(w, h);  // for keep_for_thesis
    search::reserve_search_scratch(arena, fine, config.node_side > 0);
  };
  Arena measuring = Arena::measuring();
  lay_out(measuring);
  ground.scratch = take_memory(ground, measuring.required_bytes());
  ground.images = search::take_search_images(ground.scratch, fine, config.node_side > 0);
  const int side = ground.field_px = ground.images.grid.width_px;
  ground.field = search::take_tilt_field(ground.scratch, side, side);
  ground.places = search::take_places(ground.scratch, side, side);

  const locate::Settings& settings = field.settings;
  check(search::halve_heights(field.scene, settings.verify.height_tolerance_mm, ground.scratch,
                              ground.images),
        "halve");
  check(search::fit_tilt_field(ground.images.filled_mm, 2.0 * kCell_mm, settings.tilt_radius_px,
                               ground.scratch, ground.field),
        "tilt");
  if (!config.is_gated) open_gate(settings.tilt_radius_px, ground.field);
  if (config.is_level) level(ground.field);
  search::PlaceConfig gate = settings.places;
  gate.stride_px = 1;
  check(search::collect_places(ground.field, gate, ground.places), "places");
  search::SearchImagesConfig images = settings.search_images;
  images.stride_px = 1;
  images.reach_px = reach_px(*ground.part);
  images.use_height = config.use_height;
  images.use_directions = config.use_directions;
  images.node_side = config.node_side;
  images.node_slack = config.node_slack;
  check(search::build_search_images(field.scene, images, ground.places.range, ground.scratch,
                                    ground.images),
        "images");
  search::set_heights(ground.field, ground.images, ground.places);
  ground.search = search_config(config, settings.search);
  keep_for_thesis(field, ground.scratch, ground);
}

template <class T>
void repeat(ImageView<const T> from, ImageView<T> to) {
  for (int y = 0; y < to.height_px; ++y) {
    for (int x = 0; x < to.width_px; x += from.width_px) {
      std::memcpy(to.row(y) + x, from.row(y % from.height_px),
                  sizeof(T) * static_cast<std::size_t>(std::min(from.width_px, to.width_px - x)));
    }
  }
}

/// One image of the search, margins and all.
void repeat_bytes(const search::SearchImages& from, int index, const search::SearchImages& to) {
  const auto first = [index](const search::SearchImages& images) {
    return images.bytes.data() + static_cast<std::size_t>(index) * images.lattice.image_bytes();
  };
  const search::Lattice& lattice = to.lattice;
  std::uint8_t* image = first(to);
  std::fill_n(image, lattice.image_bytes(), first(from)[0]);  // the margin's value
  const int side = from.lattice.width;
  repeat(ImageView<const std::uint8_t>{first(from) + from.lattice.byte_of(0, 0), side, side,
                                       from.lattice.row_bytes},
         ImageView<std::uint8_t>{image + lattice.byte_of(0, 0), lattice.width, lattice.height,
                                 lattice.row_bytes});
}

/// The same scene over and over, beside and below itself.
void build_repeated(const Ground& from, int side, Ground& ground) {
  const std::size_t places =
      static_cast<std::size_t>(side + search::kBlockSize) * static_cast<std::size_t>(side);
  const search::Lattice lattice =
      search::make_lattice(side, side, 1, from.images.lattice.reach_px());
  // Images, four floats of the field, places and the search's scratch; what is not written to
  // costs nothing.
  const std::size_t size_bytes =
      search::SearchImages::kImageCountMax * lattice.image_bytes() + 64 * places;
  ground.scratch = take_memory(ground, size_bytes);
  ground.images = from.images;
  ground.images.filled_mm = {};
  ground.images.grid.width_px = ground.images.grid.height_px = side;
  ground.images.lattice = lattice;
  ground.images.bytes = ground.scratch.take<std::uint8_t>(search::SearchImages::kImageCountMax *
                                                          lattice.image_bytes());
  ground.field = search::take_tilt_field(ground.scratch, side, side);
  ground.places = search::take_places(ground.scratch, side, side);
  if (ground.scratch.failed()) throw std::runtime_error("repeated ground: out of memory");
  for (int i = 0; i < search::SearchImages::kImageCountMax; ++i)
    repeat_bytes(from.images, i, ground.images);
  repeat<float>(from.field.slope_x, ground.field.slope_x);
  repeat<float>(from.field.slope_y, ground.field.slope_y);
  repeat<float>(from.field.plane_mm, ground.field.plane_mm);
  repeat<float>(from.field.rms_mm, ground.field.rms_mm);
  search::PlaceConfig gate;
  gate.max_tilt_rad = 0.8;
  check(search::collect_places(ground.field, gate, ground.places), "places");
  search::set_heights(ground.field, ground.images, ground.places);
  ground.search = from.search;
}

}  // namespace

int Ground::angle_count() const {
  return search::angle_count(search::angle_range_rad(part->symmetry, part->anchors[0]),
                             search.angle_step_rad);
}

std::int64_t Ground::hypothesis_count() const { return places.place_count * angle_count(); }

double Ground::evaluation_count() const {
  return static_cast<double>(hypothesis_count()) * config.point_count;
}

std::unique_ptr<Ground> make_ground(const GroundConfig& config, const model::Template& part) {
  ShotConfig shot;
  shot.scene.scene = config.scene;
  shot.scene.part = config.part;
  shot.seed = config.seed;
  const int field_side = std::min(config.places_per_side, kFieldPlacesMax);
  const auto field = build_field(take_shot(shot), part, field_side);
  auto ground = std::make_unique<Ground>();
  ground->config = config;
  ground->part = &part;
  build(*field, *ground);
  if (config.places_per_side == field_side) return ground;

  auto repeated = std::make_unique<Ground>();
  repeated->config = config;
  repeated->part = &part;
  build_repeated(*ground, config.places_per_side, *repeated);
  repeated->field_px = ground->field_px;
  repeated->chamfer_px = ground->chamfer_px;
  repeated->normal_x = ground->normal_x;
  repeated->normal_y = ground->normal_y;
  for (tool::Memory& memory : ground->memory) repeated->memory.push_back(std::move(memory));
  return repeated;
}

}  // namespace flatpose::bench
