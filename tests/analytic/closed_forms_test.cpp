// Whole runs against closed forms.
#include "patchlight/form_factors.h"
#include "patchlight/simulate.h"
#include "patchlight/transport/assemble.h"

#include "mesh/mesher.h"
#include "support/scenes.h"
#include "visibility/occluder.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace patchlight::closed_forms_test {
namespace {

using namespace test;

KeptSides fronts(const Scene& scene) { return kept_sides(scene, Sides::front); }

// Form factor between the first two polygons of a scene, cut into patches with this edge.
double polygon_form_factor(const Scene& scene, double max_edge) {
  const PatchMesh mesh = tessellate(scene, fronts(scene), max_edge);
  const ExchangeAreas S = assemble_exchange_areas(mesh, Occluder(scene)).exchange_areas;
  double exchange = 0;
  double area = 0;
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    if (mesh.polygon[i] != 0) continue;
    area += mesh.area[i];
    for (PatchIndex j = 0; j < mesh.size(); ++j) {
      if (mesh.polygon[j] == 1) exchange += static_cast<double>(S.at(i, j));
    }
  }
  return exchange / area;
}

// Unit squares: Howell's catalog, C-11 and C-14, to 16 digits. The tolerance is a tenth of the guaranteed error; float
// storage alone is good to 1e-7.
TEST(FormFactors, OpposedUnitSquares) {
  Scene scene = with_quad(empty_scene({grey(0.5)}), {Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)});
  scene = with_quad(std::move(scene), {Point(0, 0, 1), Point(0, 1, 1), Point(1, 1, 1), Point(1, 0, 1)});
  for (const double max_edge : {2.0, 0.25, 0.1}) {
    EXPECT_NEAR(polygon_form_factor(scene, max_edge), 0.19982489569838732, 1e-5) << "max_edge " << max_edge;
  }
}

TEST(FormFactors, UnitSquaresSharingAnEdge) {
  Scene scene = with_quad(empty_scene({grey(0.5)}), {Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)});
  scene = with_quad(std::move(scene), {Point(0, 0, 0), Point(0, 1, 0), Point(0, 1, 1), Point(0, 0, 1)});
  for (const double max_edge : {2.0, 0.25, 0.1}) {
    EXPECT_NEAR(polygon_form_factor(scene, max_edge), 0.20004377607540316, 1e-5) << "max_edge " << max_edge;
  }
}

TEST(FormFactors, HalfHiddenByATriangle) {
  // A right triangle halfway between two opposed unit squares covers exactly one side of the symmetry plane x = y of
  // the pair. It hides one half, by symmetry under a half turn about the middle line.
  Scene scene = with_quad(empty_scene({grey(0.5)}), {Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)});
  scene = with_quad(std::move(scene), {Point(0, 0, 1), Point(0, 1, 1), Point(1, 1, 1), Point(1, 0, 1)});
  scene = with_polygon(std::move(scene), {Point(0, 0, 0.5), Point(1, 0, 0.5), Point(1, 1, 0.5)});
  // 100 x 100 pairs, a tenth of which are partly hidden with errors of about 10 % each: 0.1 * 0.1 / sqrt(1000) of the
  // whole.
  EXPECT_NEAR(polygon_form_factor(scene, 0.1), 0.5 * 0.19982489569838732, 1e-3 * 0.2);
}

