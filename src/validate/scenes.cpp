#include "validate/scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace patchlight::validation {
namespace {

// Each triangle becomes four, whose new corners are pushed out to the sphere.
std::vector<Outline> halved(const std::vector<Outline>& triangles, double radius) {
  std::vector<Outline> result;
  for (const Outline& t : triangles) {
    const auto middle = [&](int k) -> Point { return radius * (t[k] + t[(k + 1) % 3]).normalized(); };
    const Point a = middle(0);
    const Point b = middle(1);
    const Point c = middle(2);
    for (const Outline& part : {Outline{t[0], a, c}, Outline{a, t[1], b}, Outline{c, b, t[2]}, Outline{a, b, c}}) {
      result.push_back(part);
    }
  }
  return result;
}

}  // namespace

Scene empty_scene(double reflectance, double exitance) {
  Scene scene;
  scene.materials = {{"surface", Spectrum::Constant(1, reflectance), Spectrum::Constant(1, exitance)},
                     {"lamp", Spectrum::Constant(1, 0), Spectrum::Constant(1, 1)}};
  scene.file = "validation";
  return scene;
}

Scene with_polygon(Scene scene, const Outline& corners, std::uint32_t group, MaterialIndex material) {
  Polygon polygon;
  polygon.material = material;
  polygon.group = group;
  for (const Point& corner : corners) {
    polygon.corners.push_back(static_cast<std::uint32_t>(scene.vertices.size()));
    scene.vertices.push_back(corner);
  }
  scene.polygons.push_back(std::move(polygon));
  while (scene.groups.size() <= group) scene.groups.push_back("group " + std::to_string(scene.groups.size()));
  return scene;
}

Outline turned(Outline corners) {
  std::reverse(corners.begin(), corners.end());
  return corners;
}

Outline rectangle(const Point& corner, const Vector& u, const Vector& v) {
  return {corner, corner + u, corner + u + v, corner + v};
}

Outline regular_polygon(int corners, double radius, double z) {
  Outline outline;
  for (int k = 0; k < corners; ++k) {
    const double angle = 2 * std::numbers::pi * k / corners;
    outline.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
  }
  return outline;
}

std::vector<Outline> prism_walls(int sides, double radius, double height) {
  const Outline base = regular_polygon(sides, radius, 0);
  std::vector<Outline> walls;
  for (std::size_t k = 0; k < base.size(); ++k) {
    walls.push_back(rectangle(base[k], base[(k + 1) % base.size()] - base[k], height * Vector::UnitZ()));
  }
  return walls;
}

std::vector<Outline> sphere_triangles(int halvings, double radius) {
  std::vector<Outline> sphere;
  for (int octant = 0; octant < 8; ++octant) {
    const auto sign = [&](int axis) { return (octant >> axis & 1) == 0 ? 1.0 : -1.0; };
    std::vector<Outline> part{{{sign(0) * radius, 0, 0}, {0, sign(1) * radius, 0}, {0, 0, sign(2) * radius}}};
    if (sign(0) * sign(1) * sign(2) < 0) part[0] = turned(part[0]);
    for (int k = 0; k < halvings; ++k) part = halved(part, radius);
    sphere.insert(sphere.end(), part.begin(), part.end());
  }
  return sphere;
}

std::vector<Outline> cube_walls() {
  const Vector x = Vector::UnitX();
  const Vector y = Vector::UnitY();
  const Vector z = Vector::UnitZ();
  const Point origin = Point::Zero();
  return {rectangle(origin, x, y), rectangle(z, y, x),      rectangle(origin, z, x),
          rectangle(y, x, z),      rectangle(origin, y, z), rectangle(x, z, y)};
}

}  // namespace patchlight::validation
