#pragma once

#include "support/scenes.h"

#include <cmath>
#include <utility>

// The room in which solvers are compared.
namespace patchlight::test {

/// A box given by its middle and the half lengths of its edges, turned about z by `angle`.
struct TurnedBox {
  Point middle;
  Vector half;
  double angle;  ///< radians
};

/// The six faces of the box, two triangles each; fronts outward.
inline Scene with_triangles(Scene scene, const TurnedBox& box, MaterialIndex material) {
  const Eigen::Affine3d placed =
      Eigen::Translation3d(box.middle) * Eigen::AngleAxisd(box.angle, Vector::UnitZ()) * Eigen::Scaling(box.half);
  for (Quad face : box_faces(Point(-1, -1, -1), Point(1, 1, 1), false)) {
    for (Point& corner : face) corner = placed * corner;
    scene = with_polygon(std::move(scene), {face[0], face[1], face[2]}, material);
    scene = with_polygon(std::move(scene), {face[0], face[2], face[3]}, material);
  }
  return scene;
}

/// A closed room of 4 x 3 x 2.5 m with two turned blocks and a thin slab, which all float. A lamp of 0.6 x 0.6 m in the
/// middle of the ceiling reflects like the rest. All faces are triangles.
inline Scene test_room(double reflectance) {
  Scene scene = empty_scene({grey(reflectance), grey(reflectance, 10)});
  const std::vector<Quad> faces = box_faces(Point(0, 0, 0), Point(4, 3, 2.5), true);
  for (std::size_t face = 0; face < faces.size(); ++face) {
    const Quad& q = faces[face];
    if (face == 1) continue;
    scene = with_polygon(std::move(scene), {q[0], q[1], q[2]});
    scene = with_polygon(std::move(scene), {q[0], q[2], q[3]});
  }
  // The ceiling around the lamp, clockwise from above.
  const Quad outer = faces[1];
  const Quad inner{Point(1.7, 1.2, 2.5), Point(1.7, 1.8, 2.5), Point(2.3, 1.8, 2.5), Point(2.3, 1.2, 2.5)};
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t next = (k + 1) % 4;
    scene = with_polygon(std::move(scene), {outer[k], outer[next], inner[k]});
    scene = with_polygon(std::move(scene), {inner[k], outer[next], inner[next]});
  }
  scene = with_polygon(std::move(scene), {inner[0], inner[1], inner[2]}, 1);
  scene = with_polygon(std::move(scene), {inner[0], inner[2], inner[3]}, 1);
  scene = with_triangles(std::move(scene), {Point(1.2, 1.0, 0.8), Vector(0.3, 0.3, 0.6), 0.3}, 0);
  scene = with_triangles(std::move(scene), {Point(2.7, 1.9, 0.6), Vector(0.35, 0.35, 0.35), -0.38}, 0);
  return with_triangles(std::move(scene), {Point(2.6, 0.7, 1.0), Vector(0.5, 0.3, 0.02), 0.1}, 0);
}

/// The edge at which the room has 2,238 patches.
inline constexpr double test_room_edge = 0.329;

}  // namespace patchlight::test
