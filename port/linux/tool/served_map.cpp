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

std::optional<double> rotation_scale_of(const ServedMap& served) {
  std::optional<double> shared;
  for (const ServedJob& job : served.jobs) {
    const double scale = result_map::rotation_scale(job.convention);
    if (shared && *shared != scale) return {};
    shared = scale;
  }
  return shared;
}

std::string text_of(const ServedJob& job) {
  return job.parts + "; frame " + job::name_of(job::frame_names(), static_cast<int>(job.frame)) +
         ", " + to_string(job.convention);
}

}  // namespace flatpose::tool
