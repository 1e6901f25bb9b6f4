#pragma once
// The jobs ready to run: templates read, work planes read, and the rules that the job machine
// needs.

#include <cstdint>
#include <memory>
#include <vector>

#include "flatpose/model/template.hpp"
#include "port/linux/daemon/alignment.hpp"
#include "port/linux/daemon/config.hpp"

namespace flatpose::daemon {

struct Part {
  std::shared_ptr<model::Template> model;  ///< Records keep it beyond a reload.
  std::uint32_t hash = 0;       ///< Of the file.
  std::vector<PickPose> picks;  ///< By falling priority; never empty.
};

struct Job {
  JobConfig config;
  Alignment alignment;
};

struct JobSet {
  std::vector<Part> parts;
  std::vector<Job> jobs;

  [[nodiscard]] const Job* find(std::uint16_t number) const noexcept;
  [[nodiscard]] job::JobTable rules() const;
  /// A line for each job whose alignment is not what it needs.
  [[nodiscard]] std::vector<std::string> problems() const;
};

/// Reads all that the jobs need.  Fails: port::InputError; an alignment that cannot be read is no
/// failure: its jobs say so when they are asked for.
[[nodiscard]] JobSet load_jobs(const Config& config);

}  // namespace flatpose::daemon
