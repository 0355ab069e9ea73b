// Patches that touch: form factors at a shared edge or vertex, and lengths at the level of rounding.
#include "patchlight/simulate.h"

#include "form_factor/pair_samples.h"
#include "form_factor/patch_shape.h"
#include "form_factor/point_polygon.h"
#include "mesh/mesher.h"
#include "scene/repair.h"
#include "support/scenes.h"
#include "visibility/occluder.h"

#include <array>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <vector>

namespace patchlight::touching_test {
namespace {

using namespace test;
using std::numbers::pi;

constexpr double degree = pi / 180;

// Form factor between two equal rectangles with a common edge of relative length c = 1, widths A = B = `width`, and
// `angle` between them. Source: Feingold 1966, Howell's catalog C-16 with A = B. The remaining integral has no
// singularity; 30 Gauss points are exact to rounding for the angles used here.
double hinged_form_factor(double width, double angle) {
  const double A = width;
  const double s = std::sin(angle);
  const double c = std::cos(angle);
  const double A2 = A * A;
  const double C = 2 * A2 * (1 - c);
  const double D = std::sqrt(1 + A2 * s * s);
  const double tangent = std::atan((1 - c) / s);
  const auto integrand = [&](double z) {
    const double root = std::sqrt(1 + z * z * s * s);
    return root * (std::atan(z * c / root) + std::atan((A - z * c) / root));
  };
  const double flat = A2 * s + (pi - 2 * angle) * A2 + 2 * A2 * tangent;
  const double logarithms = (2 / (s * s) - 1) * std::log((1 + A2) * (1 + A2) / (1 + C)) +
                            A2 * std::log(A2 * (1 + C) / (C * (1 + A2))) +
                            A2 * (std::log(A2 / C) + std::cos(2 * angle) * std::log((1 + A2) / (1 + C)));
  return -std::sin(2 * angle) / (4 * pi * A) * flat + s * s / (4 * pi * A) * logarithms + 2 / pi * std::atan(1 / A) -
         std::sqrt(C) / (pi * A) * std::atan(1 / std::sqrt(C)) +
         s * std::sin(2 * angle) / (2 * pi) * D * (std::atan(A * c / D) + std::atan(A * (1 - c) / D)) +
         c / (pi * A) * boost::math::quadrature::gauss<double, 30>::integrate(integrand, 0.0, A);
}

const Quad unit_square{Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)};

// A unit square over y from `from` to from + 1, hinged to the y axis and opened by `angle` from the plane of the unit
// square, which its front faces.
Quad hinged(double angle, double from) {
  const Vector along(std::cos(angle), 0, std::sin(angle));
  const Point near(0, from, 0);
  const Point far(0, from + 1, 0);
  return {near, far, Point(far + along), Point(near + along)};
}

class Hinge : public testing::TestWithParam<double> {};

// The limit for touching patches is 1e-6; storage in single precision uses 6e-8 of it.
TEST_P(Hinge, SquaresSharingAnEdge) {
  const double exact = hinged_form_factor(1, GetParam() * degree);
  const Quad wall = hinged(GetParam() * degree, 0);
  EXPECT_NEAR(contour_exchange_area(unit_square, wall), exact, 1e-6);
  EXPECT_NEAR(contour_exchange_area(wall, unit_square), exact, 1e-6);
  const Scene scene = with_quad(with_quad(empty_scene({grey(0.5)}), unit_square), wall);
  const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), 2);
  const ExchangeAreas S = assemble_exchange_areas(mesh, Occluder(scene)).exchange_areas;
  EXPECT_NEAR(static_cast<double>(S.at(0, 1)), exact, 1e-6);
}

// Two such squares side by side and the two opposite ones form a pair of twice the width: 2 S(edge) + 2 S(vertex). The
// closed form of this strip is twice that of width 1/2, by similarity. The difference gives the squares that share only
// a vertex.
TEST_P(Hinge, SquaresSharingAVertex) {
  const double angle = GetParam() * degree;
  const double exact = hinged_form_factor(0.5, angle) - hinged_form_factor(1, angle);
  for (const double from : {1.0, -1.0}) {
    const Quad wall = hinged(angle, from);
    EXPECT_NEAR(contour_exchange_area(unit_square, wall), exact, 1e-6);
    EXPECT_NEAR(contour_exchange_area(wall, unit_square), exact, 1e-6);
  }
}

