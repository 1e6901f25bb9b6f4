#include "port/linux/daemon/job_set.hpp"

#include "flatpose/model/template_file.hpp"
#include "port/linux/daemon/file_hash.hpp"
#include "port/linux/files/atomic_file.hpp"
#include "port/linux/files/input_error.hpp"

namespace flatpose::daemon {
namespace {

Part load_part(const PartConfig& config) {
  const auto bytes = port::read_file(config.file, model::kTemplateFileBytesMax);
  FileHash hash;
  hash.add(bytes);
  Part part{std::make_shared<model::Template>(), hash.value(), config.picks};
  if (part.picks.empty()) part.picks.push_back(usual_pick());
  const Status status = model::read_template(bytes, *part.model);
  if (status != Status::kOk)
    throw port::InputError(config.file,
                           std::string("it is no template that can be used: ") + to_string(status),
                           "teach the part again, with this version");
  return part;
}

Job load_job(const JobConfig& config, const SourceConfig& source) {
  return {config,
          load_alignment(config.work_file, config.robot_file, config.rule.frame, source.up)};
}

}  // namespace

const Job* JobSet::find(std::uint16_t number) const noexcept {
  for (const Job& job : jobs) {
    if (job.config.rule.job == number) return &job;
  }
  return nullptr;
}

job::JobTable JobSet::rules() const {
  job::JobTable table;
  for (const Job& job : jobs)
    table.rules[static_cast<std::size_t>(table.count++)] = job.config.rule;
  return table;
}

std::vector<std::string> JobSet::problems() const {
  std::vector<std::string> lines;
  for (const Job& job : jobs) {
    if (!job.alignment.problem.empty())
      lines.push_back("job " + std::to_string(job.config.rule.job) +
                      " has no alignment: " + job.alignment.problem);
  }
  return lines;
}

JobSet load_jobs(const Config& config) {
  JobSet set;
  for (const PartConfig& part : config.parts) set.parts.push_back(load_part(part));
  for (const JobConfig& job : config.jobs) set.jobs.push_back(load_job(job, config.source));
  return set;
}

}  // namespace flatpose::daemon
