#include "flatpose/model/template_file.hpp"

#include <bit>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "flatpose/core/fnv.hpp"
#include "flatpose/model/landmarks.hpp"

namespace flatpose::model {
namespace {

constexpr std::array<char, 4> kMagic{'F', 'P', 'T', '\n'};
constexpr std::size_t kHeaderBytes = 20;

static_assert(kContourPointCountMax * sizeof(ContourPoint) +
                  kSurfacePointCountMax * sizeof(SurfacePoint) + 1024 <=
              kTemplateFileBytesMax);

template <std::size_t Size>
struct UnsignedOf;
template <>
struct UnsignedOf<1> {
  using type = std::uint8_t;
};
template <>
struct UnsignedOf<4> {
  using type = std::uint32_t;
};
template <>
struct UnsignedOf<8> {
  using type = std::uint64_t;
};

// Both directions walk the fields by one function (visit), so that they cannot disagree.
class Writer {
 public:
  explicit Writer(std::span<std::byte> bytes) noexcept : bytes_(bytes) {}

  template <class T>
  void field(const T& value) noexcept {
    using Unsigned = typename UnsignedOf<sizeof(T)>::type;
    const auto bits = std::bit_cast<Unsigned>(value);
    for (std::size_t i = 0; i < sizeof(T); ++i)
      put(static_cast<std::byte>((bits >> (8 * i)) & 0xFFU));
  }
  [[nodiscard]] bool failed() const noexcept { return failed_; }
  [[nodiscard]] std::size_t position() const noexcept { return position_; }

 private:
  void put(std::byte value) noexcept {
    if (position_ < bytes_.size()) {
      bytes_[position_++] = value;
    } else {
      failed_ = true;
    }
  }
  std::span<std::byte> bytes_;
  std::size_t position_ = 0;
  bool failed_ = false;
};

class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) noexcept : bytes_(bytes) {}

  template <class T>
  void field(T& value) noexcept {
    using Unsigned = typename UnsignedOf<sizeof(T)>::type;
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i)
      bits |= static_cast<std::uint64_t>(get()) << (8 * i);
    value = std::bit_cast<T>(static_cast<Unsigned>(bits));
  }
  [[nodiscard]] bool failed() const noexcept { return failed_; }
  [[nodiscard]] std::size_t position() const noexcept { return position_; }

 private:
  std::uint8_t get() noexcept {
    if (position_ < bytes_.size()) return static_cast<std::uint8_t>(bytes_[position_++]);
    failed_ = true;
    return 0;
  }
  std::span<const std::byte> bytes_;
  std::size_t position_ = 0;
  bool failed_ = false;
};

// Counts come before their clouds; a reader bounds them before it goes on.
bool counts_are_valid(const Template& part) noexcept {
  return part.contour_count >= 0 && part.contour_count <= kContourPointCountMax &&
         part.surface_count >= 0 && part.surface_count <= kSurfacePointCountMax &&
         part.anchor_count >= 0 && part.anchor_count <= kAnchorCountMax;
}

template <class Stream, class T>
void visit(Stream& stream, T& part) noexcept {
  for (auto& c : part.name) stream.field(c);
  stream.field(part.symmetry.order);
  stream.field(part.symmetry.center_x_mm);
  stream.field(part.symmetry.center_y_mm);
  for (auto* value :
       {&part.cell_mm, &part.pitch_mm, &part.noise_mm, &part.step_mm, &part.area_mm2,
        &part.radius_mm, &part.score_threshold, &part.self_score, &part.rival_score}) {
    stream.field(*value);
  }
  for (auto& m : part.scan_T_object.rotation.m) stream.field(m);
  stream.field(part.scan_T_object.position_mm.x);
  stream.field(part.scan_T_object.position_mm.y);
  stream.field(part.scan_T_object.position_mm.z);
  stream.field(part.up);
  stream.field(part.frame);
  stream.field(part.weakness);
  stream.field(part.symmetry_likely);
  stream.field(part.contour_count);
  stream.field(part.surface_count);
  stream.field(part.anchor_count);
  if (stream.failed() || !counts_are_valid(part)) return;
  for (int i = 0; i < part.contour_count; ++i) {
    auto& p = part.contour[i];
    for (auto* value : {&p.x_mm, &p.y_mm, &p.z_mm, &p.nx, &p.ny, &p.step_mm, &p.spread_mm})
      stream.field(*value);
  }
  for (int i = 0; i < part.surface_count; ++i) {
    auto& p = part.surface[i];
    for (auto* value : {&p.x_mm, &p.y_mm, &p.z_mm, &p.nx, &p.ny, &p.weight}) stream.field(*value);
  }
  for (int i = 0; i < part.anchor_count; ++i) {
    auto& a = part.anchors[i];
    for (auto* value : {&a.x_mm, &a.y_mm, &a.clearance_mm}) stream.field(*value);
  }
}

bool is_finite_within(double value, double low, double high) noexcept {
  return value >= low && value <= high;
}

constexpr double kCoordinateMax_mm = 1e6;

