#include "lighting/direct_irradiance.h"

#include "patchlight/scene/sides.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "light/pane.h"
#include "mesh/mesher.h"
#include "mesh/nested_mesh.h"
#include "scene/photometric_web.h"
#include "support/scenes.h"

#include <cmath>
#include <gtest/gtest.h>
#include <memory>
#include <numbers>
#include <numeric>
#include <vector>

namespace patchlight::direct_irradiance_test {
namespace {

using namespace test;

constexpr double pi = std::numbers::pi;

Spectrum one_band(double value) { return Spectrum::Constant(1, value); }

// A floor of 20 x 20 m, front side up; a black one, far below all that the tests look at, unless they say otherwise.
Scene with_floor(Scene scene, double z = 0) {
  return with_quad(std::move(scene), {Point(-10, -10, z), Point(10, -10, z), Point(10, 10, z), Point(-10, 10, z)});
}
Scene only_floor(double z = 0) { return with_floor(empty_scene({grey(0.5)}), z); }

Luminaire sphere(const Point& centre, double radius, double exitance) {
  Luminaire lamp;
  lamp.position = centre;
  lamp.light = SphericalLamp{radius, one_band(exitance)};
  return lamp;
}

PatchMesh fronts(const Scene& scene, double max_edge) {
  return tessellate(scene, kept_sides(scene, Sides::front), max_edge);
}

DirectIrradiance at(const Scene& scene, const SurfacePoint& point, const LightingOptions& options = {}) {
  return direct_irradiance(lighting_of(scene, Tracing(scene)), {&point, 1}, options);
}

TEST(DirectIrradiance, OfASphereIsThatOfAPointWhereItIsAllAboveTheHorizon) {
  // E = M (r / d)^2 cos theta. In the square of the samples the cosine is smooth: 64 Owen-scrambled points leave about
  // 64^-1.5 = 2e-3 of what it varies by, here a third of its mean.
  Scene scene = only_floor(-5);
  scene.luminaires = {sphere(Point(0, 1, 2), 0.5, 7)};
  const DirectIrradiance direct = at(scene, {Point(0, 0, 0), Vector::UnitZ()});
  const double expected = 7 * 0.25 / 5 * 2 / std::sqrt(5.0);
  EXPECT_NEAR(direct.irradiance(0, 0), expected, 0.005 * expected);
  EXPECT_LT(direct.standard_error(0, 0), 0.005 * expected);
}

TEST(DirectIrradiance, OfASphereThatTheHorizonCutsDiffersByTheVectorIrradiance) {
  // The irradiances of both sides of a plane differ by M (r / d)^2 cos theta, however the sphere lies; both are seen
  // here, as cos theta = 0.1 < r / d = 0.5.
  Scene scene = only_floor(-5);
  const double distance = 2;
  scene.luminaires = {sphere(Point(distance * std::sqrt(0.99), 0, distance * 0.1), 1, 7)};
  LightingOptions options;
  options.lamp_samples = 4096;
  const double above = at(scene, {Point(0, 0, 0), Vector::UnitZ()}, options).irradiance(0, 0);
  const double below = at(scene, {Point(0, 0, 0), -Vector::UnitZ()}, options).irradiance(0, 0);
  EXPECT_GT(below, 0);
  EXPECT_NEAR(above - below, 7 * 0.25 * 0.1, 0.005 * 7 * 0.25 * 0.1);
}

// A point 0.3 m below the middle of a lamp of 0.15 m, part of which a plate hides: the estimates of its irradiance by
// 16 rays, over many scrambles.
struct Penumbra {
  std::vector<double> by_solid_angle;
  std::vector<double> by_area;
};

Penumbra penumbra() {
  const Scene scene =
      with_quad(only_floor(-5), {Point(0.02, -1, 0.1), Point(0.01, 1, 0.1), Point(1, 1, 0.1), Point(1, -1, 0.1)});
  const Point centre(0, 0, 0.3);
  const double radius = 0.15;
  const Luminaire lamp = sphere(centre, radius, 1);
  const LightPaths paths(scene, Tracing(scene));
  const auto arriving = [&](const Point& from) {
    const Segment ray{Point(0, 0, 0), from};
    return paths.transmittance({&ray, 1})(0, 0);
  };
  constexpr std::uint32_t samples = 16;
  Penumbra estimates;
  for (std::uint32_t trial = 0; trial < 200; ++trial) {
    double by_solid_angle = 0;
    double by_area = 0;
    for (const auto& [u, v, s, t] : scrambled_sobol(samples, hash({trial, 5}))) {
      const Arrival arrival = from_luminaire(lamp, scene.up, {Point(0, 0, 0), Vector::UnitZ()}, {u, v});
      by_solid_angle += arrival.irradiance * arriving(arrival.from) / samples;
      // Uniform over the sphere: E = M / pi x area x the mean of cos cos' / d^2 where the sphere's point is turned
      // here.
      const double z = 1 - 2 * u;
      const double across = std::sqrt(1 - z * z);
      const Vector normal(across * std::cos(2 * pi * v), across * std::sin(2 * pi * v), z);
      const Point there = centre + radius * normal;
      const double facing = normal.dot(-there.normalized());
      if (facing <= 0) continue;
      by_area +=
          4 * radius * radius * there.normalized().z() * facing / there.squaredNorm() * arriving(there) / samples;
    }
    estimates.by_solid_angle.push_back(by_solid_angle);
    estimates.by_area.push_back(by_area);
  }
  return estimates;
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double variance(const std::vector<double>& values) {
  double squares = 0;
  for (const double value : values) squares += value * value;
  return squares / static_cast<double>(values.size()) - mean(values) * mean(values);
}

TEST(DirectIrradiance, BySolidAngleInThePenumbraHasAFifthOfTheVarianceByArea) {
  const Penumbra estimates = penumbra();
  EXPECT_LT(5 * variance(estimates.by_solid_angle), variance(estimates.by_area));
  // Both mean the same, part of M (r / d)^2 = 0.25: three standard errors of the mean of 200.
  EXPECT_NEAR(mean(estimates.by_solid_angle), mean(estimates.by_area),
              3 * std::sqrt(variance(estimates.by_area) / 200));
  EXPECT_LT(mean(estimates.by_solid_angle), 0.2);
}

TEST(DirectIrradiance, OfAUniformSkyIsPiTimesItsRadiance) {
  Scene scene = only_floor(-5);
  Sky sky;
  sky.zenith_radiance = one_band(3);
  scene.sky = sky;
  const DirectIrradiance direct = at(scene, {Point(0, 0, 0), Vector::UnitZ()});
  EXPECT_NEAR(direct.irradiance(0, 0), 3 * pi, 1e-10);
  EXPECT_LT(direct.standard_error(0, 0), 1e-6);
  // And of a patch of the floor, to which nothing but the sky is seen.
  const PatchMesh mesh = fronts(scene, 10);
  EXPECT_NEAR(direct_irradiance(lighting_of(scene, Tracing(scene)), mesh).irradiance(0, 0), 3 * pi, 1e-10);
}

TEST(DirectIrradiance, OfAFacadeUnderAnOvercastSkyIsFortyPercent) {
  // E_vertical / E_horizontal = (pi / 6 + 4 / 9) / (7 pi / 9) = 39.62 %, over black ground.
  Scene scene = only_floor(-5);
  Sky sky;
  sky.kind = SkyKind::cie_overcast;
  sky.horizontal_irradiance = one_band(100);
  scene.sky = sky;
  LightingOptions options;
  options.sky_samples = 1 << 16;
  const double expected = 100 * (pi / 6 + 4.0 / 9) / (7 * pi / 9);
  EXPECT_NEAR(expected, 39.62, 0.005);
  const DirectIrradiance facade = at(scene, {Point(0, 0, 0), Vector::UnitX()}, options);
  EXPECT_NEAR(facade.irradiance(0, 0), expected, 0.1);
  EXPECT_LT(facade.standard_error(0, 0), 0.1);
  EXPECT_NEAR(at(scene, {Point(0, 0, 0), Vector::UnitZ()}, options).irradiance(0, 0), 100, 0.01);
}

TEST(DirectIrradiance, StandardErrorsAreThoseOfTheErrors) {
  // The facade again with few rays and many seeds. Four replicates give the variance of the mean without bias, up to
  // what scrambles that they share correlate; its mean over 100 seeds is known to about 100^-0.5 x (2 / 3)^0.5 = 8 %,
  // and the mean square of 100 errors to 14 %: factors of 0.6 to 1.6 are three standard deviations.
  Scene scene = only_floor(-5);
  Sky sky;
  sky.kind = SkyKind::cie_overcast;
  sky.horizontal_irradiance = one_band(1);
  scene.sky = sky;
  const double expected = (pi / 6 + 4.0 / 9) / (7 * pi / 9);
  double squared_error = 0;
  double variance = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const DirectIrradiance facade = at(scene, {Point(0, 0, 0), Vector::UnitX()}, {.sky_samples = 64, .seed = seed});
    squared_error += std::pow(facade.irradiance(0, 0) - expected, 2);
    variance += std::pow(facade.standard_error(0, 0), 2);
  }
  EXPECT_GT(squared_error, 0);
  EXPECT_NEAR(std::log(squared_error / variance), 0, std::log(1.6));
}

TEST(DirectIrradiance, OfTheSunIsItsCosine) {
  Scene scene = only_floor();
  scene.sun = Sun{Vector(0, 0.6, 0.8), one_band(10)};
  const PatchMesh mesh = fronts(scene, 5);
  const DirectIrradiance direct = direct_irradiance(lighting_of(scene, Tracing(scene)), mesh);
  EXPECT_NEAR((direct.irradiance - 8).abs().maxCoeff(), 0, 1e-12);
  EXPECT_NEAR(direct.standard_error.maxCoeff(), 0, 1e-6);
  EXPECT_EQ(at(scene, {Point(0, 0, 1), -Vector::UnitZ()}).irradiance(0, 0), 0);
}

TEST(DirectIrradiance, OfASunBelowTheHorizonIsNothing) {
  Scene scene = only_floor();
  scene.sun = Sun{Vector(0, 0.6, -0.8), one_band(10)};
  EXPECT_EQ(at(scene, {Point(0, 0, -1), -Vector::UnitZ()}).irradiance(0, 0), 0);
}

// A closed box, and an isotropic luminaire of 1 W/sr that is 5 cm below its ceiling.
Scene box_with_luminaire_at_the_ceiling() {
  Scene scene = with_box(empty_scene({grey(0.5)}), Point(0, 0, 0), Point(4, 5, 3), true);
  Luminaire lamp;
  lamp.position = Point(1.3, 2.1, 2.95);
  lamp.light = PointLight{one_band(1)};
  scene.luminaires = {lamp};
  return scene;
}

double flux_onto(const PatchMesh& mesh, const DirectIrradiance& direct) {
  double flux = 0;
  for (PatchIndex i = 0; i < mesh.size(); ++i) flux += mesh.area[i] * direct.irradiance(i, 0);
  return flux;
}

TEST(DirectIrradiance, OfALuminaireCloseToTheCeilingIsAllOfItsFlux) {
  // Solid angles around a point add up to 4 pi. Nothing is in the way, so that all rays count the same: rounding, for
  // any seed and for the fewest rays.
  const Scene scene = box_with_luminaire_at_the_ceiling();
  const PatchMesh mesh = fronts(scene, 0.7);
  ASSERT_GT(mesh.size(), 150U);
  for (const std::uint64_t seed : {1, 2, 3}) {
    for (const int samples : {4, 64}) {
      const DirectIrradiance direct =
          direct_irradiance(lighting_of(scene, Tracing(scene)), mesh, {.lamp_samples = samples, .seed = seed});
      EXPECT_NEAR(flux_onto(mesh, direct), 4 * pi, 1e-9);
      // The root of what rounding leaves of a variance.
      EXPECT_LT((direct.standard_error / direct.irradiance).maxCoeff(), 1e-6);
    }
  }
}

TEST(DirectIrradiance, OfALuminaireCloseToACoveredPatchIsOfThePartOverWhichNothingLies) {
  // A plate covers a part of the ceiling: both get what they do as one, and the fluxes still add up to 4 pi when the
  // ceiling's irradiance counts for the part of it that is not covered. 1024 rays for the patches which the plate's
  // edges cut: within 1 %.
  Scene scene = box_with_luminaire_at_the_ceiling();
  scene = with_quad(std::move(scene), {Point(1, 1, 3), Point(1, 3, 3), Point(2, 3, 3), Point(2, 1, 3)});
  const KeptSides sides = kept_sides(scene, Sides::front);
  const PatchMesh mesh = tessellate(scene, sides, 10);
  ASSERT_EQ(mesh.size(), 7U);
  const DirectIrradiance direct =
      direct_irradiance(lighting_of(scene, Tracing(scene, find_coverings(scene, sides))), mesh, {.lamp_samples = 1024});
  double flux = flux_onto(mesh, direct);
  for (PatchIndex i = 0; i < 6; ++i) {
    if (mesh.normal[i].z() < -0.5) flux -= 2 * direct.irradiance(i, 0);
  }
  EXPECT_NEAR(flux, 4 * pi, 0.01 * 4 * pi);
}

TEST(DirectIrradiance, OfALuminaireInThePlaneOfAPatchIsNothing) {
  Scene scene = box_with_luminaire_at_the_ceiling();
  scene.luminaires[0].position.z() = 3;
  const PatchMesh mesh = fronts(scene, 0.7);
  const DirectIrradiance direct = direct_irradiance(lighting_of(scene, Tracing(scene)), mesh);
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    if (mesh.normal[i].z() < -0.5) {
      EXPECT_EQ(direct.irradiance(i, 0), 0);
    }
  }
}

TEST(DirectIrradiance, OfThePartOverWhichNothingLies) {
  // A rug over a third of a floor of one patch: the rest has all of the sun's irradiance, and so has its mean.
  Scene scene = with_quad(empty_scene({grey(0.5)}), {Point(0, 0, 0), Point(3, 0, 0), Point(3, 1, 0), Point(0, 1, 0)});
  scene = with_quad(std::move(scene), {Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)});
  scene.sun = Sun{Vector::UnitZ(), one_band(10)};
  const KeptSides sides = kept_sides(scene, Sides::front);
  const PatchMesh mesh = tessellate(scene, sides, 5);
  const DirectIrradiance direct =
      direct_irradiance(lighting_of(scene, Tracing(scene, find_coverings(scene, sides))), mesh);
  ASSERT_EQ(direct.irradiance.rows(), 2);
  EXPECT_NEAR(direct.irradiance(0, 0), 10, 1e-12);
  EXPECT_NEAR(direct.irradiance(1, 0), 10, 1e-12);
}

