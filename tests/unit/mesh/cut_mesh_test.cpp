// Patches and lines of contact: laws for rooms with random contents.
#include "mesh/cut_polygons.h"
#include "mesh/mesher.h"
#include "mesh/nested_mesh.h"
#include "mesh/noded_lines.h"
#include "support/scenes.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <utility>
#include <vector>

namespace patchlight::cut_mesh_test {
namespace {

using namespace test;

KeptSides front_sides(const Scene& scene) {
  const std::size_t count = scene.polygons.size();
  return {std::vector<std::uint8_t>(count, 1), std::vector<std::uint8_t>(count, 0), {}, {}};
}

// A room with boxes that stand, hang close over the floor, or intersect each other, the floor and the walls.
Scene crowded_room(unsigned seed) {
  Scene scene = with_box(empty_scene({grey(0.5)}), Point(0, 0, 0), Point(4, 3, 2), true);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int k = 0; k < 12; ++k) {
    const Point low(3.5 * unit(random), 2.5 * unit(random), k % 3 == 0 ? 0 : k % 3 == 1 ? 0.02 : unit(random) - 0.3);
    const Vector size(0.1 + unit(random), 0.1 + unit(random), 0.1 + unit(random));
    scene = with_box(std::move(scene), low, low + size, false);
  }
  // A wall of no thickness that ends in the middle of the floor.
  return with_quad(std::move(scene), {Point(1.5, 0, 0), Point(1.5, 1.1, 0), Point(1.5, 1.1, 1), Point(1.5, 0, 1)});
}

// Does the interior of a patch contain a point of the line?
bool is_crossed(const PatchMesh& mesh, PatchIndex patch, const ContactLine& line) {
  const PatchCorners corners = mesh.corner_points(patch);
  double first = 0;
  double last = 1;
  for (int k = 0; k < corners.count; ++k) {
    const Point& a = corners.points[static_cast<std::size_t>(k)];
    const Point& b = corners.points[static_cast<std::size_t>((k + 1) % corners.count)];
    const Vector inward = mesh.normal[patch].cross(b - a).normalized();
    const double from = inward.dot(line.from - a) - 1e-9;
    const double to = inward.dot(line.to - a) - 1e-9;
    if (from <= 0 && to <= 0) return false;
    const double t = from / (from - to);
    if (from < 0) first = std::max(first, t);
    if (to < 0) last = std::min(last, t);
  }
  return (last - first) * (line.to - line.from).norm() > 1e-6;
}

// A search for the longest edge counts the actual patches, while lines become coarser and finer during it.
TEST(EdgeSearchInACrowdedRoom, CountsWhatIsMeshed) {
  const Scene scene = crowded_room(3);
  const KeptSides sides = front_sides(scene);
  const ContactLines contacts = find_contact_lines(scene, sides);
  EdgeSearch search(scene, sides, contacts);
  for (const double edge : {5.0, 0.25, 1.5, 0.24, 0.7}) {
    EXPECT_EQ(search.patches_with(edge), tessellate(scene, sides, edge, contacts).size()) << edge;
    EXPECT_EQ(search.nested_patches_with(edge), nest(tessellate(scene, sides, edge, contacts)).patches.size()) << edge;
  }
}

class CrowdedRooms : public testing::TestWithParam<std::tuple<unsigned, double>> {};

// The patches of a polygon cover it without gap and overlap, and none crosses a line of contact. Edges are no longer
// than the limit.
TEST_P(CrowdedRooms, ArePartedByTheirContacts) {
  const auto [seed, edge] = GetParam();
  const Scene scene = crowded_room(seed);
  const KeptSides sides = front_sides(scene);
  const ContactLines contacts = find_contact_lines(scene, sides);
  const PatchMesh mesh = tessellate(scene, sides, edge, contacts);
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const PatchRange range = mesh.patches_on(p, Side::front);
    const double whole = area_vector(corner_points(scene, p)).norm();
    double area = 0;
    for (PatchIndex i = range.begin; i < range.end; ++i) {
      EXPECT_GT(mesh.area[i], 0);
      area += mesh.area[i];
      const PatchCorners corners = mesh.corner_points(i);
      for (int k = 0; k < corners.count; ++k) {
        const Vector side = corners.points[static_cast<std::size_t>((k + 1) % corners.count)] -
                            corners.points[static_cast<std::size_t>(k)];
        EXPECT_LE(side.norm(), edge * (1 + 1e-9));
      }
    }
    EXPECT_NEAR(area, whole, 1e-12 * (1 + whole)) << "polygon " << p;
    for (const ContactLine& line : contacts.on[p]) {
      // Longer edges allow simplified lines of contact.
      if (line.gap > 0 || edge > 0.2 || (line.to - line.from).norm() < 0.2 * edge) continue;
      for (PatchIndex i = range.begin; i < range.end; ++i)
        EXPECT_FALSE(is_crossed(mesh, i, line)) << "polygon " << p << ", patch " << i;
    }
  }
}

