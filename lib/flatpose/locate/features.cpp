#include "flatpose/locate/features.hpp"

#include <algorithm>
#include <array>

#include "flatpose/image/normals.hpp"
#include "flatpose/image/pyramid.hpp"
#include "flatpose/rectify/slots.hpp"

namespace flatpose::locate {
namespace {

// The parts, the longest first.
enum Part : int { kFineDistances, kCoarseSurface, kCoarseEdges, kFineNormals };
constexpr int kBlock_px = 16;

struct Scratches {
  Arena surface;
  Arena edges;
};

template <class Reserve>
Arena part_of(Arena& arena, const Reserve& reserve) noexcept {
  Arena measuring = Arena::measuring();
  reserve(measuring);
  return Arena(arena.take<std::byte>(measuring.required_bytes()));
}

Scratches take_scratches(Arena& arena, const rectify::Grid& coarse) noexcept {
  return {part_of(arena,
                  [&](Arena& part) {
                    {
                      const ArenaScope scope(part);
                      search::reserve_surface_scratch(part, coarse);
                    }
                    search::reserve_tilt_scratch(part, coarse.width_px);
                  }),
          part_of(arena, [&](Arena& part) { search::reserve_edge_cost_scratch(part, coarse); })};
}

class Features {
 public:
  Features(const scene::Scene& scene, const Settings& settings, const Scratches& scratches,
           const Budget& budget, Workspace& work) noexcept
      : scene_(scene),
        settings_(settings),
        scratches_(scratches),
        budget_(budget),
        work_(work),
        normal_rows_(scene.filled_mm.height_px, kBlock_px) {}

  [[nodiscard]] Status run() noexcept {
    if (const Status s = refine::begin_fine_images(scene_, work_.fine); s != Status::kOk) return s;
    if (const Status s = search::begin_search_images(settings_.search_images, work_.coarse);
        s != Status::kOk) {
      return s;
    }
    auto body = [this](int part) {
      if (part >= kFineNormals) return write_normals(part - kFineNormals);
      statuses_[static_cast<std::size_t>(part)] = run_part(static_cast<Part>(part));
    };
    if (!for_each_chunk(budget_, kFineNormals + normal_rows_.count(), body))
      return Status::kStopped;
    image::close_normals(work_.fine.normal_x, work_.fine.normal_y);
    for (const Status s : statuses_) {
      if (s != Status::kOk) return s;
    }
    search::build_node_images(work_.coarse);
    return Status::kOk;
  }

 private:
  [[nodiscard]] Status run_part(Part part) noexcept {
    switch (part) {
      case kFineDistances: return refine::write_fine_distances(scene_, work_.fine, budget_);
      case kCoarseSurface: return build_surface();
      case kCoarseEdges:
        for (int y = 0; y < work_.claimed.height_px; ++y)
          std::fill_n(work_.claimed.row(y), work_.claimed.width_px, std::uint8_t{0});
        return search::write_edge_costs(scene_, scratches_.edges, work_.coarse, budget_);
      default: return Status::kOk;
    }
  }

  void write_normals(int chunk) noexcept {
    const int end = normal_rows_.end(chunk);
    for (int row = normal_rows_.begin(chunk); row < end && !budget_.is_over();
         row += kRowsPerLook) {
      image::write_normals(scene_.filled_mm, work_.fine.grid.cell_mm, work_.fine.normal_x,
                           work_.fine.normal_y, row, std::min(row + kRowsPerLook, end),
                           scene_.vector_path);
    }
  }

  [[nodiscard]] Status build_surface() noexcept {
    search::SearchImages& coarse = work_.coarse;
    Arena& scratch = scratches_.surface;
    Status s = search::halve_heights(scene_, settings_.verify.height_tolerance_mm, scratch, coarse);
    if (s != Status::kOk) return s;
    if (budget_.is_over()) return Status::kStopped;
    s = search::fit_tilt_field(coarse.filled_mm, coarse.grid.cell_mm, settings_.tilt_radius_px,
                               scratch, work_.tilt, settings_.places.stride_px, scene_.vector_path,
                               budget_);
    if (s != Status::kOk) return s;
    s = search::collect_places(work_.tilt, settings_.places, work_.places);
    if (s != Status::kOk) return s;
    if (budget_.is_over()) return Status::kStopped;
    s = search::write_surface(work_.places.range, scratch, coarse);
    if (budget_.is_over()) return Status::kStopped;
    if (s == Status::kOk) search::set_heights(work_.tilt, coarse, work_.places);
    return s;
  }

  const scene::Scene& scene_;
  const Settings& settings_;
  Scratches scratches_;
  const Budget& budget_;
  Workspace& work_;
  rectify::RowChunks normal_rows_;
  std::array<Status, kFineNormals> statuses_{};
};

}  // namespace

void reserve_feature_scratch(Arena& arena, const rectify::Grid& fine) noexcept {
  (void)take_scratches(arena, image::halved(fine));
}

Status build_features(const scene::Scene& scene, const Settings& settings, Arena& scratch,
                      const Budget& budget, Workspace& work) noexcept {
  const ArenaScope scope(scratch);
  const Scratches scratches = take_scratches(scratch, work.coarse.grid);
  if (scratch.failed()) return Status::kOutOfMemory;
  return Features(scene, settings, scratches, budget, work).run();
}

}  // namespace flatpose::locate