// A room with a glazed window of 2 x 1 m in its wall at y = 0, which is otherwise four rectangles around it.
Scene room_with_window(double transmittance) {
  Material glass = grey(0.1);
  glass.transmittance = one_band(transmittance);
  Scene scene = empty_scene({grey(0.5), glass});
  const auto on_wall = [](double x0, double x1, double z0, double z1) {
    return Quad{Point(x0, 0, z0), Point(x0, 0, z1), Point(x1, 0, z1), Point(x1, 0, z0)};
  };
  const std::vector<Quad> faces = box_faces(Point(0, 0, 0), Point(4, 5, 3), true);
  for (std::size_t k = 0; k < faces.size(); ++k) {
    if (k != 2) scene = with_quad(std::move(scene), faces[k]);
  }
  scene = with_quad(std::move(scene), on_wall(0, 1, 0, 3));
  scene = with_quad(std::move(scene), on_wall(3, 4, 0, 3));
  scene = with_quad(std::move(scene), on_wall(1, 3, 0, 1));
  scene = with_quad(std::move(scene), on_wall(1, 3, 2, 3));
  return with_quad(std::move(scene), on_wall(1, 3, 1, 2), 1);
}

TEST(DirectIrradiance, OfTheSunThroughAWindowIsTheFluxThatEnters) {
  // Flux = normal irradiance x area x cosine x transmittance at that cosine. Only the patches on the spot's edge are
  // sampled in part: of patches of 1/8 m some 50 of 500, each to about 64^-0.75 / 4 = 1 %, which add up at random to
  // 0.02 %.
  Scene scene = room_with_window(0.8);
  scene.sun = Sun{Vector(0.1, -0.7, 0.5).normalized(), one_band(10)};
  const PatchMesh mesh = fronts(scene, 0.125);
  const DirectIrradiance direct = direct_irradiance(lighting_of(scene, Tracing(scene)), mesh);
  double flux = 0;
  double variance = 0;
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    flux += mesh.area[i] * direct.irradiance(i, 0);
    variance += std::pow(mesh.area[i] * direct.standard_error(i, 0), 2);
  }
  const double cosine = 0.7 / std::sqrt(0.75);
  const double expected = 10 * 2 * cosine * transmittance(pane_of(1.52, 0.8), cosine);
  EXPECT_NEAR(flux, expected, 0.005 * expected);
  EXPECT_LT(std::sqrt(variance), 0.002 * expected);
}

