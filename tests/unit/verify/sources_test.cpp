#include "light/pane.h"
#include "lighting/sky.h"
#include "scene/photometric_web.h"
#include "support/daylight_office.h"
#include "verify/delta_sources.h"
#include "verify/path_tracer.h"

#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

// The path tracer's own sources, panes and mirrors, compared with closed forms and with the solver's code.
namespace patchlight::sources_test {
namespace {

using namespace test;

constexpr double pi = std::numbers::pi;

// Shadow rays have no noise if one source lights a sensor and nothing is reflected diffusely.
constexpr double rounding_of_rays = 1e-6;

PathEstimate at_sensors(const Scene& scene, const std::vector<Sensor>& sensors) {
  return trace_irradiance(scene, kept_sides(scene, Sides::both), sensors, {.paths = 4096});
}

double at_sensor(const Scene& scene, const Sensor& sensor) {
  const PathEstimate estimate = at_sensors(scene, {sensor});
  EXPECT_LE(estimate.standard_error(0, 0), rounding_of_rays * estimate.irradiance(0, 0));
  return estimate.irradiance(0, 0);
}

Luminaire lamp_at(const Point& position, double intensity) {
  Luminaire lamp;
  lamp.position = position;
  lamp.light = PointLight{watts(intensity)};
  return lamp;
}

// A black square far from everything, because a scene must have a polygon.
Scene black_scene() {
  return with_quad(empty_scene({grey(0)}),
                   {Point(90, 90, 90), Point(91, 90, 90), Point(91, 91, 90), Point(90, 91, 90)});
}

Material mirror_of(double reflectance) {
  Material material = grey(0);
  material.specular_reflectance = watts(reflectance);
  return material;
}

// A mirror of 200 m in the plane x = const.
Scene with_mirror_at(Scene scene, double x, MaterialIndex material, bool faces_up) {
  const Quad quad{Point(x, -100, -100), Point(x, 100, -100), Point(x, 100, 100), Point(x, -100, 100)};
  return with_quad(std::move(scene), faces_up ? quad : Quad{quad[3], quad[2], quad[1], quad[0]}, material);
}

// E = I cos / d^2 of a lamp, or of its image.
double from_point(const Point& lamp, double intensity, const Sensor& sensor) {
  const Vector way = lamp - sensor.point;
  return intensity * std::max(0.0, sensor.normal.dot(way)) / (way.squaredNorm() * way.norm());
}

TEST(PathSources, PointLightFallsWithTheSquareOfTheDistance) {
  Scene scene = black_scene();
  scene.luminaires = {lamp_at(Point(0, 0, 2), 5)};
  for (const double distance : {0.5, 1.0, 3.0}) {
    const Sensor sensor{Point(0, 0, 2 - distance), Vector(0, 0.6, 0.8)};
    EXPECT_NEAR(at_sensor(scene, sensor), 5 * 0.8 / (distance * distance), 5 * rounding_of_rays);
  }
}

TEST(PathSources, SpotHasHalfAtItsBeamAndATenthAtItsField) {
  Scene scene = black_scene();
  Luminaire lamp = lamp_at(Point(0, 0, 2), 0);
  lamp.light = SpotLight{watts(30), 20, 35};
  scene.luminaires = {lamp};
  for (const auto& [degrees, share] : {std::pair{0.0, 1.0}, std::pair{20.0, 0.5}, std::pair{35.0, 0.1}}) {
    const double angle = degrees * pi / 180;
    const Sensor sensor{Point(2 * std::tan(angle), 0, 0), Vector::UnitZ()};
    EXPECT_NEAR(at_sensor(scene, sensor), share * from_point(lamp.position, 30, sensor), 30 * rounding_of_rays);
  }
}

// Two implementations for one table: each type, each symmetry, 500 directions.
TEST(PathSources, MeasuredIntensitiesAreThoseOfTheSolver) {
  const std::vector<std::vector<double>> of_c{{0}, {0, 45, 90}, {0, 60, 180}, {90, 150, 270}, {0, 100, 200, 360}};
  const std::vector<std::vector<double>> of_ab{{-90, -10, 90}, {0, 30, 90}};
  const auto expect_alike = [](PhotometricType type, const std::vector<double>& horizontal) {
    auto web = std::make_shared<PhotometricWeb>();
    web->type = type;
    web->vertical = type == PhotometricType::c ? std::vector<double>{0, 25, 90, 140} : std::vector<double>{-90, 0, 70};
    web->horizontal = horizontal;
    for (std::size_t k = 0; k < horizontal.size() * web->vertical.size(); ++k)
      web->candela.push_back(100 + 37.0 * static_cast<double>(k * k % 11));
    web->tilt = {0, 50, 90};
    web->tilt_factor = {1, 0.8, 0.9};
    Luminaire lamp;
    lamp.aim = Vector(0.3, -0.5, -0.8).normalized();
    lamp.zero_plane = lamp.aim.unitOrthogonal();
    lamp.light = WebLight{web, watts(1)};
    const double tilt = std::acos(-lamp.aim.z()) * 180 / pi;
    for (int k = 0; k < 500; ++k) {
      const double z = 1 - (2 * k + 1) / 500.0;
      const double across = std::sqrt(1 - z * z);
      const Vector direction(across * std::cos(2.4 * k), across * std::sin(2.4 * k), z);
      const double expected = tilt_factor(*web, tilt) * candela(*web, {lamp.aim, lamp.zero_plane}, direction);
      EXPECT_NEAR(radiant_intensity(lamp, Vector::UnitZ(), direction)[0], expected, 1e-9 * 500)
          << static_cast<int>(type) << ' ' << horizontal.size() << ' ' << direction.transpose();
    }
  };
  for (const auto& horizontal : of_c) expect_alike(PhotometricType::c, horizontal);
  for (const auto& horizontal : of_ab) {
    expect_alike(PhotometricType::a, horizontal);
    expect_alike(PhotometricType::b, horizontal);
  }
}

TEST(PathSources, SunShinesThroughTwoPanesAtAnAngle) {
  Scene scene = black_scene();
  Material glass = grey(0);
  glass.transmittance = watts(0.7);
  scene.materials.push_back(glass);
  for (const double z : {1.0, 1.2})
    scene = with_quad(std::move(scene), {Point(-9, -9, z), Point(9, -9, z), Point(9, 9, z), Point(-9, 9, z)}, 1);
  for (const double degrees : {0.0, 40.0, 70.0}) {
    const double angle = degrees * pi / 180;
    scene.sun = Sun{Vector(std::sin(angle), 0, std::cos(angle)), watts(600)};
    const double one_pane = transmittance(pane_of(1.52, 0.7), std::cos(angle));
    // Light reflected back and forth between the panes, with the fraction R^2 each time, arrives as well.
    const double reflected = specular_reflectance(pane_of(1.52, 0.7), std::cos(angle));
    const double expected = 600 * std::cos(angle) * one_pane * one_pane;
    const PathEstimate straight =
        trace_irradiance(scene, kept_sides(scene, Sides::both), std::vector<Sensor>{{Point(0, 0, 0), Vector::UnitZ()}},
                         {.paths = 4096, .follows_reflections = false});
    EXPECT_NEAR(straight.irradiance(0, 0), expected, 600 * rounding_of_rays) << degrees;
    const PathEstimate with_images = at_sensors(scene, {{Point(0, 0, 0), Vector::UnitZ()}});
    EXPECT_NEAR(with_images.irradiance(0, 0), expected / (1 - reflected * reflected),
                4 * with_images.standard_error(0, 0) + 600 * rounding_of_rays)
        << degrees;
    EXPECT_LT(with_images.standard_error(0, 0), 0.01 * expected);
  }
}

void expect_the_solvers_radiance(const Sky& sky, const Vector& up) {
  const SkyModel of_solver = sky_model(sky, up);
  const SkyRadiance own(sky, up);
  for (int k = 0; k < 200; ++k) {
    const double z = 1 - (2 * k + 1) / 200.0;
    const double across = std::sqrt(1 - z * z);
    const Vector direction(across * std::cos(2.4 * k), across * std::sin(2.4 * k), z);
    const double expected = radiance(of_solver, direction)[0];
    EXPECT_NEAR(own.radiance_from(direction)[0], expected, 2e-4 * expected)
        << static_cast<int>(sky.kind) << ' ' << sky.clearness << ' ' << sky.brightness;
  }
}

// Both normalizations integrate a function of two angles with about 1e5 points, and agree to 1e-4.
TEST(PathSources, SkiesAreThoseOfTheSolver) {
  const Vector up = Vector(0.2, -0.1, 1).normalized();
  Sky sky;
  sky.horizontal_irradiance = watts(70);
  sky.sun_direction = Vector(0.5, -0.3, 0.6).normalized();
  sky.ground_radiance = watts(3);
  for (const SkyKind kind : {SkyKind::uniform, SkyKind::cie_overcast, SkyKind::cie_clear}) {
    sky.kind = kind;
    expect_the_solvers_radiance(sky, up);
  }
  // Brightnesses within the fit, and on either side of it.
  sky.kind = SkyKind::perez;
  for (const double clearness : {1.0, 1.1, 1.4, 1.7, 2.3, 3.5, 5.0, 8.0}) {
    for (const double brightness : {0.05, 0.2, 1.4}) {
      sky.clearness = clearness;
      sky.brightness = brightness;
      expect_the_solvers_radiance(sky, up);
    }
  }
  // A sun at the horizon, where brightness has a lower limit.
  sky.sun_direction = up.unitOrthogonal();
  sky.clearness = 3;
  sky.brightness = 0.8;
  expect_the_solvers_radiance(sky, up);
}

TEST(PathSources, SkyThroughAHoleHasItsFormFactor) {
  // Below the middle of a square hole of half side a at height h: F = 4 / (2 pi) 2 a / r atan(a / r), r^2 = a^2 + h^2.
  Scene scene = with_box(empty_scene({grey(0)}), Point(-0.5, -0.5, -1), Point(0.5, 0.5, 0), true);
  scene.polygons.erase(scene.polygons.begin() + 1);
  Sky sky;
  sky.zenith_radiance = watts(3);
  scene.sky = sky;
  const double r = std::hypot(0.5, 0.8);
  const double form_factor = 4 / pi * (0.5 / r) * std::atan(0.5 / r);
  const PathEstimate estimate = at_sensors(scene, {{Point(0, 0, -0.8), Vector::UnitZ()}});
  EXPECT_NEAR(estimate.irradiance(0, 0), pi * 3 * form_factor, 4 * estimate.standard_error(0, 0));
  EXPECT_LT(estimate.standard_error(0, 0), 0.02 * pi * 3 * form_factor);
}

TEST(PathMirrors, OneMirrorAddsOneImage) {
  Scene scene = empty_scene({grey(0), mirror_of(0.8)});
  scene = with_mirror_at(std::move(scene), 0, 1, true);
  scene.luminaires = {lamp_at(Point(1, 0.3, 0.5), 7)};
  const Sensor sensor{Point(2, -0.4, 0.1), Vector(-0.8, 0, 0.6)};
  const double expected = from_point(Point(1, 0.3, 0.5), 7, sensor) + 0.8 * from_point(Point(-1, 0.3, 0.5), 7, sensor);
  const PathEstimate estimate = at_sensors(scene, {sensor});
  EXPECT_NEAR(estimate.irradiance(0, 0), expected, 4 * estimate.standard_error(0, 0));
  EXPECT_LT(estimate.standard_error(0, 0), 0.002 * expected);  // one draw in 20 is for the back of the mirror
}

TEST(PathMirrors, ACornerShowsThreeImages) {
  Scene scene = empty_scene({grey(0), mirror_of(0.8)});
  scene = with_mirror_at(std::move(scene), 0, 1, true);
  scene =
      with_quad(std::move(scene), {Point(0, 0, -100), Point(0, 0, 100), Point(100, 0, 100), Point(100, 0, -100)}, 1);
  scene.luminaires = {lamp_at(Point(1, 0.7, 0.5), 7)};
  const Sensor sensor{Point(2, 0.9, 0.1), Vector(-0.7, -0.7, 0.1).normalized()};
  const double expected = from_point(Point(1, 0.7, 0.5), 7, sensor) + 0.8 * from_point(Point(-1, 0.7, 0.5), 7, sensor) +
                          0.8 * from_point(Point(1, -0.7, 0.5), 7, sensor) +
                          0.64 * from_point(Point(-1, -0.7, 0.5), 7, sensor);
  const PathEstimate estimate = at_sensors(scene, {sensor});
  EXPECT_NEAR(estimate.irradiance(0, 0), expected, 4 * estimate.standard_error(0, 0));
  EXPECT_LT(estimate.standard_error(0, 0), 0.01 * expected);
}

TEST(PathMirrors, TwoFacingMirrorsAddAllTheirImages) {
  // Mirrors at 0 and 1, the lamp at a: images at 2 n + a after 2 |n| reflections, and at 2 n - a after |2 n - 1|.
  for (const double reflectance : {0.5, 0.9}) {
    Scene scene = empty_scene({grey(0), mirror_of(reflectance)});
    scene = with_mirror_at(std::move(scene), 0, 1, true);
    scene = with_mirror_at(std::move(scene), 1, 1, false);
    const double a = 0.3;
    scene.luminaires = {lamp_at(Point(a, 0, 0.5), 7)};
    const Sensor sensor{Point(0.6, 0.2, 0), Vector(0.6, 0, 0.8)};
    double expected = 0;
    for (int n = -200; n <= 200; ++n) {
      expected += std::pow(reflectance, 2 * std::abs(n)) * from_point(Point(2 * n + a, 0, 0.5), 7, sensor);
      expected += std::pow(reflectance, std::abs(2 * n - 1)) * from_point(Point(2 * n - a, 0, 0.5), 7, sensor);
    }
    const PathEstimate estimate = at_sensors(scene, {sensor});
    EXPECT_NEAR(estimate.irradiance(0, 0), expected, 4 * estimate.standard_error(0, 0)) << reflectance;
    EXPECT_LT(estimate.standard_error(0, 0), 0.01 * expected) << reflectance;
  }
}

TEST(PathMirrors, ANarrowSpotOnASmallMirrorOutshinesALargeOneElsewhere) {
  Scene scene = empty_scene({grey(0), mirror_of(0.9)});
  // 10 cm, across the beam at x = 3, and 200 m below all.
  scene = with_quad(std::move(scene),
                    {Point(3, -0.05, 0.95), Point(3, -0.05, 1.05), Point(3, 0.05, 1.05), Point(3, 0.05, 0.95)}, 1);
  scene = with_quad(std::move(scene),
                    {Point(-100, -100, 0), Point(100, -100, 0), Point(100, 100, 0), Point(-100, 100, 0)}, 1);
  Luminaire lamp = lamp_at(Point(0, 0, 1), 0);
  lamp.aim = Vector::UnitX();
  lamp.zero_plane = Vector::UnitZ();
  lamp.light = SpotLight{watts(1000), 2, 4};
  scene.luminaires = {lamp};
  const Sensor sensor{Point(-1, 0, 1), Vector::UnitX()};
  const PathEstimate estimate = at_sensors(scene, {sensor});
  const double in_small_mirror = 0.9 * from_point(Point(6, 0, 1), 1000, sensor);
  EXPECT_NEAR(estimate.irradiance(0, 0), in_small_mirror, 4 * estimate.standard_error(0, 0) + 1e-3 * in_small_mirror);
  EXPECT_LT(estimate.standard_error(0, 0), 0.02 * in_small_mirror);
}

TEST(PathMirrors, TheSunIsSeenInAMirrorByItsOutline) {
  // A mirror of 2 m on the floor reflects the sun onto a sensor above it that faces down, but not beyond its outline.
  Scene scene = empty_scene({grey(0), mirror_of(0.6)});
  scene = with_quad(std::move(scene), {Point(-1, -1, 0), Point(1, -1, 0), Point(1, 1, 0), Point(-1, 1, 0)}, 1);
  scene.sun = Sun{Vector(1, 0, 2).normalized(), watts(500)};
  const double cosine = 2 / std::sqrt(5.0);
  const PathEstimate estimate =
      at_sensors(scene, {{Point(-1, 0, 1), -Vector::UnitZ()}, {Point(1, 0, 1), -Vector::UnitZ()}});
  EXPECT_NEAR(estimate.irradiance(0, 0), 0.6 * 500 * cosine, 4 * estimate.standard_error(0, 0));
  EXPECT_LT(estimate.standard_error(0, 0), 0.002 * 0.6 * 500 * cosine);
  EXPECT_EQ(estimate.irradiance(1, 0), 0);
}

}  // namespace
}  // namespace patchlight::sources_test
