#pragma once

#include "patchlight/scene/scene.h"
#include "patchlight/scene/sides.h"

#include <string>
#include <vector>

namespace patchlight::tiny {

using Corners = std::vector<std::uint32_t>;

/// A scene of polygons with one gray material.
inline Scene scene_of(std::vector<Point> vertices, const std::vector<Corners>& polygons) {
  Scene scene;
  scene.vertices = std::move(vertices);
  for (const Corners& corners : polygons) {
    scene.polygons.push_back({.corners = corners, .material = 0, .group = 0, .line = 0});
  }
  scene.materials.resize(1);
  scene.groups = {"tiny"};
  scene.file = "tiny.obj";
  return scene;
}

/// One polygon with the given corners in order.
inline Scene polygon(std::vector<Point> corners) {
  Corners order;
  for (std::uint32_t k = 0; k < corners.size(); ++k) order.push_back(k);
  return scene_of(std::move(corners), {order});
}

/// The six faces of a box from the origin to `size`, front sides inward.
inline Scene box(const Vector& size) {
  std::vector<Point> vertices;
  for (const double z : {0.0, size.z()}) {
    for (const double y : {0.0, size.y()}) {
      for (const double x : {0.0, size.x()}) vertices.emplace_back(x, y, z);
    }
  }
  return scene_of(vertices, {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}});
}

/// Every polygon, cut into a fan of triangles from its first corner.
inline Scene in_triangles(const Scene& scene) {
  Scene result = scene;
  result.polygons.clear();
  for (const Polygon& polygon : scene.polygons) {
    for (std::size_t k = 1; k + 1 < polygon.corners.size(); ++k) {
      Polygon triangle = polygon;
      triangle.corners = {polygon.corners[0], polygon.corners[k], polygon.corners[k + 1]};
      result.polygons.push_back(triangle);
    }
  }
  return result;
}

inline KeptSides front_sides(const Scene& scene) {
  KeptSides sides;
  sides.front.assign(scene.polygons.size(), 1);
  sides.back.assign(scene.polygons.size(), 0);
  return sides;
}

inline KeptSides both_sides(const Scene& scene) {
  KeptSides sides = front_sides(scene);
  sides.back = sides.front;
  return sides;
}

/// The scene turned, then scaled, then shifted.
inline Scene moved(Scene scene, const Eigen::Matrix3d& turn, double scale, const Vector& shift) {
  for (Point& vertex : scene.vertices) vertex = scale * (turn * vertex) + shift;
  return scene;
}

}  // namespace patchlight::tiny