TEST(DirectIrradiance, OfTheSkyThroughAWindowIsItsFormFactor) {
  // A point before the middle of the window, 2 m away, turned to it: E = pi L tau F, F that of a rectangle of 2 x 1 m
  // at that distance: 4 / (2 pi) sum over its quarter a = 1, b = 0.5, c = 2 of a / sqrt(a^2 + c^2) atan(b / sqrt(a^2 +
  // c^2)) and the same with a and b exchanged. The sheet with holes has the same transmittance at all angles.
  Scene scene = room_with_window(0.5);
  scene.materials[1].index = 1;
  Sky sky;
  sky.zenith_radiance = one_band(3);
  sky.ground_radiance = one_band(3);
  scene.sky = sky;
  const auto term = [](double a, double b) {
    const double root = std::hypot(a, 2);
    return a / root * std::atan(b / root);
  };
  const double expected = 3 * pi * 0.5 * 2 / pi * (term(1, 0.5) + term(0.5, 1));
  const DirectIrradiance direct = at(scene, {Point(2, 2, 1.5), -Vector::UnitY()});
  EXPECT_NEAR(direct.irradiance(0, 0), expected, 0.005 * expected);
  EXPECT_NEAR(direct.irradiance(0, 0), expected, 4 * direct.standard_error(0, 0));
  EXPECT_LT(direct.standard_error(0, 0), 0.002 * expected);
}

