#include "port/linux/tool/region_text.hpp"

#include <string>

#include "flatpose/geometry/vec3.hpp"
#include "port/linux/files/input_error.hpp"
#include "port/linux/tool/number_text.hpp"

namespace flatpose::tool {
namespace {

Region parse_circle(std::string_view option, std::string_view text) {
  const auto numbers = parse_numbers(option, text, 3, "circle:X,Y,R");
  Region region;
  region.kind = Region::Kind::kCircle;
  region.x_mm = numbers[0];
  region.y_mm = numbers[1];
  region.radius_mm = numbers[2];
  return region;
}

void add_corner(Region& region, double x_mm, double y_mm) {
  region.vertex_x_mm[region.vertex_count] = x_mm;
  region.vertex_y_mm[region.vertex_count] = y_mm;
  ++region.vertex_count;
}

Region parse_box(std::string_view option, std::string_view text) {
  const auto numbers = parse_numbers(option, text, 4, "box:X0,Y0,X1,Y1");
  Region region;
  region.kind = Region::Kind::kBox;
  add_corner(region, numbers[0], numbers[1]);
  add_corner(region, numbers[2], numbers[3]);
  return region;
}

// Corners on one line have a box around them all the same.
bool lie_on_one_line(const Region& region) {
  const auto corner = [&](int i) {
    return Vec3{region.vertex_x_mm[i] - region.vertex_x_mm[0],
                region.vertex_y_mm[i] - region.vertex_y_mm[0], 0.0};
  };
  for (int i = 1; i < region.vertex_count; ++i) {
    for (int j = i + 1; j < region.vertex_count; ++j) {
      if (cross(corner(i), corner(j)).z != 0.0) return false;
    }
  }
  return true;
}

Region parse_polygon(std::string_view option, std::string_view text) {
  const auto corners = split(text, ';');
  if (corners.size() > static_cast<std::size_t>(Region::kVertexCountMax))
    throw port::InputError(option, "a polygon of " + std::to_string(corners.size()) + " corners",
                           "give at most " + std::to_string(Region::kVertexCountMax));
  Region region;
  region.kind = Region::Kind::kPolygon;
  for (const std::string_view corner : corners) {
    const auto numbers = parse_numbers(option, corner, 2, "polygon:X,Y;X,Y;X,Y");
    add_corner(region, numbers[0], numbers[1]);
  }
  return region;
}

}  // namespace

Region parse_region(std::string_view option, std::string_view text) {
  const struct {
    std::string_view prefix;
    Region (*parse)(std::string_view, std::string_view);
  } kinds[] = {{"circle:", parse_circle}, {"box:", parse_box}, {"polygon:", parse_polygon}};
  for (const auto& kind : kinds) {
    if (!text.starts_with(kind.prefix)) continue;
    const Region region = kind.parse(option, text.substr(kind.prefix.size()));
    const bool is_line = region.kind == Region::Kind::kPolygon && lie_on_one_line(region);
    if (!is_valid(region) || is_line)
      throw port::InputError(option, "\"" + port::printable(text, 100) + "\" encloses no area",
                             "give a radius above 0, or corners that lie apart");
    return region;
  }
  throw port::InputError(option, "\"" + port::printable(text, 100) + "\" is no region",
                         "write circle:X,Y,R or box:X0,Y0,X1,Y1 or polygon:X,Y;X,Y;X,Y in mm");
}

}  // namespace flatpose::tool
