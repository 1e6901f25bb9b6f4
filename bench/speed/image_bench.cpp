// The image kernels against OpenCV's, on the height maps of simulated scans: one thread each,
// OpenCV optimised.

#include <benchmark/benchmark.h>

#include <array>
#include <functional>
#include <map>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "bench/speed/benches.hpp"
#include "bench/speed/shots.hpp"
#include "flatpose/image/canny.hpp"
#include "flatpose/image/chamfer.hpp"
#include "flatpose/image/direction_channels.hpp"
#include "flatpose/image/sobel.hpp"
#include "flatpose/rectify/survey.hpp"
#include "flatpose/scene/scene.hpp"
#include "port/linux/cpu/vector_path.hpp"

namespace flatpose::bench {
namespace {

constexpr double kHeightsPer_mm = 10.0;  // steps of OpenCV's 16-bit heights
constexpr double kBytesPer_mm = 2.5;     // and of its 8-bit ones: 100 mm fit

void check(Status status, const char* what) {
  if (status != Status::kOk) throw std::runtime_error(std::string(what) + ": " + to_string(status));
}

/// A height map with what either side makes of it.
struct Map {
  tool::Memory memory;
  Arena arena;
  scene::Scene scene;
  image::EdgeConfig edge_config;
  VectorPath path = port::best_vector_path();
  ImageView<float> slope_x, slope_y;
  ImageView<std::uint8_t> mask, kind, distance;
  image::OctantImage octants;
  std::span<image::EdgePoint> edges;

  // OpenCV's: views of the same pixels, and its own results.
  cv::Mat heights, bytes, away_from_edges;
  std::array<cv::Mat, image::kOctantCount> away_from_octant;
  cv::Mat x, y, blurred, words, out;

  explicit Map(const Shot& shot)
      : memory(locate::Locator::required_bytes(tool::limits_for(shot.loaded.scan))),
        arena(memory.span()) {
    build(shot);
    take_results();
    draw_edges();
    prepare_opencv();
  }