INSTANTIATE_TEST_SUITE_P(Degrees, Hinge, testing::Values(150.0, 90.0, 60.0, 20.0, 5.0, 1.0));

// The catalog's value for 90 degrees to 16 digits confirms the formula above.
TEST(Hinge, TheClosedFormIsTheCataloguesAtNinetyDegrees) {
  EXPECT_NEAR(hinged_form_factor(1, pi / 2), 0.20004377607540316, 1e-15);
}

// Corners, edges and points 1e-15 m apart, where products of differences vanish or underflow. All results are finite,
// and form factors lie in [0, 1] up to the rounding of about ten operations.
TEST(NearlyEqualPoints, GiveFiniteFormFactors) {
  const double tiny = 1e-15;
  const Quad shifted{Point(tiny, 0, tiny), Point(0, 1, tiny), Point(1, 1, tiny), Point(1, 0, tiny)};
  for (const double angle : {90 * degree, 1 * degree}) {
    for (const double lift : {0.0, tiny, -tiny, 1e-300}) {
      Quad wall = hinged(angle, 0);
      wall[0].z() += lift;
      wall[1].y() += lift;
      for (const double F : {contour_exchange_area(unit_square, wall), contour_exchange_area(wall, unit_square)}) {
        ASSERT_TRUE(std::isfinite(F));
        EXPECT_NEAR(F, hinged_form_factor(1, angle), 1e-6);
      }
    }
  }
  const double opposed = contour_exchange_area(unit_square, shifted);
  EXPECT_TRUE(opposed >= 0 && opposed <= 1 + 1e-14) << opposed;
  for (const Point& point : {Point(0, 0, -tiny), Point(tiny, tiny, 0), Point(1, 1, tiny), Point(0.5, 0, -tiny)}) {
    for (const Vector& normal : {Vector(0, 0, 1), Vector(1, 0, 0), Vector(0, 0, -1)}) {
      const double F = point_to_polygon(point, normal, unit_square);
      EXPECT_TRUE(F >= 0 && F <= 1) << F;
      for (const double u : {1e-12, 0.5, 1 - 1e-12}) {
        const PolygonSample sample = sample_solid_angle(point, normal, unit_square, u, 0.5);
        EXPECT_TRUE(sample.weight >= 0 && sample.weight <= 2 + 1e-14) << sample.weight;
        EXPECT_TRUE(sample.weight == 0 || sample.point.allFinite());
      }
    }
  }
  EXPECT_EQ(geometry_term(Point::Zero(), Vector::UnitZ(), Point::Zero(), -Vector::UnitZ()), 0);
}

// A room with a patch whose corners are 1e-15 m apart: repair removes it, and no other patch changes. Corners of
// neighbors that differ by 1e-15 m count as one.
TEST(NearlyEqualPoints, OfAModelChangeNothing) {
  const Scene sound = furnished_room(0.6);
  Scene scene = sound;
  for (std::size_t v = 0; v < scene.vertices.size(); v += 2) scene.vertices[v] += Vector(1e-15, -1e-15, 1e-15);
  scene = with_polygon(std::move(scene), {Point(1, 2, 1), Point(1, 2 + 1e-15, 1), Point(1, 2, 1 + 1e-15)});
  Request request;
  request.mesh.max_edge = 0.5001;
  const Simulation expected = simulate(repair(sound), request);
  const Simulation simulation = simulate(repair(scene), request);
  ASSERT_EQ(simulation.mesh.size(), expected.mesh.size());
  ASSERT_TRUE(simulation.solution.radiosity.allFinite());
  // In rooms of 4 m, 1e-15 m is below the rounding of exchange areas in single precision.
  const double change = (simulation.solution.irradiance - expected.solution.irradiance).abs().maxCoeff();
  EXPECT_LT(change, 1e-6 * expected.solution.irradiance.maxCoeff());
}

}  // namespace
}  // namespace patchlight::touching_test
