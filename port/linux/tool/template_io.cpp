#include "port/linux/tool/template_io.hpp"

#include "flatpose/model/template_file.hpp"
#include "port/linux/files/atomic_file.hpp"
#include "port/linux/files/input_error.hpp"
#include "port/linux/tool/number_text.hpp"
#include "port/linux/tool/status_error.hpp"

namespace flatpose::tool {
namespace {

// Longer files are no templates, but may say what they are by their start.
constexpr std::int64_t kReadBytesMax = 1'073'741'824;

std::string likely_symmetry(const model::Template& part) {
  if (part.symmetry_likely == model::kFullSymmetry)
    return "any turn maps the contour nearly onto itself: declare --symmetry full if that is so";
  return formatted(
      "a turn by %.4g degrees maps the contour nearly onto itself: declare --symmetry %d if that "
      "is so",
      360.0 / part.symmetry_likely, part.symmetry_likely);
}

}  // namespace

bool is_template(std::span<const std::byte> bytes) noexcept {
  return port::as_text(bytes).starts_with("FPT");
}

std::unique_ptr<model::Template> load_template(const std::string& path) {
  const std::vector<std::byte> bytes = port::read_file(path, kReadBytesMax);
  auto part = std::make_unique<model::Template>();
  Status status = model::read_template(bytes, *part);
  if (bytes.empty()) throw port::InputError(path, "it is empty", "copy or teach it again");
  if (status == Status::kTruncated && !is_template(bytes)) status = Status::kBadMagic;
  if (status != Status::kOk) fail(status, Doing::kReadTemplate, path);
  return part;
}

std::vector<std::byte> template_bytes(const model::Template& part) {
  std::vector<std::byte> bytes(model::kTemplateFileBytesMax);
  const Result<std::size_t> size_bytes = model::write_template(part, bytes);
  if (!size_bytes) fail(size_bytes.status(), Doing::kWriteTemplate, "template");
  bytes.resize(*size_bytes);
  return bytes;
}

std::vector<WeakPoint> weak_points(const model::Template& part) {
  const struct {
    model::Weakness bit;
    const char* word;
    std::string sentence;
  } all[] = {
      {model::kWeakSymmetryLikely, "symmetry_likely", likely_symmetry(part)},
      {model::kWeakSymmetryDoubtful, "symmetry_doubtful",
       "the declared turn does not lay the contour onto itself: check --symmetry and "
       "--symmetry-center"},
      {model::kWeakDirectionLoose, "direction_loose",
       "the contour hardly holds one direction in the plane, or the turn: expect larger errors "
       "there"},
      {model::kWeakStepNearNoise, "step_near_noise",
       formatted("steps of %.3g mm at the contour are not far above the noise of %.3g mm: average "
                 "more scans or scan with less noise",
                 part.step_mm, part.noise_mm)},
      {model::kWeakBelowSurroundings, "below_surroundings",
       "the part lies below what surrounds it: if it should not, give the other side by --up"},
      {model::kWeakSmall, "small",
       "the part is few cells across: scan it more finely or teach a larger piece"},
      {model::kWeakMarginThin, "margin_thin",
       formatted("a wrong place in the teach scan scores %.2f, the part itself %.2f: expect "
                 "mistakes among look-alikes",
                 part.rival_score, part.self_score)},
  };
  std::vector<WeakPoint> found;
  for (const auto& weakness : all) {
    if ((part.weakness & weakness.bit) != 0) found.push_back({weakness.word, weakness.sentence});
  }
  return found;
}

}  // namespace flatpose::tool
