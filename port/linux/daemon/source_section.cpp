// [source]: where scans come from.

#include <utility>

#include "port/linux/daemon/config.hpp"
#include "port/linux/daemon/section.hpp"

namespace flatpose::daemon {

void read_source(Section section, Config& config) {
  SourceConfig& source = config.source;
  int count = 0;
  for (const auto& [key, path] :
       {std::pair{"replay", &source.replay}, std::pair{"watch", &source.watch},
        std::pair{"driver", &source.driver}}) {
    *path = section.file(key).value_or("");
    if (path->empty()) continue;
    source.place = section.place_of(key);
    if (++count > 1)
      section.fail(key, "a second source of scans", "keep one of replay, watch, driver");
  }
  if (const auto up = section.choice("up", {"+z", "-z"}))
    source.up = *up == 0 ? port::Up::kPlusZ : port::Up::kMinusZ;
  source.allow_simulated = section.flag("allow_simulated").value_or(false);
  section.finish();
}

}  // namespace flatpose::daemon
