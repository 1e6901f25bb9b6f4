#include "port/linux/tool/pose_json.hpp"

#include "port/linux/tool/template_io.hpp"

namespace flatpose::tool {

Json json_of(const Vec3& v) { return Json::array({v.x, v.y, v.z}); }

void add_pose(Json& object, const Pose& pose) {
  const Quaternion q = quaternion(pose.rotation);
  object["position_mm"] = json_of(pose.position_mm);
  object["rotation"] = pose.rotation.m;
  object["quaternion_wxyz"] = Json::array({q.w, q.x, q.y, q.z});
}

Json json_of(const model::Template& part) {
  Json json;
  json["name"] = part.name.data();
  json["threshold"] = part.score_threshold;
  json["self_score"] = part.self_score;
  json["rival_score"] = part.rival_score;
  json["contour_count"] = part.contour_count;
  json["surface_count"] = part.surface_count;
  json["cell_mm"] = part.cell_mm;
  json["pitch_mm"] = part.pitch_mm;
  json["noise_mm"] = part.noise_mm;
  json["step_mm"] = part.step_mm;
  json["radius_mm"] = part.radius_mm;
  json["area_mm2"] = part.area_mm2;
  Json& symmetry = json["symmetry"];
  if (part.symmetry.order == model::kFullSymmetry) {
    symmetry["order"] = "full";
  } else {
    symmetry["order"] = part.symmetry.order;
  }
  symmetry["center_mm"] = Json::array({part.symmetry.center_x_mm, part.symmetry.center_y_mm});
  json["anchors"] = Json::array();
  for (int i = 0; i < part.anchor_count; ++i) {
    const model::Anchor& anchor = part.anchors[i];
    json["anchors"].push_back({{"position_mm", Json::array({anchor.x_mm, anchor.y_mm})},
                               {"clearance_mm", anchor.clearance_mm}});
  }
  json["weakness"] = Json::array();
  for (const WeakPoint& weak : weak_points(part))
    json["weakness"].push_back({{"word", weak.word}, {"sentence", weak.sentence}});
  Json taught;
  taught["frame"] = part.frame == model::Frame::kWork ? "work" : "scan";
  taught["up"] = part.up > 0 ? "+z" : "-z";
  add_pose(taught, part.scan_T_object);
  json["taught_pose"] = taught;
  return json;
}

std::string line_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace flatpose::tool
