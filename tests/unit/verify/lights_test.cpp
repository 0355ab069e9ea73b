#include "light/pane.h"
#include "support/daylight_office.h"
#include "verify/path_tracer.h"

#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

// Paths that meet luminaires, sun and sky, compared with closed forms, in the original scene and rotated in a model of
// 1/1000 of the size.
namespace patchlight::lights_test {
namespace {

using namespace test;

constexpr double pi = std::numbers::pi;

// Form factor of opposed unit squares at distance 1 (Howell C-11).
constexpr double opposed = 0.19982489569838732;

std::array<Scene, 2> placings(const Scene& scene) { return {scene, turned(scene, 1e-3)}; }

PathEstimate on_front(const Scene& scene, PolygonIndex polygon) {
  const std::vector<Point> c = corner_points(scene, polygon);
  const std::vector<PathReceiver> receivers{{{c[0], c[1], c[2], c[3]}, polygon, Side::front}};
  return trace_irradiance(scene, kept_sides(scene, Sides::front), receivers);
}

// Four standard errors: a correct value fails with a probability of 4e-4, fixed by the seeds.
void expect_irradiance(const Scene& scene, PolygonIndex polygon, double exact, double largest_error) {
  for (const Scene& placed : placings(scene)) {
    const PathEstimate estimate = on_front(placed, polygon);
    EXPECT_NEAR(estimate.irradiance(0, 0), exact, 4 * estimate.standard_error(0, 0) + 1e-9 * exact);
    EXPECT_LT(estimate.standard_error(0, 0), largest_error * exact);
  }
}

Luminaire point_at(const Point& position, double flux) {
  Luminaire lamp;
  lamp.position = position;
  lamp.light = PointLight{watts(flux / (4 * pi))};
  return lamp;
}

Luminaire sphere_at(const Point& position, double radius, double flux) {
  Luminaire lamp;
  lamp.position = position;
  lamp.light = SphericalLamp{radius, watts(flux / (4 * pi * radius * radius))};
  return lamp;
}

Scene cube_of(double reflectance) {
  Scene scene = cube_room(reflectance, 0);
  for (Point& vertex : scene.vertices) vertex -= Vector(0.5, 0.5, 0.5);
  return scene;
}

TEST(PathLights, EachFaceOfACubeGetsASixthOfTheLampInItsMiddle) {
  // Phi / 6 directly on each face of 1 m^2. All faces are equal by symmetry: H = Phi / (6 (1 - rho)).
  for (const double reflectance : {0.0, 0.5}) {
    Scene scene = cube_of(reflectance);
    scene.luminaires = {point_at(Point::Zero(), 12)};
    expect_irradiance(scene, 2, 2 / (1 - reflectance), 0.02);
    scene.luminaires = {sphere_at(Point::Zero(), 0.1, 12)};
    expect_irradiance(scene, 2, 2 / (1 - reflectance), 0.02);
  }
}

TEST(PathLights, OneOfManyLuminairesStandsForAll) {
  // One strong and many weak luminaires, all in the middle: their sum, for any choice.
  Scene scene = cube_of(0.5);
  for (int k = 0; k < 20; ++k) scene.luminaires.push_back(point_at(Point::Zero(), k == 3 ? 5 : 0.35));
  scene.luminaires.push_back(sphere_at(Point::Zero(), 0.01, 0.35));
  expect_irradiance(scene, 4, 4, 0.02);
}

TEST(PathLights, SunShinesThroughAClearFace) {
  // Through a clear ceiling of transmittance t at normal incidence the sun at the zenith gives E t on the whole floor.
  Scene scene = cube_room(0, 0);
  scene.materials.push_back(named("glass", 0, 0.6));
  scene.polygons[1].material = 1;
  scene.sun = Sun{Vector::UnitZ(), watts(800)};
  expect_irradiance(scene, 0, 480, 1e-6);
  // At tan = 1/2 from the zenith half of the floor lies in the shadow of a wall: E T(cos) cos / 2.
  scene.sun = Sun{Vector(1, 0, 2).normalized(), watts(800)};
  const double cosine = 2 / std::sqrt(5.0);
  expect_irradiance(scene, 0, 800 * transmittance(pane_of(1.52, 0.6), cosine) * cosine / 2, 0.01);
}

// The form factor of two opposed unit squares at distance 1 with a pane between them: the integral of its transmittance
// over all differences of two points, by midpoints.
double opposed_behind(const Pane& pane) {
  constexpr int steps = 400;
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    for (int j = 0; j < steps; ++j) {
      const double x = (i + 0.5) / steps, y = (j + 0.5) / steps;
      const double squared = 1 + x * x + y * y;
      sum += 4 * (1 - x) * (1 - y) * transmittance(pane, 1 / std::sqrt(squared)) / (squared * squared);
    }
  }
  return sum / (pi * steps * steps);
}

TEST(PathLights, SkyIsSeenThroughHolesAndClearFaces) {
  // A uniform sky of radiance L over a black box whose ceiling is clear or missing: pi L F, with T(cos) in the integral
  // of F. The fraction F of 4,096 rays leaves: they scatter by at most sqrt((1 - F) / F / 4096) = 0.031.
  Scene scene = cube_room(0, 0);
  scene.materials.push_back(named("glass", 0, 0.7));
  scene.polygons[1].material = 1;
  Sky sky;
  sky.zenith_radiance = watts(3);
  scene.sky = sky;
  EXPECT_NEAR(opposed_behind(pane_of(1.52, 1)), opposed, 1e-5);
  expect_irradiance(scene, 0, pi * 3 * opposed_behind(pane_of(1.52, 0.7)), 0.032);
  scene.polygons.erase(scene.polygons.begin() + 1);
  expect_irradiance(scene, 0, pi * 3 * opposed, 0.032);
}

TEST(PathLights, OpenGroundHasTheHorizontalIrradianceOfItsSky) {
  // An overcast sky gives the horizontal irradiance H on a horizontal face of any reflectance. The sky is rotated with
  // its up direction.
  Scene scene = with_quad(empty_scene({grey(0.8)}), {Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)});
  Sky sky;
  sky.kind = SkyKind::cie_overcast;
  sky.horizontal_irradiance = watts(50);
  scene.sky = sky;
  expect_irradiance(scene, 0, 50, 0.01);
}

}  // namespace
}  // namespace patchlight::lights_test
