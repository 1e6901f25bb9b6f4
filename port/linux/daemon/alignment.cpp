#include "port/linux/daemon/alignment.hpp"

#include "flatpose/core/fnv.hpp"
#include "port/linux/daemon/file_hash.hpp"
#include "port/linux/files/input_error.hpp"
#include "port/linux/files/robot_file.hpp"
#include "port/linux/files/work_file.hpp"

namespace flatpose::daemon {

bool Alignment::serves(job::FrameName frame) const noexcept {
  const bool has_work = work_file.empty() || work_T_scan.has_value();  // of what was named, all
  switch (frame) {
    case job::FrameName::kScan: return has_work;
    case job::FrameName::kWork: return work_T_scan.has_value();
    case job::FrameName::kRobot: return has_work && robot_T_scan.has_value();
  }
  return false;
}

Frames Alignment::frames(job::FrameName frame, port::Up up) const noexcept {
  Frames frames = frames_of_scan(up == port::Up::kPlusZ);
  if (work_T_scan) frames.work_T_scan = *work_T_scan;
  const Pose scan_T_work = frames.work_T_scan.inverse();
  switch (frame) {
    case job::FrameName::kScan:
      if (work_T_scan) frames.face_T_work = scan_T_work;
      break;
    case job::FrameName::kWork: frames.face_T_work = {}; break;
    case job::FrameName::kRobot: frames.face_T_work = *robot_T_scan * scan_T_work; break;
  }
  return frames;
}

Alignment load_alignment(const std::string& work_file, const std::string& robot_file,
                         job::FrameName frame, std::optional<port::Up> up) {
  Alignment alignment{work_file, robot_file, {}, {}, {}, 0, {}};
  FileHash hash;
  try {
    if (!work_file.empty()) {
      hash.add_file(work_file);
      const port::WorkFile work = port::read_work_file(work_file);
      if (up && *up != work.up)
        throw port::InputError(work_file, "it was aligned with the other side up than 'up' says",
                               "leave 'up' out, or align again with it");
      alignment.work_up = work.up;
      alignment.work_T_scan = work.work_T_scan;
    }
    if (frame == job::FrameName::kRobot && robot_file.empty())
      throw port::InputError(
          "frame \"robot\"", "there is no alignment",
          "write alignment = \"ROBOT.json\", as flatpose align --touch wrote it");
    if (!robot_file.empty()) {
      hash.add_file(robot_file);
      alignment.robot_T_scan = port::read_robot_file(robot_file).robot_T_scan;
    }
  } catch (const port::InputError& error) {
    alignment.problem = error.line();
  }
  if (alignment.work_T_scan || alignment.robot_T_scan) alignment.hash = hash.value();
  return alignment;
}

}  // namespace flatpose::daemon
