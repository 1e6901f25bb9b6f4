#include "port/linux/tool/served_map.hpp"

#include "flatpose/job/command.hpp"
#include "flatpose/result_map/value.hpp"

namespace flatpose::tool {

const char* name_of(result_map::WordOrder order) {
  switch (order) {
    case result_map::WordOrder::kAbcd: return "ABCD";
    case result_map::WordOrder::kCdab: return "CDAB";
    case result_map::WordOrder::kBadc: return "BADC";
    case result_map::WordOrder::kDcba: return "DCBA";
  }
  return "";
}

RotationMeasure rotation_measure(Convention convention) {
  const char* unit = is_euler(convention) ? "deg" : "";
  if (convention == Convention::kUrRotationVector) unit = "rad";
  return {result_map::rotation_scale(convention), unit};
}

std::optional<RotationMeasure> rotation_measure_of(const ServedMap& served) {
  std::optional<RotationMeasure> shared;
  for (const ServedJob& job : served.jobs) {
    const RotationMeasure measure = rotation_measure(job.convention);
    if (shared && !(*shared == measure)) return {};
    shared = measure;
  }
  return shared;
}

std::string text_of(const ServedJob& job) {
  return job.parts + "; frame " + job::name_of(job::frame_names(), static_cast<int>(job.frame)) +
         ", " + to_string(job.convention);
}

}  // namespace flatpose::tool
