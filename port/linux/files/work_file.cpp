#include "port/linux/files/work_file.hpp"

#include <cmath>

#include "port/linux/files/atomic_file.hpp"
#include "port/linux/files/input_error.hpp"
#include "port/linux/files/json_text.hpp"
#include "port/linux/files/rigid_pose.hpp"

namespace flatpose::port {
namespace {

constexpr const char* kFormat = "flatpose-work";
constexpr std::uint64_t kVersion = 1;
constexpr std::int64_t kFileBytesMax = 1024 * 1024;
constexpr const char* kAlignAgain = "write it again with flatpose align";

WorkQuality read_quality(const JsonPlace& place) {
  WorkQuality quality;
  quality.plane_rms_mm = place["plane_rms_mm"].number();
  quality.inlier_share = place["inlier_share"].number();
  const std::uint64_t count = place["inlier_count"].whole_number();
  if (quality.plane_rms_mm < 0.0) place["plane_rms_mm"].fail("is below 0", kAlignAgain);
  if (quality.inlier_share < 0.0 || quality.inlier_share > 1.0)
    place["inlier_share"].fail("is not 0 to 1", kAlignAgain);
  if (std::cmp_greater(count, INT64_MAX)) place["inlier_count"].fail("is too large", kAlignAgain);
  quality.inlier_count = static_cast<std::int64_t>(count);
  return quality;
}

}  // namespace

WorkFile read_work_file(const std::string& path) {
  const nlohmann::json json = parse_json(path, read_file(path, kFileBytesMax));
  const JsonPlace top(path, json);
  if (!top.has("format") || !json["format"].is_string() || json["format"] != kFormat)
    top.fail("is no work file", "write one with flatpose align");
  if (const std::uint64_t version = top["version"].whole_number(); version != kVersion)
    top["version"].fail(std::to_string(version) + " is not the known " + std::to_string(kVersion),
                        version > kVersion ? "use a newer flatpose" : kAlignAgain);
  WorkFile work;
  work.work_T_scan = read_pose(top["work_T_scan"], kAlignAgain);
  const std::optional<Up> up = parse_up(top["up"].text());
  if (!up) top["up"].fail("is neither \"+z\" nor \"-z\"", kAlignAgain);
  work.up = *up;
  if (top.has("quality")) work.quality = read_quality(top["quality"]);
  return work;
}

void write_work_file(const std::string& path, const WorkFile& work) {
  const Vec3& p_mm = work.work_T_scan.position_mm;
  // JSON has no NaN: what is written here must be readable there.
  if (!(norm(p_mm) <= kCoordinateMax_mm) || !is_rotation(work.work_T_scan.rotation))
    throw InputError(path, "the pose to write is no finite rigid pose",
                     "align with a scan that shows the work plane");
  if (work.quality &&
      !(std::isfinite(work.quality->plane_rms_mm) && std::isfinite(work.quality->inlier_share)))
    throw InputError(path, "the quality to write is not finite",
                     "align with a scan that shows the work plane");
  nlohmann::ordered_json json;
  json["format"] = kFormat;
  json["version"] = kVersion;
  json["up"] = to_string(work.up);
  json["work_T_scan"] = pose_object(work.work_T_scan);
  if (work.quality)
    json["quality"] = {{"plane_rms_mm", work.quality->plane_rms_mm},
                       {"inlier_share", work.quality->inlier_share},
                       {"inlier_count", work.quality->inlier_count}};
  write_file_atomically(path, json.dump(2) + "\n");
}

}  // namespace flatpose::port