// The same sky for all: overcast over a grey ground.
Scene under_a_sky(Scene scene) {
  Sky sky;
  sky.kind = SkyKind::cie_overcast;
  sky.horizontal_irradiance = one_band(100);
  sky.ground_radiance = one_band(5);
  scene.sky = sky;
  return scene;
}

// The flux that the patches of the first `polygons` get, and its variance.
struct Flux {
  double watts = 0;
  double variance = 0;
};

Flux flux_of_sky(const Scene& scene, PolygonIndex polygons) {
  const PatchMesh mesh = fronts(scene, 1);
  const DirectIrradiance direct = direct_irradiance(lighting_of(scene, Tracing(scene)), mesh);
  Flux flux;
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    if (mesh.polygon[i] >= polygons) continue;
    flux.watts += mesh.area[i] * direct.irradiance(i, 0);
    flux.variance += std::pow(mesh.area[i] * direct.standard_error(i, 0), 2);
  }
  return flux;
}

TEST(DirectIrradiance, OfTheSkyThroughGlassOfTransmittanceOneIsThatThroughAHole) {
  // Theorem; the two are found by rays of their own. Also with one pane glazed and the other a hole, and with two panes
  // one behind the other, each of which is aimed at. Four standard errors.
  const Scene glass = under_a_sky(room_with_window(1));
  Scene hole = glass;
  hole.polygons.pop_back();
  const auto walls = static_cast<PolygonIndex>(hole.polygons.size());
  const auto pane = [](double x0, double x1, double y) {
    return Quad{Point(x0, y, 1), Point(x0, y, 2), Point(x1, y, 2), Point(x1, y, 1)};
  };
  const Scene half = with_quad(hole, pane(1, 2, 0), 1);
  const Scene doubled = with_quad(glass, pane(0.5, 3.5, -0.1), 1);
  const Flux expected = flux_of_sky(hole, walls);
  EXPECT_GT(expected.watts, 0);
  for (const Scene& scene : {glass, half, doubled}) {
    const Flux flux = flux_of_sky(scene, walls);
    EXPECT_NEAR(flux.watts, expected.watts, 4 * std::sqrt(flux.variance + expected.variance));
  }
  // Holes are aimed at as panes are.
  EXPECT_LT(std::sqrt(expected.variance), 2 * std::sqrt(flux_of_sky(glass, walls).variance));
}

