#include "input/radiance_surfaces.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace patchlight {
namespace {

constexpr std::array surfaces = {"polygon", "sphere", "bubble", "cylinder", "tube", "cone", "cup", "ring"};

Point point_at(const RadiancePrimitive& primitive, std::size_t k) {
  return {primitive.numbers[k], primitive.numbers[k + 1], primitive.numbers[k + 2]};
}

FacetedShape turned_inside_out(FacetedShape shape) {
  for (std::vector<std::uint32_t>& face : shape.faces) std::reverse(face.begin(), face.end());
  return shape;
}

FacetedShape outline_of(const RadiancePrimitive& primitive) {
  FacetedShape shape;
  for (std::size_t k = 0; k < primitive.numbers.size(); k += 3) shape.points.push_back(point_at(primitive, k));
  shape.faces.emplace_back(shape.points.size());
  std::iota(shape.faces[0].begin(), shape.faces[0].end(), 0U);
  return shape;
}

// With two radii, or one for both ends.
FacetedShape cone_of(const RadiancePrimitive& primitive) {
  const double first = primitive.numbers[6];
  return faceted_cone(point_at(primitive, 0), point_at(primitive, 3), first,
                      primitive.numbers.size() > 7 ? primitive.numbers[7] : first);
}

FacetedShape ring_of(const RadiancePrimitive& primitive) {
  const auto [inner, outer] = std::minmax(primitive.numbers[6], primitive.numbers[7]);
  return faceted_ring(point_at(primitive, 0), point_at(primitive, 3), inner, outer);
}

void require_arguments(const RadiancePrimitive& primitive, const std::string& where) {
  const std::size_t found = primitive.numbers.size();
  const std::string start = primitive.kind + " " + primitive.name + " has " + std::to_string(found) + " numbers; ";
  if (primitive.kind == "polygon") {
    if (found >= 9 && found % 3 == 0) return;
    throw InputError(where, start + "expected three for each of its corners, nine at least");
  }
  const bool is_sphere = primitive.kind == "sphere" || primitive.kind == "bubble";
  const bool is_cylinder = primitive.kind == "cylinder" || primitive.kind == "tube";
  const std::size_t expected = is_sphere ? 4 : is_cylinder ? 7 : 8;
  if (found != expected) throw InputError(where, start + "expected " + std::to_string(expected));
  const double least = *std::min_element(primitive.numbers.begin() + (is_sphere ? 3 : 6), primitive.numbers.end());
  if (least < 0)
    throw InputError(where, primitive.kind + " " + primitive.name + " has a negative radius; expected 0 or more");
}

}  // namespace

bool is_radiance_surface(const std::string& kind) {
  return std::find(surfaces.begin(), surfaces.end(), kind) != surfaces.end();
}

bool is_round(const std::string& kind) { return is_radiance_surface(kind) && kind != "polygon"; }

FacetedShape radiance_surface(const RadiancePrimitive& primitive, const std::string& where) {
  require_arguments(primitive, where);
  const std::string& kind = primitive.kind;
  if (kind == "polygon") return outline_of(primitive);
  FacetedShape shape;
  if (kind == "sphere" || kind == "bubble") {
    if (primitive.numbers[3] > 0) shape = faceted_sphere(point_at(primitive, 0), primitive.numbers[3]);
  } else {
    shape = kind == "ring" ? ring_of(primitive) : cone_of(primitive);
  }
  if (shape.faces.empty())
    throw InputError(where, kind + " " + primitive.name +
                                " has no area; expected radii above 0 and two places, or a "
                                "direction, that are not one");
  const bool is_inside_out = kind == "bubble" || kind == "tube" || kind == "cup";
  return is_inside_out ? turned_inside_out(std::move(shape)) : shape;
}

}  // namespace patchlight
