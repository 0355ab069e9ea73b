#pragma once

#include "support/tiny_scenes.h"

#include <cmath>
#include <numbers>
#include <ostream>
#include <string>
#include <vector>

namespace patchlight::tiny {

/// A polygon as a test case for meshing.
struct Shape {
  std::string name;
  Scene scene;
  double thickness = 1;  ///< about its height over its length: 1 for well-shaped polygons
};

inline void PrintTo(const Shape& shape, std::ostream* out) { *out << shape.name; }

/// A few units in size, each tilted out of the coordinate planes.
inline std::vector<Shape> polygon_shapes() {
  using std::numbers::pi;
  std::vector<Point> hexagon;
  for (int k = 0; k < 6; ++k) hexagon.emplace_back(std::cos(k * pi / 3), std::sin(k * pi / 3), 0);
  std::vector<Shape> shapes{
      {"square", polygon({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}})},
      {"rectangle", polygon({{0, 0, 0}, {3, 0, 0}, {3, 1, 0}, {0, 1, 0}})},
      {"parallelogram", polygon({{0, 0, 0}, {1, 0, 0}, {1.7, 1.2, 0}, {0.7, 1.2, 0}})},
      {"trapezoid", polygon({{0, 0, 0}, {2, 0, 0}, {1.5, 1, 0}, {0.4, 1, 0}})},
      {"quad_with_straight_corner", polygon({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 2, 0}})},
      {"arrow", polygon({{0, 0, 0}, {2, -1, 0}, {1, 0, 0}, {2, 1, 0}})},
      {"equilateral", polygon({{0, 0, 0}, {1, 0, 0}, {0.5, std::sqrt(0.75), 0}})},
      {"right_triangle", polygon({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})},
      {"scalene", polygon({{0, 0, 0}, {2, 0, 0}, {0.3, 0.7, 0}})},
      {"repeated_corner", polygon({{0, 0, 0}, {2, 0, 0}, {2, 0, 0}, {0.3, 0.7, 0}, {0, 0, 0}})},
      {"hexagon", polygon(hexagon)},
      {"l_shape", polygon({{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}})},
      {"wall_with_straight_corners",
       polygon({{0, 0, 0}, {0.3, 0, 0}, {0.7, 0, 0}, {1.9, 0, 0}, {3, 0, 0}, {3, 1, 0}, {1, 1, 0}, {0, 1, 0}})},
      {"ring_with_slit", polygon({{0, 0, 0},
                                  {3, 0, 0},
                                  {3, 3, 0},
                                  {0, 3, 0},
                                  {0, 0, 0},
                                  {1, 1, 0},
                                  {1, 2, 0},
                                  {2, 2, 0},
                                  {2, 1, 0},
                                  {1, 1, 0}})},
      {"thin_quad", polygon({{0, 0, 0}, {1, 0, 0}, {1, 1e-6, 0}, {0, 1e-6, 0}}), 1e-6},
      {"sliver_1e4", polygon({{0, 0, 0}, {1, 0, 0}, {0.3, 1e-4, 0}}), 1e-4},
      {"sliver_1e6", polygon({{0, 0, 0}, {1, 0, 0}, {0.3, 1e-6, 0}}), 1e-6},
      {"needle_1e6", polygon({{0, 0, 0}, {1, 0, 0}, {1, 1e-6, 0}}), 1e-6},
  };
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vector(1, 2, 3).normalized()).toRotationMatrix();
  for (Shape& shape : shapes) shape.scene = moved(shape.scene, turn, 1, {0.1, -0.2, 0.3});
  return shapes;
}

}  // namespace patchlight::tiny