TEST(DirectIrradiance, AddsUpOverLights) {
  Scene scene = with_quad(only_floor(), {Point(-1, -1, 1), Point(1, -1, 1), Point(1, 1, 1), Point(-1, 1, 1)});
  Luminaire point;
  point.position = Point(2, 1, 3);
  point.light = PointLight{one_band(50)};
  Scene with_point = scene;
  with_point.luminaires = {point};
  Scene with_sun = scene;
  with_sun.sun = Sun{Vector(0, 0.6, 0.8), one_band(10)};
  Scene with_both = with_point;
  with_both.sun = with_sun.sun;
  const SurfacePoint here{Point(0.5, 2.5, 0), Vector::UnitZ()};
  EXPECT_NEAR(at(with_both, here).irradiance(0, 0),
              at(with_point, here).irradiance(0, 0) + at(with_sun, here).irradiance(0, 0), 1e-12);
}

// Whether few rays are traced at once or only where something may hide the ball, what hides nothing changes no bit.
TEST(DirectIrradiance, OfABallIsTheSameBesideWhatHidesNothing) {
  Scene scene = only_floor();
  scene.luminaires = {sphere(Point(0, 0, 3), 0.2, 7)};
  const Scene with_board = with_quad(scene, {Point(-1, -1, 4), Point(1, -1, 4), Point(1, 1, 4), Point(-1, 1, 4)});
  const PatchMesh mesh = fronts(scene, 2);
  const PatchMesh beside = fronts(with_board, 2);
  for (const int samples : {4, 16, 20, 64}) {
    const LightingOptions options{.lamp_samples = samples};
    const DirectIrradiance alone = direct_irradiance(lighting_of(scene, Tracing(scene)), mesh, options);
    const DirectIrradiance both = direct_irradiance(lighting_of(with_board, Tracing(with_board)), beside, options);
    const auto patches = static_cast<Eigen::Index>(mesh.size());
    EXPECT_TRUE((both.irradiance.topRows(patches) == alone.irradiance).all()) << samples << " samples";
    EXPECT_GT(alone.irradiance.minCoeff(), 0);
  }
}

