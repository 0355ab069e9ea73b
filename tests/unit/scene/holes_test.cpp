#include "scene/coverings.h"
#include "support/scenes.h"

#include <cmath>
#include <gtest/gtest.h>
#include <vector>

namespace patchlight::holes_test {
namespace {

using namespace test;

double area_of_holes(const Scene& scene) {
  double area = 0;
  for (const Hole& hole : holes_between_faces(scene)) {
    for (const std::vector<Point>& piece : hole.pieces) area += area_vector(piece).norm();
  }
  return area;
}

// A wall of 4 x 3 m at y = 0.
Quad on_wall(double x0, double x1, double z0, double z1) {
  return {Point(x0, 0, z0), Point(x1, 0, z0), Point(x1, 0, z1), Point(x0, 0, z1)};
}

Scene four_quads_around_a_window() {
  Scene scene = with_quad(empty_scene({grey(0.5)}), on_wall(0, 1, 0, 3));
  scene = with_quad(std::move(scene), on_wall(3, 4, 0, 3));
  scene = with_quad(std::move(scene), on_wall(1, 3, 0, 1));
  return with_quad(std::move(scene), on_wall(1, 3, 2, 3));
}

// One polygon that runs around the hole along a seam.
Scene wall_with_a_seam() {
  return with_polygon(empty_scene({grey(0.5)}),
                      {Point(0, 0, 0), Point(4, 0, 0), Point(4, 0, 3), Point(0, 0, 3), Point(0, 0, 0), Point(1, 0, 1),
                       Point(1, 0, 2), Point(3, 0, 2), Point(3, 0, 1), Point(1, 0, 1)});
}

TEST(HolesBetweenFaces, AreWhatTheFacesOfAPlaneLeaveFree) {
  // In meters, and rotated in millimeters.
  const Eigen::Affine3d turned =
      Eigen::Translation3d(3, -7, 2) * Eigen::AngleAxisd(0.7, Vector(1, 2, 3).normalized()) * Eigen::Scaling(0.001);
  for (const Eigen::Affine3d& motion : {Eigen::Affine3d::Identity(), turned}) {
    const double square = std::pow(motion.linear().determinant(), 2.0 / 3);
    for (const Scene& scene : {four_quads_around_a_window(), wall_with_a_seam()})
      EXPECT_NEAR(area_of_holes(moved(scene, motion)), 2 * square, 1e-6 * square);
  }
}

TEST(HolesBetweenFaces, AreFilledByPanes) {
  const Scene glazed = with_quad(four_quads_around_a_window(), on_wall(1, 3, 1, 2));
  EXPECT_EQ(area_of_holes(glazed), 0);
  EXPECT_EQ(area_of_holes(cube_room(0.5, 0)), 0);
}

TEST(HolesBetweenFaces, AreNoneInAFaceThatIsBentALittle) {
  // The distance of its corners from their mean plane exceeds the weld distance of vertices.
  Quad bent{Point(0, 0, 0), Point(10, 0, 0), Point(10, 10, 1e-4), Point(0, 10, 0)};
  EXPECT_EQ(area_of_holes(with_quad(empty_scene({grey(0.5)}), bent)), 0);
}

TEST(HolesBetweenFaces, HaveNothingOfFacesInOtherPlanes) {
  // A sheet close behind the window does not cover it.
  const Scene scene = moved(with_quad(empty_scene({grey(0.5)}), on_wall(0, 4, 0, 3)),
                            Eigen::Affine3d(Eigen::Translation3d(0, 0.01, 0)));
  Scene both = four_quads_around_a_window();
  std::vector<Point> sheet;
  for (const Point& corner : scene.vertices) sheet.push_back(corner);
  both = with_polygon(std::move(both), sheet);
  EXPECT_NEAR(area_of_holes(both), 2, 1e-6);
}

}  // namespace
}  // namespace patchlight::holes_test