bool clouds_are_valid(const Template& part) noexcept {
  constexpr double kUnitSlack = 1e-3;
  for (const ContourPoint& p : part.contour_points()) {
    for (const float v : {p.x_mm, p.y_mm, p.z_mm, p.step_mm, p.spread_mm}) {
      if (!is_finite_within(v, -kCoordinateMax_mm, kCoordinateMax_mm)) return false;
    }
    const double length2 = static_cast<double>(p.nx) * p.nx + static_cast<double>(p.ny) * p.ny;
    if (!is_finite_within(length2, 1.0 - kUnitSlack, 1.0 + kUnitSlack)) return false;
  }
  for (const SurfacePoint& p : part.surface_points()) {
    for (const float v : {p.x_mm, p.y_mm, p.z_mm}) {
      if (!is_finite_within(v, -kCoordinateMax_mm, kCoordinateMax_mm)) return false;
    }
    const double length2 = static_cast<double>(p.nx) * p.nx + static_cast<double>(p.ny) * p.ny;
    if (!is_finite_within(length2, 0.0, 1.0)) return false;
    if (!is_finite_within(p.weight, 0.0, kSurfacePointCountMax)) return false;
  }
  for (int i = 0; i < part.anchor_count; ++i) {
    const Anchor& a = part.anchors[i];
    if (!is_finite_within(a.x_mm, -kCoordinateMax_mm, kCoordinateMax_mm) ||
        !is_finite_within(a.y_mm, -kCoordinateMax_mm, kCoordinateMax_mm) ||
        !is_finite_within(a.clearance_mm, 0.0, kCoordinateMax_mm)) {
      return false;
    }
  }
  return true;
}

bool pose_is_valid(const Pose& pose) noexcept {
  constexpr double kSlack = 1e-6;
  const Rotation identity = pose.rotation * pose.rotation.inverse();
  for (int i = 0; i < 9; ++i) {
    if (!(std::fabs(identity.m[i] - (i % 4 == 0 ? 1.0 : 0.0)) < kSlack)) return false;
  }
  const Rotation& r = pose.rotation;
  if (!(dot(cross(r.column(0), r.column(1)), r.column(2)) > 0.0)) return false;
  for (const double v : {pose.position_mm.x, pose.position_mm.y, pose.position_mm.z}) {
    if (!is_finite_within(v, -kCoordinateMax_mm, kCoordinateMax_mm)) return false;
  }
  return true;
}

}  // namespace

bool is_valid(const Template& part) noexcept {
  constexpr int kSymmetryOrderMax = 64;
  if (!counts_are_valid(part) || part.contour_count < 1 || part.surface_count < 3 ||
      part.anchor_count < 1)
    return false;
  if (part.name.back() != '\0') return false;
  for (const int order : {part.symmetry.order, part.symmetry_likely}) {
    if (order < 0 || order > kSymmetryOrderMax) return false;
  }
  if (!is_finite_within(part.symmetry.center_x_mm, -kCoordinateMax_mm, kCoordinateMax_mm) ||
      !is_finite_within(part.symmetry.center_y_mm, -kCoordinateMax_mm, kCoordinateMax_mm)) {
    return false;
  }
  for (const double v : {part.cell_mm, part.pitch_mm, part.radius_mm}) {
    if (!is_finite_within(v, 1e-4, kCoordinateMax_mm)) return false;
  }
  for (const double v : {part.noise_mm, part.step_mm}) {
    if (!is_finite_within(v, 0.0, kCoordinateMax_mm)) return false;
  }
  for (const double v : {part.score_threshold, part.self_score, part.rival_score}) {
    if (!is_finite_within(v, 0.0, 1.0)) return false;
  }
  return is_finite_within(part.area_mm2, 0.0, kCoordinateMax_mm * kCoordinateMax_mm) &&
         (part.up == 1 || part.up == -1) && part.frame <= Frame::kWork &&
         pose_is_valid(part.scan_T_object) && clouds_are_valid(part);
}

Result<std::size_t> write_template(const Template& part, std::span<std::byte> bytes) noexcept {
  if (!is_valid(part)) return Status::kInvalidArgument;
  if (bytes.size() < kHeaderBytes) return Status::kOutOfMemory;
  Writer payload(bytes.subspan(kHeaderBytes));
  visit(payload, part);
  if (payload.failed()) return Status::kOutOfMemory;
  Fnv1a64 checksum;
  checksum.add(std::span<const std::byte>(bytes.subspan(kHeaderBytes, payload.position())));
  Writer header(bytes);
  for (const char c : kMagic) header.field(c);
  header.field(kTemplateFileVersion);
  header.field(static_cast<std::uint32_t>(payload.position()));
  header.field(checksum.value());
  return kHeaderBytes + payload.position();
}

Status read_template(std::span<const std::byte> bytes, Template& part) noexcept {
  Reader header(bytes);
  for (const char expected : kMagic) {
    char c = 0;
    header.field(c);
    if (c != expected) return Status::kBadMagic;
  }
  std::uint32_t version = 0;
  std::uint32_t payload_bytes = 0;
  std::uint64_t checksum = 0;
  header.field(version);
  header.field(payload_bytes);
  header.field(checksum);
  if (header.failed()) return Status::kTruncated;
  if (version != kTemplateFileVersion) return Status::kBadVersion;
  if (bytes.size() - kHeaderBytes < payload_bytes) return Status::kTruncated;
  if (bytes.size() - kHeaderBytes > payload_bytes)
    return Status::kBadChecksum;  // more than was written
  const std::span<const std::byte> payload = bytes.subspan(kHeaderBytes, payload_bytes);
  Fnv1a64 found;
  found.add(payload);
  if (found.value() != checksum) return Status::kBadChecksum;
  Reader reader(payload);
  Template read;
  visit(reader, read);
  if (reader.failed()) return Status::kTruncated;
  if (reader.position() != payload.size() || !is_valid(read)) return Status::kInvalidArgument;
  read.landmarks = find_landmarks(read);
  part = read;
  return Status::kOk;
}

}  // namespace flatpose::model