// The quarters of a square of 1 m, 3 m below a lamp that stands aside, from one sample each, as the floor's are so much
// larger: with one of its own each quarter is off by what the irradiance varies by inside it; with the same one all are
// off by nearly the same, and their differences by what changes of that between them, a quarter of it and less: the
// squares are a sixteenth, and less than a quarter whatever 64 seeds leave to chance.
TEST(DirectIrradiance, OfQuartersWithTheSameSamplesDiffersByLittleNoise) {
  Scene scene = with_quad(only_floor(-5), {Point(1, 0, 0), Point(2, 0, 0), Point(2, 1, 0), Point(1, 1, 0)});
  scene.luminaires = {sphere(Point(0, 0, 3), 0.2, 7)};
  const PatchMesh quarters = refine(fronts(scene, 100));
  const Lighting lighting = lighting_of(scene, Tracing(scene));
  const Field exact = direct_irradiance(lighting, quarters, {.lamp_samples = 4096}).irradiance.bottomRows(4);
  const auto squares_of_errors = [&](std::uint32_t alike) {
    double sum = 0;
    for (std::uint64_t seed = 1; seed <= 64; ++seed) {
      const LightingOptions options{.lamp_samples = 4, .seed = seed, .alike = alike};
      const Field error = direct_irradiance(lighting, quarters, options).irradiance.bottomRows(4) - exact;
      sum += (error - error.mean()).square().sum();
    }
    return sum;
  };
  EXPECT_LT(squares_of_errors(4), squares_of_errors(1) / 4);
}

