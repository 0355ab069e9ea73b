#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/scene/scene.h"
#include "patchlight/scene/sides.h"

#include <array>
#include <vector>

namespace patchlight {

using Quad = std::array<Point, 4>;

/// A scene of separate quadrilaterals, all of one material.
inline Scene quad_scene(const std::vector<Quad>& quads) {
  Scene scene;
  scene.materials = {{"paint", rgb(0.5, 0.5, 0.5), rgb(1, 1, 1)}};
  for (const Quad& quad : quads) {
    Polygon polygon;
    for (const Point& corner : quad) {
      polygon.corners.push_back(static_cast<std::uint32_t>(scene.vertices.size()));
      scene.vertices.push_back(corner);
    }
    scene.polygons.push_back(polygon);
  }
  return scene;
}

/// One patch per quadrilateral, on its front side.
inline PatchMesh front_patches(const Scene& scene) {
  PatchMesh mesh;
  mesh.vertices = scene.vertices;
  mesh.first_patch = {0};
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const std::vector<Point> points = corner_points(scene, p);
    const auto& corners = scene.polygons[p].corners;
    mesh.corners.push_back({corners[0], corners[1], corners[2], corners[3]});
    mesh.centroid.push_back(area_centroid(points));
    mesh.normal.push_back(front_normal(scene, p));
    mesh.area.push_back(area_vector(points).norm());
    mesh.material.push_back(0);
    mesh.polygon.push_back(p);
    mesh.side.push_back(Side::front);
    mesh.first_patch.insert(mesh.first_patch.end(), {p + 1, p + 1});
  }
  return mesh;
}

inline KeptSides front_sides(const Scene& scene) {
  return {std::vector<std::uint8_t>(scene.polygons.size(), 1),
          std::vector<std::uint8_t>(scene.polygons.size(), 0),
          false,
          {}};
}

/// The six inner sides of the box between two corners, in the order x low, x high, y low, y high, z low, z high.
inline std::vector<Quad> inner_sides(const Point& a, const Point& b) {
  const auto corner = [&](int x, int y, int z) {
    return Point(x ? b.x() : a.x(), y ? b.y() : a.y(), z ? b.z() : a.z());
  };
  return {{corner(0, 0, 0), corner(0, 1, 0), corner(0, 1, 1), corner(0, 0, 1)},
          {corner(1, 0, 0), corner(1, 0, 1), corner(1, 1, 1), corner(1, 1, 0)},
          {corner(0, 0, 0), corner(0, 0, 1), corner(1, 0, 1), corner(1, 0, 0)},
          {corner(0, 1, 0), corner(1, 1, 0), corner(1, 1, 1), corner(0, 1, 1)},
          {corner(0, 0, 0), corner(1, 0, 0), corner(1, 1, 0), corner(0, 1, 0)},
          {corner(0, 0, 1), corner(0, 1, 1), corner(1, 1, 1), corner(1, 0, 1)}};
}

}  // namespace patchlight