 private:
  void build(const Shot& shot) {
    const RangeImageView scan = shot.loaded.scan.view();
    const Frames& frames = shot.loaded.frames;
    const auto survey = rectify::survey(scan, frames.work_T_scan, arena);
    check(survey.status(), "survey");
    // As many cells as points, so that the map is of the scan's size.
    const double cell_mm = std::max(survey->pitch_along_row_mm, survey->pitch_along_column_mm);
    const auto grid = rectify::choose_grid(*survey, {.cell_mm = cell_mm});
    check(grid.status(), "grid");
    scene::SceneConfig config;
    config.noise_mm = survey->noise_sigma_mm;
    config.pitch_mm = cell_mm;
    config.vector_path = path;
    check(scene::build_scene(scan, frames, *grid, config, arena, scene), "scene");
    edge_config.jump_high_mm = static_cast<float>(scene::edge_threshold_mm(config));
    edge_config.jump_low_mm = 0.6F * edge_config.jump_high_mm;
  }
  void take_results() {
    const int w = scene.filled_mm.width_px;
    const int h = scene.filled_mm.height_px;
    slope_x = arena.take_image<float>(w, h);
    slope_y = arena.take_image<float>(w, h);
    mask = arena.take_image<std::uint8_t>(w, h);
    kind = arena.take_image<std::uint8_t>(w, h);
    distance = arena.take_image<std::uint8_t>(w, h);
    octants.cells = arena.take_image<image::OctantCell>(w, h);
    edges = arena.take<image::EdgePoint>(static_cast<std::size_t>(w * h / 4));
    if (arena.failed()) throw std::runtime_error("images: out of memory");
  }
  void draw_edges() {
    const int pixel_count = mask.width_px * mask.height_px;
    for (int i = 0; i < pixel_count; ++i) mask.data[i] = scene.edge_kind.data[i] != 0 ? 1 : 0;
  }
  /// OpenCV measures to the nearest zero, so its masks are turned about.
  void prepare_opencv() {
    heights =
        cv::Mat(scene.filled_mm.height_px, scene.filled_mm.width_px, CV_32F, scene.filled_mm.data);
    heights.convertTo(bytes, CV_8U, kBytesPer_mm);
    away_from_edges = cv::Mat(mask.height_px, mask.width_px, CV_8U, mask.data) == 0;
    for (cv::Mat& octant : away_from_octant)
      octant = cv::Mat(mask.height_px, mask.width_px, CV_8U, cv::Scalar(255));
    for (const image::EdgePoint& edge : scene.edges) {
      const auto octant = static_cast<std::size_t>(image::octant_of(edge.dx, edge.dy));
      away_from_octant[octant].at<std::uint8_t>(edge.row, edge.column) = 0;
    }
  }
};

std::vector<std::unique_ptr<Map>>& maps_of(const ScanSize& size, int count) {
  static std::map<std::string, std::vector<std::unique_ptr<Map>>> kept;
  auto& maps = kept[size.name];
  static const std::array<std::string, 3> scenes{"medium", "high", "pile"};
  for (; static_cast<int>(maps.size()) < count;) {
    const std::string& scene = scenes[maps.size() % scenes.size()];
    maps.push_back(std::make_unique<Map>(shots_of(scene, "pad", size, 2)[0]));
  }
  return maps;
}

using Kernel = std::function<void(Map&)>;

void add(const ScanSize& size, const std::string& name, int count, const Kernel& kernel) {
  benchmark::RegisterBenchmark(("image/" + size.name + "/" + name).c_str(),
                               [=](benchmark::State& state) {
                                 cv::setNumThreads(1);
                                 cv::setUseOptimized(true);
                                 auto& maps = maps_of(size, count);
                                 std::size_t next = 0;
                                 for (auto _ : state) {
                                   kernel(*maps[next]);
                                   benchmark::ClobberMemory();
                                   next = (next + 1) % maps.size();
                                 }
                               })
      ->Unit(benchmark::kMicrosecond);
}

void sobel_ours(Map& m) {
  check(image::sobel(m.scene.filled_mm, m.slope_x, m.slope_y, m.path), "sobel");
}
void sobel_opencv(Map& m) {
  cv::Sobel(m.heights, m.x, CV_32F, 1, 0, 3, 0.125, 0.0, cv::BORDER_REPLICATE);
  cv::Sobel(m.heights, m.y, CV_32F, 0, 1, 3, 0.125, 0.0, cv::BORDER_REPLICATE);
}

void chamfer_ours(Map& m) { check(image::chamfer_distance(m.mask, m.distance, m.path), "chamfer"); }
void chamfer_opencv(Map& m) { cv::distanceTransform(m.away_from_edges, m.out, cv::DIST_L2, 3); }

void octants_ours(Map& m) {
  check(image::edge_distances(m.scene.edges, {}, m.octants, m.path), "edge_distances");
}
void octants_opencv(Map& m) {
  for (const cv::Mat& octant : m.away_from_octant)
    cv::distanceTransform(octant, m.out, cv::DIST_L2, 3);
}

void edges_ours(Map& m) {
  const auto count =
      image::detect_edges(m.scene.filled_mm, m.scene.missing, m.scene.map.grid.cell_mm,
                          m.edge_config, m.arena, m.kind, m.edges, m.path);
  check(count.status(), "edges");
}
// Sobel's sums are eight times the slope of a cell; a step rises over some three cells.
void edges_opencv(Map& m) {
  const double sums_per_mm = 8.0 / 3.0 * kHeightsPer_mm;
  cv::GaussianBlur(m.heights, m.blurred, {3, 3}, 0.0);
  m.blurred.convertTo(m.words, CV_16S, kHeightsPer_mm);
  cv::Sobel(m.words, m.x, CV_16S, 1, 0, 3);
  cv::Sobel(m.words, m.y, CV_16S, 0, 1, 3);
  cv::Canny(m.x, m.y, m.out, static_cast<double>(m.edge_config.jump_low_mm) * sums_per_mm,
            static_cast<double>(m.edge_config.jump_high_mm) * sums_per_mm, true);
}
void canny_opencv(Map& m) {
  const double sums_per_mm = 8.0 / 3.0 * kBytesPer_mm;
  cv::Canny(m.bytes, m.out, static_cast<double>(m.edge_config.jump_low_mm) * sums_per_mm,
            static_cast<double>(m.edge_config.jump_high_mm) * sums_per_mm, 3, true);
}

}  // namespace

void register_image_benches(const BenchOptions&) {
  struct Pair {
    const char* name;
    Kernel ours;
    Kernel opencv;
  };
  const Pair pairs[] = {
      {"Sobel", sobel_ours, sobel_opencv},
      {"chamfer", chamfer_ours, chamfer_opencv},
      {"chamfer_in_eight_directions", octants_ours, octants_opencv},
      {"whole_edge_chain", edges_ours, edges_opencv},
      {"Canny_part_against_its_8-bit_Canny", edges_ours, canny_opencv},
  };
  constexpr int kMaps = 3;
  for (const ScanSize& size : {kSmallScan, kLargeScan}) {
    for (const Pair& pair : pairs) {
      add(size, std::string(pair.name) + "/ours", kMaps, pair.ours);
      add(size, std::string(pair.name) + "/opencv", kMaps, pair.opencv);
    }
  }
}

}  // namespace flatpose::bench
