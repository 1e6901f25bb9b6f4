#include "port/linux/records/record_text.hpp"
#include "port/linux/tool/number_text.hpp"
#include "port/linux/tool/overlay.hpp"

namespace flatpose::port {

std::vector<std::byte> record_picture(const Record& record) {
  tool::Overlay overlay;
  const SearchTrace& trace = record.trace;
  int number = 0;
  for (int i = 0; i < trace.part_count; ++i) {
    const SearchedPart& searched = trace.parts[static_cast<std::size_t>(i)];
    for (const locate::Match& match : searched.result.found())
      overlay.marks.push_back({match.face_T_object,
                               tool::formatted("#%d  %.2f", ++number, match.score),
                               searched.part.get()});
  }
  const std::string time = utc_text(record.since_1970_us);
  overlay.title = tool::formatted("command %u, job %u: %s; %s", unsigned{record.order.number},
                                  unsigned{record.order.job}, job::to_string(record.result.answer),
                                  time.c_str());
  static const model::Template kNone{};
  const bool has_part = trace.part_count > 0;
  return tool::draw_overlay(overlay, has_part ? *trace.parts[0].part : kNone, record.loaded);
}

}  // namespace flatpose::port
