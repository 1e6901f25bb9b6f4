// [source]: where scans come from.

#include "port/linux/daemon/config.hpp"
#include "port/linux/daemon/section.hpp"

namespace flatpose::daemon {

void read_source(Section section, Config& config) {
  SourceConfig& source = config.source;
  source.replay = section.file("replay").value_or("");
  source.place = section.place_of("replay");
  if (const auto up = section.choice("up", {"+z", "-z"}))
    source.up = *up == 0 ? port::Up::kPlusZ : port::Up::kMinusZ;
  source.allow_simulated = section.flag("allow_simulated").value_or(false);
  section.finish();
}

}  // namespace flatpose::daemon
