#include "mesh/polygon_mesh.h"

#include "patchlight/base/geometry.h"

#include <cmath>
#include <gtest/gtest.h>
#include <vector>

namespace patchlight::polygon_mesh_test {
namespace {

// Lines end at other faces, within their rounding: a line along an edge may begin slightly outside.
TEST(PolygonMesh, HasNoPatchThatIsTurnedOver) {
  for (const double outside : {-1e-8, -4e-10, -1e-12, 0.0, 1e-12, 4e-10, 1e-8}) {
    const Vector up(0, 0, 1);
    Outline outline = make_outline({{0, 0, 0}, {0.5, 0, 0}, {1, 0, 0}, {1, 0.1, 0}, {0, 0.1, 0}}, up, 0.05);
    outline.lines.push_back({Point(0.2, -outside, 0), Point(0.5, 0, 0)});
    outline.lines.push_back({Point(0.2, -outside, 0), Point(0.23, 0.02, 0)});
    const PolygonMesh mesh = mesh_polygon(outline, 0.05);
    std::vector<Point> points = boundary_points(outline);
    points.insert(points.end(), mesh.inner.begin(), mesh.inner.end());
    double area = 0;
    for (const auto& [a, b, c, d] : mesh.patches) {
      // Triangles have c = d.
      const double of_patch = 0.5 * up.dot((points[c] - points[a]).cross(points[d] - points[b]));
      EXPECT_GT(of_patch, 0) << outside;
      area += of_patch;
    }
    // The part outside, and the overlap.
    EXPECT_NEAR(area, 0.1, 1e-12 + 2 * std::abs(outside)) << outside;
  }
}

}  // namespace
}  // namespace patchlight::polygon_mesh_test
