#include "port/linux/tool/scan_survey.hpp"

#include "port/linux/tool/engine.hpp"
#include "port/linux/tool/status_error.hpp"

namespace flatpose::tool {

rectify::Survey survey_of(const LoadedScan& loaded) {
  Memory memory(rectify::survey_required_bytes() + Arena::kAlignmentBytes);
  Arena arena(memory.span());
  const auto survey = rectify::survey(loaded.scan.view(), loaded.frames.work_T_scan, arena);
  if (!survey) fail(survey.status(), Doing::kSurvey, loaded.path);
  return *survey;
}

}  // namespace flatpose::tool
