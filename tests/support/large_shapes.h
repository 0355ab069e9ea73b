#pragma once

#include "support/scenes.h"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

// Shapes with a given number of corners or faces.
namespace patchlight::test {

inline std::vector<Point> disc(int corners) {
  std::vector<Point> points;
  for (int k = 0; k < corners; ++k) {
    const double angle = 2 * std::numbers::pi * k / corners;
    points.emplace_back(std::cos(angle), std::sin(angle), 0);
  }
  return points;
}

// A room with triangles that share an edge, like the pages of a book.
inline Scene book(int leaves) {
  Scene scene = empty_scene({grey(0.5)});
  scene.vertices = {Point(0, 0, 0), Point(0, 0, 1)};
  for (int k = 0; k < leaves; ++k) {
    const double angle = 2 * std::numbers::pi * k / leaves;
    scene.vertices.emplace_back(std::cos(angle), std::sin(angle), 0.5);
    Polygon leaf;
    leaf.corners = {0, 1, static_cast<std::uint32_t>(k + 2)};
    scene.polygons.push_back(leaf);
  }
  return scene;
}

}  // namespace patchlight::test
