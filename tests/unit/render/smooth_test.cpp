#include "mesh/mesher.h"
#include "render/render.h"
#include "support/scenes.h"
#include "visibility/occluder.h"

#include <gtest/gtest.h>

namespace patchlight::smooth_test {
namespace {

using namespace test;

// A floor of 4 x 2 m with a wall of no thickness on it at x = 1.3. Patch edges are 1 m, so the wall crosses the second
// column.
Scene walled_floor() {
  Scene scene = with_quad(empty_scene({grey(0.5)}), {Point(0, 0, 0), Point(4, 0, 0), Point(4, 2, 0), Point(0, 2, 0)});
  return with_quad(std::move(scene), {Point(1.3, 0, 0), Point(1.3, 2, 0), Point(1.3, 2, 1), Point(1.3, 0, 1)});
}

PatchMesh mesh_of(const Scene& scene) { return tessellate(scene, kept_sides(scene, Sides::front), 1); }

Eigen::VectorXd areas(const PatchMesh& mesh) {
  return Eigen::Map<const Eigen::VectorXd>(mesh.area.data(), mesh.size());
}

// The value of floor patches is `lit` if their center lies beyond the wall, else 0.
Field lit_beyond_the_wall(const PatchMesh& mesh, double lit) {
  Field values = Field::Zero(mesh.size(), 1);
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    if (mesh.polygon[i] == 0 && mesh.centroid[i].x() > 1.3) values(i, 0) = lit;
  }
  return values;
}

double value(const PatchMesh& mesh, const SmoothField& field, const Occluder& occluder, const Point& point) {
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const PatchCorners corners = mesh.corner_points(i);
    const Box box = Box(corners.points[0]).extend(corners.points[2]);
    if (mesh.polygon[i] == 0 && box.contains(point)) return value_at(mesh, field, occluder, i, point)[0];
  }
  return -1;
}

TEST(Smooth, AWallKeepsItsTwoSidesApart) {
  const Scene scene = walled_floor();
  const PatchMesh mesh = mesh_of(scene);
  const Occluder occluder(scene, Occluder::Blockers::all);
  const SmoothField field = smooth(mesh, lit_beyond_the_wall(mesh, 1), areas(mesh), occluder);
  // The patch from 1 to 2 has its center on the lit side. Its corners at x = 1 are on the dark side and take nothing
  // from it. Points on the dark side take nothing from its lit corners.
  EXPECT_EQ(value(mesh, field, occluder, Point(0.9, 1, 0)), 0);
  EXPECT_EQ(value(mesh, field, occluder, Point(1.2, 0.7, 0)), 0);
  EXPECT_EQ(value(mesh, field, occluder, Point(1.4, 0.7, 0)), 1);
  EXPECT_EQ(value(mesh, field, occluder, Point(3, 1, 0)), 1);
}

TEST(Smooth, WithoutAWallItIsTheAreaWeightedMean) {
  Scene scene = walled_floor();
  scene.polygons.pop_back();
  const PatchMesh mesh = mesh_of(scene);
  const Occluder occluder(scene);
  const SmoothField field = smooth(mesh, lit_beyond_the_wall(mesh, 1), areas(mesh), occluder);
  // A vertex halfway between the centers of a dark and a lit patch has their mean.
  EXPECT_DOUBLE_EQ(value(mesh, field, occluder, Point(1, 1, 0)), 0.5);
}

TEST(Smooth, CoveredPatchesDoNotDarkenTheirSurroundings) {
  const Scene scene = walled_floor();
  const PatchMesh mesh = mesh_of(scene);
  Eigen::VectorXd area = areas(mesh);
  Field values = Field::Ones(mesh.size(), 1);
  values(0, 0) = 0;
  area[0] *= 1e-6;
  const Occluder occluder(scene, Occluder::Blockers::all);
  const SmoothField field = smooth(mesh, values, area, occluder);
  EXPECT_NEAR(field.at_vertices(mesh.corners[0][3], 0), 1, 2e-6);
}

}  // namespace
}  // namespace patchlight::smooth_test