// Patches of a room with a window: eight times the samples on every other one leave an eighth of the variance, or less,
// as they are stratified; a quarter with what 16 seeds leave to chance. The others stay the same, to the last bit.
TEST(DirectIrradiance, TakesMoreSamplesWhereTheyAreDoubled) {
  Scene scene = room_with_window(0.5);
  Sky sky;
  sky.zenith_radiance = one_band(3);
  scene.sky = sky;
  const PatchMesh mesh = fronts(scene, 2);
  const Lighting lighting = lighting_of(scene, Tracing(scene));
  const Field exact = direct_irradiance(lighting, mesh, {.sky_samples = 65536}).irradiance;
  std::vector<std::uint8_t> doublings;
  for (PatchIndex i = 0; i < mesh.size(); ++i) doublings.push_back(i % 2 == 0 ? 3 : 0);
  double usual = 0;
  double doubled = 0;
  for (std::uint64_t seed = 1; seed <= 16; ++seed) {
    const Field one = direct_irradiance(lighting, mesh, {.sky_samples = 64, .seed = seed}).irradiance;
    const Field other =
        direct_irradiance(lighting, mesh, {.sky_samples = 64, .seed = seed, .doublings = doublings}).irradiance;
    for (PatchIndex i = 0; i < mesh.size(); ++i) {
      if (doublings[i] == 0) {
        EXPECT_EQ(one(i, 0), other(i, 0));
        continue;
      }
      usual += std::pow(one(i, 0) - exact(i, 0), 2);
      doubled += std::pow(other(i, 0) - exact(i, 0), 2);
    }
  }
  EXPECT_LT(doubled, usual / 4);
}

// As where all light of a mesh is known from the one before.
TEST(DirectIrradiance, OfNoPatchesIsEmpty) {
  Scene scene = room_with_window(0.5);
  Sky sky;
  sky.zenith_radiance = one_band(3);
  scene.sky = sky;
  const PatchMesh all = fronts(scene, 2);
  const PatchMesh none = without_patches(all, std::vector<std::uint8_t>(all.size(), 1));
  const DirectIrradiance direct = direct_irradiance(lighting_of(scene, Tracing(scene)), none, {.usual_area = 1});
  EXPECT_EQ(direct.irradiance.rows(), 0);
  EXPECT_EQ(direct.irradiance.cols(), 1);
}

