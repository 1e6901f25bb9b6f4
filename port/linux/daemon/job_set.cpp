#include "port/linux/daemon/job_set.hpp"

#include "flatpose/core/fnv.hpp"
#include "flatpose/model/template_file.hpp"
#include "port/linux/daemon/section.hpp"
#include "port/linux/files/atomic_file.hpp"
#include "port/linux/files/input_error.hpp"
#include "port/linux/files/work_file.hpp"

namespace flatpose::daemon {
namespace {

// Never 0, which says that there is none.
std::uint32_t hash_of(std::span<const std::byte> bytes) noexcept {
  Fnv1a64 hash;
  hash.add(bytes);
  const auto folded = static_cast<std::uint32_t>(hash.value() ^ hash.value() >> 32);
  return folded == 0 ? 1 : folded;
}

Part load_part(const PartConfig& config) {
  const auto bytes = port::read_file(config.file, model::kTemplateFileBytesMax);
  Part part{std::make_shared<model::Template>(), hash_of(bytes), config.picks};
  if (part.picks.empty()) part.picks.push_back(usual_pick());
  const Status status = model::read_template(bytes, *part.model);
  if (status != Status::kOk)
    throw port::InputError(config.file,
                           std::string("it is no template that can be used: ") + to_string(status),
                           "teach the part again, with this version");
  return part;
}

Job load_job(const JobConfig& config, const SourceConfig& source) {
  Job job{config, {}, 0};
  if (config.rule.frame != job::FrameName::kWork) return job;
  const port::WorkFile work = port::read_work_file(config.work_file);
  if (source.up && *source.up != work.up)
    throw port::InputError(source.place, "'up' contradicts " + config.work_file,
                           "leave it out, or align again with it");
  job.work = frames_of_work(work.work_T_scan);
  job.alignment_hash = hash_of(port::read_file(config.work_file, kConfigBytesMax));
  return job;
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

JobSet load_jobs(const Config& config) {
  JobSet set;
  for (const PartConfig& part : config.parts) set.parts.push_back(load_part(part));
  for (const JobConfig& job : config.jobs) set.jobs.push_back(load_job(job, config.source));
  return set;
}

}  // namespace flatpose::daemon
