#include "input/radiance/radiance_genbox.h"

#include "patchlight/base/error.h"
#include "patchlight/base/geometry.h"

#include "input/text.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <utility>

namespace patchlight {
namespace {

enum class Edges : std::uint8_t { sharp, bevelled, round };

struct RadianceBox {
  std::string material;
  std::string name;
  Vector size = Vector::Zero();
  double inset = 0;  // from the sides of the box: the bevel or the radius of its edges
  Edges edges = Edges::sharp;
  bool is_inward = false;
};

double length_of(const std::string& word, const std::string& where) {
  const std::optional<double> length = finite_number(word);
  if (!length || !(*length > 0)) throw InputError(where, "genbox: found '" + word + "'; expected a length above 0");
  return *length;
}

RadianceBox box_of(std::span<const std::string> words, const std::string& where) {
  constexpr std::size_t least = 5;
  if (words.size() < least) throw InputError(where, "genbox: expected MATERIAL NAME X Y Z and options");
  RadianceBox box{.material = words[0], .name = words[1]};
  for (std::size_t axis = 0; axis < 3; ++axis)
    box.size[static_cast<Eigen::Index>(axis)] = length_of(words[2 + axis], where);
  for (std::size_t k = least; k < words.size(); ++k) {
    if (words[k] == "-i") {
      box.is_inward = true;
    } else if (words[k] == "-b" || words[k] == "-r") {
      box.edges = words[k] == "-b" ? Edges::bevelled : Edges::round;
      if (++k == words.size()) throw InputError(where, "genbox: a length has to follow " + words[k - 1]);
      box.inset = length_of(words[k], where);
    } else {
      throw InputError(where, "genbox: the option " + words[k] + " is not known; expected -b, -r or -i");
    }
  }
  if (!(2 * box.inset < box.size.minCoeff()))
    throw InputError(where, "genbox: edges of " + std::to_string(box.inset) +
                                " do not fit; expected less than half of the shortest side");
  return box;
}

// A corner of the box; bit k is set at the far end of axis k.
using Corner = unsigned;

bool is_far(Corner corner, Eigen::Index axis) { return (corner >> static_cast<unsigned>(axis) & 1U) != 0; }

// The corner moved inward along all axes by the inset.
Point inner_point(const RadianceBox& box, Corner corner) {
  Point point;
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    point[axis] = is_far(corner, axis) ? box.size[axis] - box.inset : box.inset;
  return point;
}

// The same on the side of the box across `axis`.
Point point_on_side(const RadianceBox& box, Corner corner, Eigen::Index axis) {
  Point point = inner_point(box, corner);
  point[axis] = is_far(corner, axis) ? box.size[axis] : 0;
  return point;
}

class BoxSurfaces {
 public:
  explicit BoxSurfaces(RadianceBox box) : box_(std::move(box)) {}

  void add_polygon(std::vector<Point> corners) {
    // The box is convex: a front looks away from its middle.
    const bool looks_outward = area_vector(corners).dot(corners[0] - box_.size / 2) > 0;
    if (looks_outward == box_.is_inward) std::reverse(corners.begin(), corners.end());
    RadiancePrimitive& polygon = add("polygon");
    for (const Point& corner : corners) polygon.numbers.insert(polygon.numbers.end(), corner.begin(), corner.end());
  }

  void add_cylinder(const Point& from, const Point& to) {
    RadiancePrimitive& cylinder = add(box_.is_inward ? "tube" : "cylinder");
    cylinder.numbers = {from.x(), from.y(), from.z(), to.x(), to.y(), to.z(), box_.inset};
  }

  void add_sphere(const Point& centre) {
    add(box_.is_inward ? "bubble" : "sphere").numbers = {centre.x(), centre.y(), centre.z(), box_.inset};
  }

  std::vector<RadiancePrimitive> primitives() && { return std::move(primitives_); }

 private:
  RadiancePrimitive& add(const char* kind) {
    primitives_.push_back({.modifier = box_.material, .kind = kind, .name = box_.name, .words = {}, .numbers = {}});
    return primitives_.back();
  }

  RadianceBox box_;
  std::vector<RadiancePrimitive> primitives_;
};

}  // namespace

std::vector<RadiancePrimitive> radiance_genbox(std::span<const std::string> arguments, const std::string& where) {
  const RadianceBox box = box_of(arguments, where);
  BoxSurfaces surfaces(box);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const Corner along = 1U << static_cast<unsigned>(axis);
    const Corner next = 1U << static_cast<unsigned>((axis + 1) % 3);
    const Corner last = 1U << static_cast<unsigned>((axis + 2) % 3);
    // The sides across this axis
    for (const Corner side : {0U, along}) {
      std::vector<Point> corners;
      for (const Corner corner : {side, side | next, side | next | last, side | last})
        corners.push_back(point_on_side(box, corner, axis));
      surfaces.add_polygon(std::move(corners));
    }
    if (box.edges == Edges::sharp) continue;
    // The edges along this axis
    for (const Corner edge : std::array{0U, next, last, next | last}) {
      if (box.edges == Edges::round) {
        surfaces.add_cylinder(inner_point(box, edge), inner_point(box, edge | along));
        continue;
      }
      const Eigen::Index a = (axis + 1) % 3, b = (axis + 2) % 3;
      surfaces.add_polygon({point_on_side(box, edge, a), point_on_side(box, edge | along, a),
                            point_on_side(box, edge | along, b), point_on_side(box, edge, b)});
    }
  }
  // The corners
  constexpr Corner corners = 8;
  for (Corner corner = 0; corner < corners && box.edges != Edges::sharp; ++corner) {
    if (box.edges == Edges::round)
      surfaces.add_sphere(inner_point(box, corner));
    else
      surfaces.add_polygon(
          {point_on_side(box, corner, 0), point_on_side(box, corner, 1), point_on_side(box, corner, 2)});
  }
  return std::move(surfaces).primitives();
}

}  // namespace patchlight