// A rotated and scaled room has the same patches in the same order on cut polygons.
TEST_P(CrowdedRooms, AreTheSameElsewhere) {
  const auto [seed, edge] = GetParam();
  const Scene scene = crowded_room(seed);
  const Eigen::Affine3d motion =
      Eigen::Translation3d(5, -6, 7) * Eigen::AngleAxisd(0.7, Vector(1, 2, 3).normalized()) * Eigen::Scaling(0.37);
  const Scene other = moved(scene, motion);
  const PatchMesh here = tessellate(scene, front_sides(scene), edge, find_contact_lines(scene, front_sides(scene)));
  const PatchMesh there =
      tessellate(other, front_sides(other), 0.37 * edge, find_contact_lines(other, front_sides(other)));
  // A quadrilateral whose corners lie on one circle may be divided along either diagonal, and its triangles then pair
  // differently.
  EXPECT_NEAR(here.size(), there.size(), 0.005 * here.size());
  PatchIndex elsewhere = 0;
  for (PatchIndex i = 0; i < here.size(); ++i) {
    const Point place = motion * here.centroid[i];
    const PatchRange range = there.patches_on(here.polygon[i], Side::front);
    bool found = false;
    for (PatchIndex k = range.begin; k < range.end && !found; ++k) found = (there.centroid[k] - place).norm() < 1e-9;
    elsewhere += found ? 0 : 1;
  }
  EXPECT_LE(elsewhere, here.size() / 50);
}

INSTANTIATE_TEST_SUITE_P(Seeds, CrowdedRooms,
                         testing::Combine(testing::Range(1U, 9U), testing::Values(0.15, 0.5, 4.0)));

// Two lines cross at so small an angle that the point is uncertain. All parts of both remain, and every stretch is
// covered.
TEST(NodedLines, KeepLinesThatCrossAtANarrowAngle) {
  for (const double height : {0.0005, 0.002, 0.004}) {
    const std::vector<FlatLine> lines{{FlatPoint(0, 0), FlatPoint(1, 0)},
                                      {FlatPoint(0, height), FlatPoint(1, -height)}};
    double length = 0;
    for (const auto& [from, to] : noded_lines(lines, 1e-4)) length += std::abs(to.x() - from.x());
    EXPECT_NEAR(length, 2, 1e-9) << height;
  }
}

// A vertex on a line belongs only to patches on one side.
TEST(CutMesh, SharesNoVerticesOverALine) {
  Scene scene = with_box(empty_scene({grey(0.5)}), Point(0, 0, 0), Point(4, 3, 2), true);
  scene = with_quad(std::move(scene), {Point(1.5, 0, 0), Point(1.5, 3, 0), Point(1.5, 3, 2), Point(1.5, 0, 2)});
  const KeptSides sides = front_sides(scene);
  const PatchMesh mesh = tessellate(scene, sides, 0.4, find_contact_lines(scene, sides));
  std::map<std::uint32_t, int> side_of;
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    if (mesh.polygon[i] >= 6) continue;
    const int side = mesh.centroid[i].x() < 1.5 ? -1 : 1;
    for (const std::uint32_t vertex : mesh.corners[i]) EXPECT_EQ(side_of.emplace(vertex, side).first->second, side);
  }
}

// Two halves of a floor share their edge, even if a wall crosses both.
TEST(CutMesh, NeighboursShareTheEndsOfLines) {
  Scene scene = empty_scene({grey(0.5)});
  scene = with_quad(std::move(scene), {Point(0, 0, 0), Point(4, 0, 0), Point(4, 2, 0), Point(0, 2, 0)});
  scene = with_quad(std::move(scene), {Point(0, 2, 0), Point(4, 2, 0), Point(4, 4, 0), Point(0, 4, 0)});
  scene = with_quad(std::move(scene), {Point(1.3, 0, 0), Point(1.7, 4, 0), Point(1.7, 4, 1), Point(1.3, 0, 1)});
  const KeptSides sides = front_sides(scene);
  const PatchMesh mesh = tessellate(scene, sides, 0.5, find_contact_lines(scene, sides));
  std::map<std::uint32_t, int> polygons;  // on the shared edge: bit 1 of the first polygon, bit 2 of the second
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    for (const std::uint32_t vertex : mesh.corners[i]) {
      if (mesh.polygon[i] < 2 && std::abs(mesh.vertices[vertex].y() - 2) < 1e-12)
        polygons[vertex] |= 1 << mesh.polygon[i];
    }
  }
  int single = 0;
  for (const auto& [vertex, both] : polygons) single += both == 3 ? 0 : 1;
  EXPECT_GE(polygons.size(), 9U);
  EXPECT_LE(single, 2);  // on the side that lost the line's vertex
}

}  // namespace
}  // namespace patchlight::cut_mesh_test
