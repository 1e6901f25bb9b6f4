// [[part]] and its [[part.pick]]: what is searched, and where tools may take it.

#include <algorithm>

#include "port/linux/daemon/config.hpp"
#include "port/linux/daemon/rotation_setting.hpp"
#include "port/linux/daemon/section.hpp"

namespace flatpose::daemon {
namespace {

constexpr std::size_t kPartsMax = 64;
constexpr std::size_t kPicksMax = 64;
constexpr double kPickReachMax_mm = 1.0e5;
constexpr Range kTools{1, 65534};
constexpr Range kPriorities{-1'000'000, 1'000'000};

PickPose read_pick(Section section, std::size_t index) {
  PickPose pick = usual_pick();
  pick.index = static_cast<std::uint16_t>(index + 1);
  const auto position = section.numbers("position_mm", -kPickReachMax_mm, kPickReachMax_mm, 3);
  if (!position.empty()) pick.object_T_pick.position_mm = {position[0], position[1], position[2]};
  const auto convention =
      static_cast<Convention>(section.choice("convention", convention_words()).value_or(0));
  if (const auto numbers = read_rotation_numbers(section, "rotation", convention))
    pick.object_T_pick.rotation = rotation_from_numbers(*numbers, convention);
  pick.tool = static_cast<std::uint16_t>(section.whole("tool", kTools).value_or(1));
  pick.priority = section.whole("priority", kPriorities).value_or(0);
  section.finish();
  return pick;
}

}  // namespace

void read_part(Section section, Config& config) {
  PartConfig part;
  part.name = section.text("name").value_or("");
  part.file = section.file("file").value_or("");
  if (part.name.empty()) section.fail("name", "a part needs a name", "write name = \"...\"");
  if (part.file.empty())
    section.fail("file", "a part needs a file",
                 "write file = \"PART.fpt\", as flatpose teach wrote it");
  for (const PartConfig& other : config.parts)
    if (other.name == part.name)
      section.fail("name", "there are two parts of this name", "rename one");
  if (config.parts.size() == kPartsMax)
    section.fail("name", "there are more than 64 parts", "take some out");
  const std::vector<Section> picks = section.sections("pick");
  if (picks.size() > kPicksMax)
    section.fail("pick", "the part has more than 64 picks", "take some out");
  for (std::size_t i = 0; i < picks.size(); ++i) part.picks.push_back(read_pick(picks[i], i));
  std::stable_sort(part.picks.begin(), part.picks.end(),
                   [](const PickPose& a, const PickPose& b) { return a.priority > b.priority; });
  section.finish();
  config.parts.push_back(std::move(part));
}

}  // namespace flatpose::daemon
