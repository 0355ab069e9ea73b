#pragma once

#include "patchlight/scene/scene.h"

#include <array>
#include <initializer_list>
#include <vector>

// Small scenes of one band, built by hand.
namespace patchlight::test {

using Quad = std::array<Point, 4>;

inline Material grey(double reflectance, double exitance = 0) {
  return {"grey", Spectrum::Constant(1, reflectance), Spectrum::Constant(1, exitance)};
}

inline Scene empty_scene(std::vector<Material> materials) {
  Scene scene;
  scene.materials = std::move(materials);
  scene.groups = {"test"};
  scene.file = "test";
  return scene;
}

// Adds a polygon with separate vertices.
inline Scene with_polygon(Scene scene, const std::vector<Point>& corners, MaterialIndex material = 0) {
  Polygon polygon;
  polygon.material = material;
  for (const Point& corner : corners) {
    polygon.corners.push_back(static_cast<std::uint32_t>(scene.vertices.size()));
    scene.vertices.push_back(corner);
  }
  scene.polygons.push_back(polygon);
  return scene;
}

inline Scene with_quad(Scene scene, const Quad& corners, MaterialIndex material = 0) {
  return with_polygon(std::move(scene), {corners.begin(), corners.end()}, material);
}

// The six faces of a box: floor, ceiling, and the walls at low y, high x, high y, low x; fronts inward or outward.
inline std::vector<Quad> box_faces(const Point& a, const Point& b, bool inward) {
  const auto p = [&](int x, int y, int z) { return Point(x ? b.x() : a.x(), y ? b.y() : a.y(), z ? b.z() : a.z()); };
  std::vector<Quad> faces{
      {p(0, 0, 0), p(1, 0, 0), p(1, 1, 0), p(0, 1, 0)}, {p(0, 0, 1), p(0, 1, 1), p(1, 1, 1), p(1, 0, 1)},
      {p(0, 0, 0), p(0, 0, 1), p(1, 0, 1), p(1, 0, 0)}, {p(1, 0, 0), p(1, 0, 1), p(1, 1, 1), p(1, 1, 0)},
      {p(1, 1, 0), p(1, 1, 1), p(0, 1, 1), p(0, 1, 0)}, {p(0, 1, 0), p(0, 1, 1), p(0, 0, 1), p(0, 0, 0)}};
  if (!inward) {
    for (Quad& face : faces) std::swap(face[1], face[3]);
  }
  return faces;
}

inline Scene with_box(Scene scene, const Point& a, const Point& b, bool inward, MaterialIndex material = 0) {
  for (const Quad& face : box_faces(a, b, inward)) scene = with_quad(std::move(scene), face, material);
  return scene;
}

// A closed unit cube of one material.
inline Scene cube_room(double reflectance, double exitance) {
  return with_box(empty_scene({grey(reflectance, exitance)}), Point(0, 0, 0), Point(1, 1, 1), true);
}

// A closed 4 x 3 x 2.5 m room with a floating box, and a lamp 1 cm below the middle of its ceiling.
inline Scene furnished_room(double reflectance, double lamp_exitance = 10) {
  Scene scene = empty_scene({grey(reflectance), grey(0, lamp_exitance)});
  scene = with_box(std::move(scene), Point(0, 0, 0), Point(4, 3, 2.5), true);
  scene = with_box(std::move(scene), Point(1, 1, 0.5), Point(2, 1.8, 1.2), false);
  return with_quad(std::move(scene),
                   {Point(2.5, 1, 2.49), Point(2.5, 2, 2.49), Point(3.5, 2, 2.49), Point(3.5, 1, 2.49)}, 1);
}

inline Scene moved(Scene scene, const Eigen::Affine3d& motion) {
  for (Point& vertex : scene.vertices) vertex = motion * vertex;
  for (Luminaire& luminaire : scene.luminaires) luminaire.position = motion * luminaire.position;
  return scene;
}

}  // namespace patchlight::test
