// Faces and vertices far from the rest of a model do not change the results for that rest.
#include "patchlight/simulate.h"

#include "scene/repair.h"
#include "support/scenes.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace patchlight::stray_test {
namespace {

using namespace test;

// The furnished room with a table whose legs are 5 cm thick and whose top is 2 cm.
Scene room_with_table() {
  Scene scene = furnished_room(0.6);
  for (const auto& [x, y] : {std::pair{2.6, 1.2}, {3.35, 1.2}, {2.6, 1.95}, {3.35, 1.95}})
    scene = with_box(std::move(scene), Point(x, y, 0), Point(x + 0.05, y + 0.05, 0.7), false);
  return with_box(std::move(scene), Point(2.5, 1.1, 0.7), Point(3.5, 2.1, 0.72), false);
}

const Eigen::Affine3d turned_a_little(Eigen::AngleAxisd(0.7, Vector(0.3, 1, -2).normalized()));

Scene with_stray_triangle(Scene scene, double metres) {
  const Point far(metres, 0.3 * metres, 0.1 * metres);
  return with_polygon(std::move(scene), {far, far + Vector(0, 1, 0), far + Vector(0, 0, 1)});
}

bool names_what_is_far(const Scene& scene) {
  return std::any_of(scene.diagnostics.begin(), scene.diagnostics.end(), [](const Diagnostic& problem) {
    return problem.code == DiagnosticCode::implausible_size && !problem.faces.empty();
  });
}

Simulation solved(const Scene& scene, double metres_per_unit) {
  Request request;
  request.mesh.max_edge = 0.4 * metres_per_unit;
  request.mesh.sides = Sides::front;
  return simulate(scene, request);
}

// The light equals that of the room alone. Both have a form factor error of 1e-3 (docs/benchmarks/form-factors.md), so
// the limit is twice that.
TEST(StrayTriangle, LeavesTheRoomAsItIs) {
  const Scene alone = repair(room_with_table());
  const Simulation expected = solved(alone, 1);
  for (const double far : {1e4, 1e5}) {
    for (const double unit : {1.0, 1000.0}) {
      SCOPED_TRACE(far * unit);
      const Scene scene =
          repair(moved(with_stray_triangle(room_with_table(), far), turned_a_little * Eigen::Scaling(unit)));
      EXPECT_EQ(scene.polygons.size(), alone.polygons.size() + 1) << "nothing is lost";
      EXPECT_TRUE(names_what_is_far(scene));
      const Simulation found = solved(scene, unit);
      EXPECT_NEAR(found.balance.absorbed[0] / (unit * unit) / expected.balance.absorbed[0], 1, 2e-3);
      EXPECT_LT(found.balance.escaped[0], 1e-3 * found.balance.emitted[0]);
    }
  }
}

// One corner of a face is misplaced: a triangle reaches from the floor to a distant point.
TEST(StrayVertex, LosesNoOtherFace) {
  for (const double far : {1e4, 1e5}) {
    for (const double unit : {1.0, 0.001}) {
      Scene scene = room_with_table();
      scene = with_polygon(std::move(scene), {Point(1, 1, 0), Point(1.5, 1, 0), Point(0.3 * far, far, far)});
      const std::size_t faces = scene.polygons.size();
      scene = repair(moved(std::move(scene), turned_a_little * Eigen::Scaling(unit)));
      EXPECT_EQ(scene.polygons.size(), faces) << far;
      EXPECT_TRUE(names_what_is_far(scene));
    }
  }
}

// The room stands on very large ground. Welding relative to its size would collapse the table's edges to lines, so less
// is welded.
TEST(LargeGround, KeepsWhatStandsOnIt) {
  Scene scene = empty_scene({grey(0.5), grey(0, 10)});
  for (int x = 0; x < 40; ++x) {
    const double from = 1000.0 * x;
    scene = with_quad(std::move(scene), {Point(from, 0, 0), Point(from + 1000, 0, 0), Point(from + 1000, 40000, 0),
                                         Point(from, 40000, 0)});
    const Point corner(from + 500, 1000.0 * x, 0);
    scene = with_box(std::move(scene), corner, corner + Vector(20, 15, 0.02), false);
  }
  const std::size_t faces = scene.polygons.size();
  EXPECT_EQ(repair(scene).polygons.size(), faces);
  EXPECT_FALSE(names_what_is_far(repair(std::move(scene))));
}

}  // namespace
}  // namespace patchlight::stray_test
