#include "patchlight/base/error.h"
#include "patchlight/simulate.h"
#include "patchlight/views/views.h"

#include "base/sampling.h"
#include "form_factor/point_polygon.h"
#include "light/pane.h"
#include "optics/surface_optics.h"
#include "support/scenes.h"
#include "verify/path_tracer.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <utility>

namespace patchlight::mirrors_test {
namespace {

using namespace test;

Material mirror(double specular_reflectance, double exitance = 0) {
  Material material = grey(0, exitance);
  material.name = "mirror";
  material.specular_reflectance = Spectrum::Constant(1, specular_reflectance);
  return material;
}

Request fronts(PatchIndex patches) {
  Request request;
  request.mesh.sides = Sides::front;
  request.mesh.patches = patches;
  return request;
}

// A closed room of 4 x 3 x 2.5 m. Material 1 covers the wall at low x, material 2 the wall at high x.
Scene room(std::vector<Material> materials) {
  Scene scene = empty_scene(std::move(materials));
  const std::vector<Quad> faces = box_faces(Point(0, 0, 0), Point(4, 3, 2.5), true);
  for (std::size_t k = 0; k < faces.size(); ++k)
    scene = with_quad(std::move(scene), faces[k],
                      k == 5   ? MaterialIndex{1}
                      : k == 3 ? MaterialIndex{2}
                               : MaterialIndex{0});
  return scene;
}

// A lamp of 1 m x 0.5 m below the ceiling, facing down.
Scene with_lamp(Scene scene, double x, MaterialIndex material) {
  return with_quad(std::move(scene),
                   {Point(x, 1, 2.4), Point(x, 1.5, 2.4), Point(x + 1, 1.5, 2.4), Point(x + 1, 1, 2.4)}, material);
}

std::vector<Point> mirrored_at_low_x(std::vector<Point> points) {
  for (Point& point : points) point.x() = -point.x();
  return {points.rbegin(), points.rend()};
}

double on_floor(const Simulation& simulation, PatchIndex i) { return simulation.solution.irradiance(i, 0); }

TEST(PlanarMirror, ShowsTheLampOnceMore) {
  // Black walls: H = E (F(x, lamp) + R F(x, image of the lamp)), both by Lambert's formula. The mirror covers the whole
  // wall, so every point of the floor sees the whole image.
  const double R = 0.9;
  Scene scene = with_lamp(room({grey(0), mirror(R), grey(0), grey(0, 10)}), 1.5, 3);
  const std::vector<Point> lamp = corner_points(scene, 6);
  SensorGroup group;
  group.name = "floor";
  for (const double x : {0.05, 0.7, 2.0, 3.5})
    for (const double y : {0.3, 1.2, 2.9}) group.sensors.push_back({Point(x, y, 0), Vector::UnitZ()});
  scene.sensors = {group};
  const Simulation simulation = simulate(scene, fronts(400));
  const auto expected_at = [&](const Point& x) {
    const std::vector<Point> image = mirrored_at_low_x(lamp);
    return 10 * (point_to_polygon(x, Vector::UnitZ(), lamp) + R * point_to_polygon(x, Vector::UnitZ(), image));
  };
  const Readings readings = read_sensors(simulation).readings;
  for (std::size_t k = 0; k < group.sensors.size(); ++k)
    EXPECT_NEAR(readings.irradiance(static_cast<Eigen::Index>(k), 0) / expected_at(group.sensors[k].point), 1, 0.003);

  // Patch means, against means over 8 x 8 points; the error of these is below that of the mesh.
  const PatchRange floor = simulation.mesh.patches_on(0, Side::front);
  double flux = 0, expected = 0;
  for (PatchIndex i = floor.begin; i < floor.end; ++i) {
    flux += simulation.mesh.area[i] * on_floor(simulation, i);
    const PatchCorners corners = simulation.mesh.corner_points(i);
    for (int u = 0; u < 8; ++u)
      for (int v = 0; v < 8; ++v)
        expected +=
            simulation.mesh.area[i] / 64 * expected_at(square_to_quad(corners.points, (u + 0.5) / 8, (v + 0.5) / 8));
  }
  EXPECT_NEAR(flux / expected, 1, 0.003);
}

// Reflectances of the two mirrors at the ends.
class MirrorFurnace : public testing::TestWithParam<std::pair<double, double>> {};

TEST_P(MirrorFurnace, IsOne) {
  // Walls emit 1 - rho and mirrors 1 - R: all light has the radiance 1 / pi, also between facing mirrors. Mirrors
  // absorb at least 1e-6, and a ray keeps R^64 of its light after 64 reflections.
  const auto [R, other] = GetParam();
  const Scene scene = room({grey(0.6, 0.4), mirror(R, 1 - R), mirror(other, 1 - other)});
  const Simulation simulation = simulate(scene, fronts(600));
  EXPECT_EQ(simulation.plan.assembly.storage, Storage::rays);
  for (PatchIndex i = 0; i < simulation.mesh.size(); ++i) {
    const PolygonIndex p = simulation.mesh.polygon[i];
    const double held = p == 5 ? 1 - R : p == 3 ? 1 - other : 1;
    if (held < 0.01) continue;  // the minimum 1e-6 is too small to resolve
    EXPECT_NEAR(simulation.solution.radiosity(i, 0), held, 1e-3 * held) << p;
  }
  EXPECT_LT(simulation.balance.imbalance, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(HardCases, MirrorFurnace,
                         testing::Values(std::pair(0.9, 0.0), std::pair(0.99, 0.99), std::pair(0.5, 0.9),
                                         std::pair(1.0, 0.0)));

TEST(PlanarMirror, OfNoReflectanceIsABlackWall) {
  const Scene black = with_lamp(room({grey(0.5), grey(0), grey(0.5), grey(0, 10)}), 1.5, 3);
  const Scene dark = with_lamp(room({grey(0.5), mirror(0), grey(0.5), grey(0, 10)}), 1.5, 3);
  const Simulation one = simulate(black, fronts(300));
  const Simulation other = simulate(dark, fronts(300));
  EXPECT_TRUE((one.solution.radiosity == other.solution.radiosity).all());
}

// A mirror of 2 x 1.2 m in front of the wall at low x, a box in front of the mirror, and a lamp.
Scene furnished_with_mirror(double R) {
  Scene scene = with_lamp(room({grey(0.6), grey(0.5), grey(0.3), grey(0, 10), mirror(R)}), 1.5, 3);
  scene = with_quad(std::move(scene),
                    {Point(0.01, 0.5, 0.8), Point(0.01, 2.5, 0.8), Point(0.01, 2.5, 2), Point(0.01, 0.5, 2)}, 4);
  return with_box(std::move(scene), Point(0.5, 1, 0), Point(1, 1.6, 1.2), false);
}

// Means over whole faces, against path tracing without patches or images.
TEST(PlanarMirror, LightsARoomAsPathsDo) {
  const Scene scene = furnished_with_mirror(0.9);
  const Simulation simulation = simulate(scene, fronts(3000));
  const KeptSides sides = kept_sides(scene, Sides::front);
  for (const PolygonIndex p : {0U, 1U, 2U, 3U, 4U, 5U}) {
    const std::vector<Point> corners = corner_points(scene, p);
    const PathReceiver receiver{{corners[0], corners[1], corners[2], corners[3]}, p, Side::front};
    const PathEstimate paths = trace_irradiance(scene, sides, {&receiver, 1}, {.paths = 1 << 15});
    const PatchRange range = simulation.mesh.patches_on(p, Side::front);
    double flux = 0, area = 0;
    for (PatchIndex i = range.begin; i < range.end; ++i) {
      flux += simulation.problem.area[i] * simulation.solution.irradiance(i, 0);
      area += simulation.problem.area[i];
    }
    EXPECT_NEAR(flux / area / paths.irradiance(0, 0), 1, 0.01 + 4 * paths.standard_error(0, 0) / paths.irradiance(0, 0))
        << p;
  }
}

TEST(PlanarMirror, LosesNothing) {
  const Simulation simulation = simulate(furnished_with_mirror(0.9), fronts(1500));
  EXPECT_LT(simulation.balance.imbalance, 1e-3);
  // The mirror has 2.4 m^2 of 77 m^2; it returns the light that would be absorbed, a few percent.
  const Simulation dark = simulate(furnished_with_mirror(0), fronts(1500));
  const auto flux = [](const Simulation& of) { return of.problem.area.dot(of.solution.irradiance.col(0).matrix()); };
  EXPECT_GT(flux(simulation) / flux(dark), 1.02);
}

TEST(PlanarMirror, GivesTheSameBitsOnOneThreadAndOnTwo) {
  Request request = fronts(500);
  request.resources.threads = 1;
  const Simulation one = simulate(furnished_with_mirror(0.9), request);
  request.resources.threads = 2;
  const Simulation two = simulate(furnished_with_mirror(0.9), request);
  EXPECT_TRUE((one.solution.radiosity == two.solution.radiosity).all());
}

// A mirror on the sill reflects the sun onto the ceiling. The flux R E A sin(altitude) arrives on the patches that
// geometry predicts. 64 samples per patch give 1 % of the flux.
TEST(PlanarMirror, ThrowsTheSunOntoTheCeiling) {
  Scene scene = empty_scene({grey(0), mirror(0.8)});
  scene = with_quad(std::move(scene), {Point(0, 0, 3), Point(0, 4, 3), Point(6, 4, 3), Point(6, 0, 3)});
  scene = with_quad(std::move(scene), {Point(0, 1, 0), Point(0.4, 1, 0), Point(0.4, 3, 0), Point(0, 3, 0)}, 1);
  const double altitude = 0.7;
  scene.sun = Sun{Vector(-std::cos(altitude), 0, std::sin(altitude)), Spectrum::Constant(1, 800)};
  const Simulation simulation = simulate(scene, fronts(2000));
  const double shift = 3 / std::tan(altitude);
  double flux = 0;
  for (PatchIndex i = 0; i < simulation.mesh.size(); ++i) {
    if (simulation.mesh.polygon[i] != 0) continue;
    const double H = simulation.solution.irradiance(i, 0);
    flux += simulation.mesh.area[i] * H;
    const Point& at = simulation.mesh.centroid[i];
    const double edge = 0.2;
    if (H > 0) {
      EXPECT_GT(at.x(), shift - edge);
      EXPECT_LT(at.x(), shift + 0.4 + edge);
    }
  }
  EXPECT_NEAR(flux / (0.8 * 800 * std::sin(altitude) * 0.8), 1, 0.01);
}

// The cusp of the caustic of a half cylinder: a concave mirror of radius r focuses parallel light at r / 2. Each of 64
// strips reflects its light onto the floor: flux E R sum A cos. Light that meets a second mirror is excluded: only
// strips within 45 degrees of the axis are mirrors.
TEST(ConcaveMirror, ThrowsACausticWhoseCuspIsAtHalfItsRadius) {
  const double r = 1, height = 0.1, R = 0.9, slope = 0.1;
  Scene scene = empty_scene({grey(0), mirror(R)});
  scene =
      with_quad(std::move(scene), {Point(-1.2, -1.5, 0), Point(1.5, -1.5, 0), Point(1.5, 1.5, 0), Point(-1.2, 1.5, 0)});
  const Vector sun = Vector(1, 0, slope).normalized();
  double expected = 0;
  const int strips = 64;
  const auto at = [&](int k, double z) {
    const double angle = std::numbers::pi * (0.75 + 0.5 * k / strips);
    return Point(r * std::cos(angle), r * std::sin(angle), z);
  };
  for (int k = 0; k < strips; ++k) {
    const Quad strip{at(k, 0), at(k, height), at(k + 1, height), at(k + 1, 0)};
    scene = with_quad(std::move(scene), strip, 1);
    const Vector area = area_vector(std::vector<Point>(strip.begin(), strip.end()));
    EXPECT_GT(area.x(), 0);
    expected += 500 * R * area.dot(sun);
  }
  scene.sun = Sun{sun, Spectrum::Constant(1, 500)};
  const Simulation with = simulate(scene, fronts(6000));
  scene.materials[1].specular_reflectance.setZero();
  const Simulation without = simulate(scene, fronts(6000));
  double flux = 0, brightest = 0;
  Point cusp = Point::Zero();
  for (PatchIndex i = 0; i < with.mesh.size() && with.mesh.polygon[i] == 0; ++i) {
    const double thrown = with.problem.direct_irradiance(i, 0) - without.problem.direct_irradiance(i, 0);
    flux += with.mesh.area[i] * thrown;
    if (thrown > brightest) brightest = thrown, cusp = with.mesh.centroid[i];
  }
  EXPECT_NEAR(flux / expected, 1, 0.01);
  // Light descends on its way, so some of it from the upper half of the mirror gets as far as the focus.
  EXPECT_NEAR(cusp.x(), -r / 2, 0.06);
  EXPECT_NEAR(cusp.y(), 0, 0.06);
}

// Sensors at points, each with a direction.
Scene with_sensors(Scene scene, std::vector<Sensor> sensors) {
  SensorGroup group;
  group.name = "sensors";
  group.sensors = std::move(sensors);
  scene.sensors = {group};
  return scene;
}

// Two perpendicular mirrors show three images of a point lamp, one of them by both mirrors in either order. Each half
// of the floor sees that image by one of the two orders. The four terms I cos / d^2 match up to rounding.
TEST(PlanarMirrors, ShowThreeImagesInACorner) {
  const double R = 0.9;
  Scene scene = empty_scene({grey(0), mirror(R)});
  scene = with_quad(std::move(scene), {Point(0, 0, 0), Point(4, 0, 0), Point(4, 4, 0), Point(0, 4, 0)});
  scene = with_quad(std::move(scene), {Point(0, 0, 0), Point(0, 9, 0), Point(0, 9, 9), Point(0, 0, 9)}, 1);
  scene = with_quad(std::move(scene), {Point(0, 0, 0), Point(0, 0, 9), Point(9, 0, 9), Point(9, 0, 0)}, 1);
  Luminaire lamp;
  lamp.position = Point(1.2, 0.7, 2);
  lamp.light = PointLight{Spectrum::Constant(1, 100)};
  scene.luminaires = {lamp};
  std::vector<Sensor> sensors;
  for (const Point& at : {Point(0.3, 2.5, 0.01), Point(2, 1, 0.01), Point(3.1, 3.3, 0.01)})
    sensors.push_back({at, Vector::UnitZ()});
  const Simulation simulation = simulate(with_sensors(scene, sensors), fronts(200));
  const Readings readings = read_sensors(simulation).readings;
  for (std::size_t k = 0; k < sensors.size(); ++k) {
    double expected = 0;
    for (const double x : {1.2, -1.2}) {
      for (const double y : {0.7, -0.7}) {
        const Vector way = Point(x, y, 2) - sensors[k].point;
        expected += (x < 0 ? R : 1) * (y < 0 ? R : 1) * 100 * way.z() / std::pow(way.norm(), 3);
      }
    }
    EXPECT_NEAR(readings.irradiance(static_cast<Eigen::Index>(k), 0) / expected, 1, 1e-9) << k;
  }
}

// A sensor 1 m above a mirror of 200 x 200 m looks down under a uniform sky of radiance L: pi L R, less 1e-4 outside of
// the mirror. The sky is sampled, with a known standard error.
TEST(PlanarMirror, ShowsTheSky) {
  Scene scene = empty_scene({grey(0), mirror(0.8)});
  scene = with_quad(std::move(scene),
                    {Point(-100, -100, 0), Point(100, -100, 0), Point(100, 100, 0), Point(-100, 100, 0)}, 1);
  scene = with_quad(std::move(scene), {Point(50, 50, 3), Point(51, 50, 3), Point(51, 51, 3), Point(50, 51, 3)});
  scene.sky = Sky{};
  scene.sky->kind = SkyKind::uniform;
  scene.sky->zenith_radiance = Spectrum::Constant(1, 10);
  scene.sky->ground_radiance = Spectrum::Zero(1);
  scene = with_sensors(std::move(scene), {{Point(0, 0, 1), -Vector::UnitZ()}});
  const Readings readings = read_sensors(simulate(scene, fronts(100))).readings;
  const double expected = std::numbers::pi * 10 * 0.8;
  EXPECT_NEAR(readings.irradiance(0, 0), expected, 4 * readings.standard_error(0, 0) + 1e-3 * expected);
  EXPECT_LT(readings.standard_error(0, 0), 0.01 * expected);
}

// A sensor faces a mirror with a wall of radiosity 5 behind it: 5 R F(x, image of the wall).
TEST(PlanarMirror, ShowsAWallBehindTheSensor) {
  const double R = 0.7;
  Scene scene = empty_scene({grey(0, 5), mirror(R)});
  scene = with_quad(std::move(scene), {Point(3, -2, -2), Point(3, 2, -2), Point(3, 2, 2), Point(3, -2, 2)});
  std::swap(scene.polygons[0].corners[1], scene.polygons[0].corners[3]);
  scene = with_quad(std::move(scene), {Point(0, -9, -9), Point(0, 9, -9), Point(0, 9, 9), Point(0, -9, 9)}, 1);
  scene = with_sensors(std::move(scene), {{Point(1, 0.3, 0.2), -Vector::UnitX()}});
  const Simulation simulation = simulate(scene, fronts(100));
  const std::vector<Point> image = mirrored_at_low_x(corner_points(scene, 0));
  const double expected = 5 * R * point_to_polygon(Point(1, 0.3, 0.2), -Vector::UnitX(), image);
  const Readings readings = read_sensors(simulation).readings;
  EXPECT_GT(expected, 0.5);
  EXPECT_NEAR(readings.irradiance(0, 0), expected, 4 * readings.standard_error(0, 0) + 1e-6);
  EXPECT_LT(readings.standard_error(0, 0), 0.02 * expected);
}

// The light of a point lamp that a pane reflects at 0 to 80 degrees: I cos / d^2 R(theta).
TEST(Pane, ReflectsByItsAngle) {
  Material glass = grey(0);
  glass.transmittance = Spectrum::Constant(1, 0.8);
  Scene scene = empty_scene({grey(0), glass});
  scene = with_quad(std::move(scene), {Point(0, -90, -90), Point(0, 90, -90), Point(0, 90, 90), Point(0, -90, 90)}, 1);
  scene = with_quad(std::move(scene), {Point(9, -1, -1), Point(9, 1, -1), Point(9, 1, 1), Point(9, -1, 1)});
  Luminaire lamp;
  lamp.position = Point(1, 0, 0);
  lamp.light = PointLight{Spectrum::Constant(1, 100)};
  scene.luminaires = {lamp};
  std::vector<Sensor> sensors;
  for (const double degrees : {0.0, 30.0, 60.0, 80.0})
    sensors.push_back({Point(1, 2 * std::tan(degrees * std::numbers::pi / 180), 0.01), -Vector::UnitX()});
  scene = with_sensors(std::move(scene), sensors);
  const Readings readings = read_sensors(simulate(scene, fronts(100))).readings;
  for (std::size_t k = 0; k < sensors.size(); ++k) {
    const Vector way = Point(-1, 0, 0) - sensors[k].point;
    const double cosine = -way.x() / way.norm();
    const double expected = 100 * cosine / way.squaredNorm() * specular_reflectance(pane_of(1.52, 0.8), cosine);
    EXPECT_NEAR(readings.irradiance(static_cast<Eigen::Index>(k), 0) / expected, 1, 1e-9) << k;
  }
}

TEST(Mirrors, AreLeftOutOnDemand) {
  Request request = fronts(300);
  request.effects.skip = {Effect::mirrors};
  const Simulation without = simulate(furnished_with_mirror(0.9), request);
  const Simulation black = simulate(furnished_with_mirror(0), fronts(300));
  EXPECT_EQ(without.plan.assembly.storage, Storage::tiles);
  EXPECT_TRUE((without.solution.radiosity == black.solution.radiosity).all()) << "what they reflect is absorbed";
}

TEST(Mirrors, AreRefusedWhereTheyReflectMoreThanArrives) {
  Material bad = mirror(0.7);
  bad.reflectance.setConstant(0.4);
  EXPECT_THROW(check(room({grey(0.5, 1), bad, grey(0.5)})), InputError);
  Material both = mirror(0.5);
  both.transmittance = Spectrum::Constant(1, 0.3);
  EXPECT_THROW(check(room({grey(0.5, 1), both, grey(0.5)})), InputError);
}

}  // namespace
}  // namespace patchlight::mirrors_test