// Unit squares that share an edge, one patch each: 256 rays measure the lost fraction to 2 %, and the closed form is
// exact. The second scene adds squares below the floor and behind the wall. Rays decide their pairs, which must not
// affect the first pair. The scenes are in meters and millimeters, and turned.
TEST(FormFactors, ClosureOfAnOpenSceneKeepsExactOnes) {
  Scene squares = with_quad(empty_scene({grey(0.5)}), {Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)});
  squares = with_quad(std::move(squares), {Point(0, 0, 0), Point(0, 1, 0), Point(0, 1, 1), Point(0, 0, 1)});
  Scene more = with_quad(squares, {Point(-2, 0, -2), Point(-1, 0, -2), Point(-1, 1, -2), Point(-2, 1, -2)});
  more = with_quad(std::move(more), {Point(-2, 0, -1), Point(-2, 1, -1), Point(-1, 1, -1), Point(-1, 0, -1)});
  more = with_polygon(std::move(more), {Point(-2, 0, -1.5), Point(-1, 0, -1.5), Point(-1, 1, -1.5)});
  for (const Scene& scene : {squares, more}) {
    for (const double size : {1.0, 1e-3}) {
      const Eigen::AngleAxisd turn(size == 1 ? 0.0 : 0.7, Vector(1, 2, 3).normalized());
      Request request;
      request.mesh.max_edge = 2 * size;
      request.mesh.sides = Sides::front;
      const Scene placed = moved(scene, Eigen::Affine3d(turn) * Eigen::Scaling(size));
      const Exchange exchange = find_form_factors(placed, request).exchange;
      EXPECT_EQ(exchange.closure, "least squares, open scene");
      for (const PatchIndex i : {0U, 1U}) {
        EXPECT_NEAR(static_cast<double>(exchange.exchange_areas.at(0, 1)) / exchange.area[i], 0.20004377607540316,
                    1e-6);
      }
    }
  }
}

// A closed room of one material with E = 1 - rho has B = 1 everywhere for any shape, as B = E + rho B. The stopping
// rule bounds the error by 1e-7, and closure makes row sums exact to 1e-10.
class Furnace : public testing::TestWithParam<double> {};

TEST_P(Furnace, RadiosityIsOneEverywhere) {
  const double rho = GetParam();
  Scene scene = empty_scene({grey(rho, 1 - rho)});
  scene = with_box(std::move(scene), Point(0, 0, 0), Point(4, 3, 2.5), true);
  scene = with_box(std::move(scene), Point(1, 1, 0.5), Point(2, 1.8, 1.2), false);
  Request request;
  request.mesh.max_edge = 0.5;
  request.mesh.sides = Sides::front;
  request.solver.relative_error = 1e-7;
  const Simulation simulation = simulate(scene, request);
  ASSERT_TRUE(simulation.solution.converged);
  EXPECT_EQ(simulation.transport.closure, "least squares");
  EXPECT_LT((simulation.solution.radiosity - 1).abs().maxCoeff(), 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Reflectances, Furnace, testing::Values(0.1, 0.3, 0.5, 0.7, 0.9, 0.95, 0.99));

TEST(Simulate, IrradianceBelowASmallLampFollowsTheClosedForm) {
  // A black floor under a lamp, without other surfaces: H = E F(point, lamp) by Lambert's formula. At the floor's
  // center below the center of the lamp, F is four times the corner configuration of Howell B-3. The floor's patches
  // have edges of 0.05 m at distance 1 m; their mean differs from the center value by (h/d)^2/24 * 8 = 1e-3.
  Scene scene = empty_scene({grey(0), grey(0, 7)});
  scene = with_quad(std::move(scene), {Point(-1, -1, 0), Point(1, -1, 0), Point(1, 1, 0), Point(-1, 1, 0)});
  scene = with_quad(std::move(scene), {Point(-.2, -.2, 1), Point(-.2, .2, 1), Point(.2, .2, 1), Point(.2, -.2, 1)}, 1);
  Request request;
  request.mesh.max_edge = 2.0 / 41;
  request.mesh.sides = Sides::front;
  const Simulation simulation = simulate(scene, request);
  const double root = std::sqrt(1 + 0.04);
  const double form_factor = 4 / std::numbers::pi * 0.2 / root * std::atan(0.2 / root);
  double nearest = 1;
  double irradiance = 0;
  for (PatchIndex i = 0; i < simulation.mesh.size(); ++i) {
    const double distance = simulation.mesh.centroid[i].norm();
    if (distance < nearest) {
      nearest = distance;
      irradiance = simulation.solution.irradiance(i, 0);
    }
  }
  EXPECT_NEAR(irradiance, 7 * form_factor, 2e-3 * 7 * form_factor);
}

}  // namespace
}  // namespace patchlight::closed_forms_test
