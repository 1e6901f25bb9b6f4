#include <algorithm>

#include "flatpose/c_api/convert.hpp"
#include "flatpose/c_api/handles.hpp"
#include "flatpose/c_api/versioned.hpp"
#include "flatpose/model/template_file.hpp"

using namespace flatpose;
using namespace flatpose::c_api;

static_assert(FLATPOSE_NAME_BYTES == model::kNameBytesMax + 1);
static_assert(+FLATPOSE_WEAK_SYMMETRY_LIKELY == +model::kWeakSymmetryLikely &&
              +FLATPOSE_WEAK_DIRECTION_LOOSE == +model::kWeakDirectionLoose &&
              +FLATPOSE_WEAK_STEP_NEAR_NOISE == +model::kWeakStepNearNoise &&
              +FLATPOSE_WEAK_BELOW_SURROUNDINGS == +model::kWeakBelowSurroundings &&
              +FLATPOSE_WEAK_SMALL == +model::kWeakSmall &&
              +FLATPOSE_WEAK_MARGIN_THIN == +model::kWeakMarginThin &&
              +FLATPOSE_WEAK_SYMMETRY_DOUBTFUL == +model::kWeakSymmetryDoubtful);

size_t flatpose_part_required_bytes(void) { return kHandleBytes<flatpose_part>; }

size_t flatpose_part_file_bytes_max(void) { return model::kTemplateFileBytesMax; }

flatpose_status flatpose_part_load(const void* file, size_t file_bytes, void* memory,
                                   size_t memory_bytes, flatpose_part** part) {
  if (part == nullptr) return to_c(Status::kInvalidArgument);
  *part = nullptr;
  if (file == nullptr || memory == nullptr) return to_c(Status::kInvalidArgument);
  if (memory_bytes < kHandleBytes<flatpose_part>) return to_c(Status::kOutOfMemory);
  auto* const made = make_handle<flatpose_part>(memory);
  const Status s =
      model::read_template({static_cast<const std::byte*>(file), file_bytes}, made->part);
  if (s == Status::kOk) *part = made;
  return to_c(s);
}

flatpose_status flatpose_part_save(const flatpose_part* part, void* file,
                                   size_t file_capacity_bytes, size_t* file_bytes) {
  if (part == nullptr || file == nullptr || file_bytes == nullptr)
    return to_c(Status::kInvalidArgument);
  *file_bytes = 0;
  const Result<std::size_t> written =
      model::write_template(part->part, {static_cast<std::byte*>(file), file_capacity_bytes});
  if (written) *file_bytes = *written;
  return to_c(written.status());
}

flatpose_status flatpose_part_describe(const flatpose_part* part, flatpose_part_info* info) {
  if (part == nullptr) return to_c(Status::kInvalidArgument);
  const model::Template& from = part->part;
  flatpose_part_info out = FLATPOSE_PART_INFO_INIT;
  std::copy(from.name.begin(), from.name.end(), out.name);
  out.symmetry_order = from.symmetry.order;
  out.score_threshold = from.score_threshold;
  out.self_score = from.self_score;
  out.rival_score = from.rival_score;
  out.pitch_mm = from.pitch_mm;
  out.noise_mm = from.noise_mm;
  out.area_mm2 = from.area_mm2;
  out.radius_mm = from.radius_mm;
  out.taught = to_c(from.scan_T_object);
  out.weakness = from.weakness;
  return to_c(write(out, info));
}