// Beside a patch with an error of 1 by one ray, one by four rays has half of that at least.
TEST(DirectIrradiance, ComparesErrorsByAsManyRays) {
  Scene scene = only_floor(0);
  const PatchMesh mesh = fronts(scene, 1);
  ASSERT_GT(mesh.size(), 1U);
  const Eigen::VectorXd area = Eigen::Map<const Eigen::VectorXd>(mesh.area.data(), mesh.size());
  std::vector<std::uint8_t> doublings(mesh.size(), 0);
  doublings[0] = 2;
  Field errors = Field::Ones(mesh.size(), 1);
  errors(0, 0) = 0.5;
  EXPECT_LT((with_errors_around(mesh, area, errors, doublings) - errors).abs().maxCoeff(), 1e-15);
  EXPECT_GT(with_errors_around(mesh, area, errors)(0, 0), 0.8);
}

TEST(DirectIrradiance, HasTheSameBitsForAnyNumberOfThreads) {
  Scene scene = room_with_window(0.5);
  Sky sky;
  sky.zenith_radiance = one_band(3);
  scene.sky = sky;
  scene.sun = Sun{Vector(0.1, -0.7, 0.5).normalized(), one_band(10)};
  scene.luminaires = {sphere(Point(1, 2, 2), 0.1, 30)};
  const PatchMesh mesh = fronts(scene, 1);
  const Lighting lighting = lighting_of(scene, Tracing(scene));
  const auto with_threads = [&](int threads) {
    const ThreadLimit limit(threads);
    return direct_irradiance(lighting, mesh, {.sky_samples = 64});
  };
  const DirectIrradiance one = with_threads(1);
  const DirectIrradiance two = with_threads(2);
  EXPECT_TRUE((one.irradiance == two.irradiance).all());
  EXPECT_TRUE((one.standard_error == two.standard_error).all());
  EXPECT_GT(one.irradiance.minCoeff(), 0);
}

TEST(DirectIrradiance, OfAMeasuredLuminaireFollowsItsAimAndTilt) {
  // 10 cd along the aim, 4 at 90 degrees from it in the 0 degree plane, 0 across; 0.5 of it when tilted by 90 degrees.
  auto web = std::make_shared<PhotometricWeb>();
  web->vertical = {0, 90};
  web->horizontal = {0, 90};
  web->candela = {10, 4, 10, 0};
  web->tilt = {0, 90};
  web->tilt_factor = {1, 0.5};
  Luminaire lamp;
  lamp.position = Point(0, 0, 2);
  lamp.light = WebLight{web, one_band(0.25)};
  Scene scene = only_floor(-5);
  scene.luminaires = {lamp};
  EXPECT_NEAR(at(scene, {Point(0, 0, 0), Vector::UnitZ()}).irradiance(0, 0), 0.25 * 10 / 4, 1e-12);
  EXPECT_NEAR(at(scene, {Point(2, 0, 2), -Vector::UnitX()}).irradiance(0, 0), 0.25 * 4 / 4, 1e-12);
  EXPECT_NEAR(at(scene, {Point(0, 2, 2), -Vector::UnitY()}).irradiance(0, 0), 0, 1e-12);
  // Aimed at x, the 0 degree plane across: along y there are 4 cd, half of them when tilted so far.
  scene.luminaires[0].aim = Vector::UnitX();
  scene.luminaires[0].zero_plane = Vector::UnitY();
  EXPECT_NEAR(at(scene, {Point(2, 0, 2), -Vector::UnitX()}).irradiance(0, 0), 0.5 * 0.25 * 10 / 4, 1e-12);
  EXPECT_NEAR(at(scene, {Point(0, 2, 2), -Vector::UnitY()}).irradiance(0, 0), 0.5 * 0.25 * 4 / 4, 1e-12);
}

TEST(DirectIrradiance, OfAPointInsideALampIsNothing) {
  Scene scene = only_floor();
  scene.luminaires = {sphere(Point(0, 0, 1), 0.5, 30)};
  EXPECT_EQ(at(scene, {Point(0, 0, 1.2), Vector::UnitZ()}).irradiance(0, 0), 0);
}

}  // namespace
}  // namespace patchlight::direct_irradiance_test
