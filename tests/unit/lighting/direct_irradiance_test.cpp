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

// A floor of 20 x 20 m, front side up. Unless a test states otherwise, it is black and far below the tested points.
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
  // E = M (r / d)^2 cos theta. The cosine is smooth in the square of the samples. 64 Owen-scrambled points leave about
  // 64^-1.5 = 2e-3 of its variation, which is a third of its mean here.
  Scene scene = only_floor(-5);
  scene.luminaires = {sphere(Point(0, 1, 2), 0.5, 7)};
  const DirectIrradiance direct = at(scene, {Point(0, 0, 0), Vector::UnitZ()});
  const double expected = 7 * 0.25 / 5 * 2 / std::sqrt(5.0);
  EXPECT_NEAR(direct.irradiance(0, 0), expected, 0.005 * expected);
  EXPECT_LT(direct.standard_error(0, 0), 0.005 * expected);
}

TEST(DirectIrradiance, OfASphereThatTheHorizonCutsDiffersByTheVectorIrradiance) {
  // The irradiances of both sides of a plane differ by M (r / d)^2 cos theta at any position of the sphere. Both sides
  // see it here, because cos theta = 0.1 < r / d = 0.5.
  Scene scene = only_floor(-5);
  const double distance = 2;
  scene.luminaires = {sphere(Point(distance * std::sqrt(0.99), 0, distance * 0.1), 1, 7)};
  LightingOptions options;
  options.luminaire_samples = 4096;
  const double above = at(scene, {Point(0, 0, 0), Vector::UnitZ()}, options).irradiance(0, 0);
  const double below = at(scene, {Point(0, 0, 0), -Vector::UnitZ()}, options).irradiance(0, 0);
  EXPECT_GT(below, 0);
  EXPECT_NEAR(above - below, 7 * 0.25 * 0.1, 0.005 * 7 * 0.25 * 0.1);
}

// A point 0.3 m below the middle of a lamp of 0.15 m, partly hidden by a plate: estimates of its irradiance by 16 rays,
// over many scrambles.
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
      const LightSample arrival = LightSource(lamp, scene.up).sample({Point(0, 0, 0), Vector::UnitZ()}, {u, v});
      by_solid_angle += arrival.irradiance * arriving(arrival.from) / samples;
      // Uniform over the sphere: E = M / pi x area x the mean of cos cos' / d^2 over the sphere's points that face the
      // receiver.
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
  // Both have the same mean, a part of M (r / d)^2 = 0.25, within three standard errors of the mean of 200.
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
  // The same for a patch of the floor that sees only the sky.
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
  // The facade again with few rays and many seeds. Four replicates give the variance of the mean without bias, apart
  // from correlations of the scrambles that they share. Its mean over 100 seeds is known to about 100^-0.5 x (2 /
  // 3)^0.5 = 8 %, and the mean square of 100 errors to 14 %. Factors of 0.6 to 1.6 are three standard deviations.
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
  // Solid angles around a point add up to 4 pi. Nothing blocks the light, so all rays have the same weight. Only
  // rounding remains, for any seed and for the fewest rays.
  const Scene scene = box_with_luminaire_at_the_ceiling();
  const PatchMesh mesh = fronts(scene, 0.7);
  ASSERT_GT(mesh.size(), 150U);
  for (const std::uint64_t seed : {1, 2, 3}) {
    for (const int samples : {4, 64}) {
      const DirectIrradiance direct =
          direct_irradiance(lighting_of(scene, Tracing(scene)), mesh, {.luminaire_samples = samples, .seed = seed});
      EXPECT_NEAR(flux_onto(mesh, direct), 4 * pi, 1e-9);
      // The root of the rounding error of a variance.
      EXPECT_LT((direct.standard_error / direct.irradiance).maxCoeff(), 1e-6);
    }
  }
}

TEST(DirectIrradiance, OfALuminaireCloseToACoveredPatchIsOfThePartOverWhichNothingLies) {
  // A plate covers a part of the ceiling. Together they receive the same light as the ceiling alone. The fluxes still
  // add up to 4 pi if only the uncovered part of the ceiling counts. 1024 rays for the patches cut by the plate's
  // edges: within 1 %.
  Scene scene = box_with_luminaire_at_the_ceiling();
  scene = with_quad(std::move(scene), {Point(1, 1, 3), Point(1, 3, 3), Point(2, 3, 3), Point(2, 1, 3)});
  const KeptSides sides = kept_sides(scene, Sides::front);
  const PatchMesh mesh = tessellate(scene, sides, 10);
  ASSERT_EQ(mesh.size(), 7U);
  const DirectIrradiance direct = direct_irradiance(lighting_of(scene, Tracing(scene, find_coverings(scene, sides))),
                                                    mesh, {.luminaire_samples = 1024});
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
  // A rug covers a third of a floor of one patch. The rest receives all of the sun's irradiance, so its mean is the
  // same.
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

// A room with a glazed window of 2 x 1 m in its wall at y = 0, which consists of four rectangles around it.
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
  // Flux = normal irradiance x area x cosine x transmittance at that cosine. Only patches on the spot's edge are partly
  // sampled: about 50 of 500 patches of 1/8 m. Each is known to about 64^-0.75 / 4 = 1 %. These errors add up at random
  // to 0.02 %.
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
  // A point 2 m before the middle of the window, facing it: E = pi L tau F. F is that of a rectangle of 2 x 1 m at that
  // distance. Its quarter has a = 1, b = 0.5, c = 2. F is 4 / (2 pi) times a / sqrt(a^2 + c^2) atan(b / sqrt(a^2 +
  // c^2)) plus the same with a and b exchanged. The sheet with holes has the same transmittance at all angles.
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

// The same sky for all: overcast over a gray ground.
Scene under_a_sky(Scene scene) {
  Sky sky;
  sky.kind = SkyKind::cie_overcast;
  sky.horizontal_irradiance = one_band(100);
  sky.ground_radiance = one_band(5);
  scene.sky = sky;
  return scene;
}

// The flux onto the patches of the first `polygons`, and its variance.
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
  // Theorem: a clear pane is equivalent to a hole. Both use rays of their own. Further cases have one pane glazed and
  // the other a hole, and two panes one behind the other. Rays are aimed at each of them. Four standard errors.
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
  // Rays are aimed at holes as at panes.
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

// Faces that hide nothing change no bit, whether a few rays are traced at once or only where something may hide the
// ball.
TEST(DirectIrradiance, OfABallIsTheSameBesideWhatHidesNothing) {
  Scene scene = only_floor();
  scene.luminaires = {sphere(Point(0, 0, 3), 0.2, 7)};
  const Scene with_board = with_quad(scene, {Point(-1, -1, 4), Point(1, -1, 4), Point(1, 1, 4), Point(-1, 1, 4)});
  const PatchMesh mesh = fronts(scene, 2);
  const PatchMesh beside = fronts(with_board, 2);
  for (const int samples : {4, 16, 20, 64}) {
    const LightingOptions options{.luminaire_samples = samples};
    const DirectIrradiance alone = direct_irradiance(lighting_of(scene, Tracing(scene)), mesh, options);
    const DirectIrradiance both = direct_irradiance(lighting_of(with_board, Tracing(with_board)), beside, options);
    const auto patches = static_cast<Eigen::Index>(mesh.size());
    EXPECT_TRUE((both.irradiance.topRows(patches) == alone.irradiance).all()) << samples << " samples";
    EXPECT_GT(alone.irradiance.minCoeff(), 0);
  }
}

// The quarters of a square of 1 m, 3 m below a lamp to the side. The floor is so much larger that each has one sample.
// With its own sample, the error of each quarter is the variation of the irradiance within it. With a common sample all
// errors are nearly equal, and their differences are a quarter or less. So their squares are a sixteenth. The limit of
// a quarter allows for the scatter of 64 seeds.
TEST(DirectIrradiance, OfQuartersWithTheSameSamplesDiffersByLittleNoise) {
  Scene scene = with_quad(only_floor(-5), {Point(1, 0, 0), Point(2, 0, 0), Point(2, 1, 0), Point(1, 1, 0)});
  scene.luminaires = {sphere(Point(0, 0, 3), 0.2, 7)};
  const PatchMesh quarters = refine(fronts(scene, 100));
  const Lighting lighting = lighting_of(scene, Tracing(scene));
  const Field exact = direct_irradiance(lighting, quarters, {.luminaire_samples = 4096}).irradiance.bottomRows(4);
  const auto squares_of_errors = [&](std::uint32_t alike) {
    double sum = 0;
    for (std::uint64_t seed = 1; seed <= 64; ++seed) {
      const LightingOptions options{.luminaire_samples = 4, .seed = seed, .alike = alike};
      const Field error = direct_irradiance(lighting, quarters, options).irradiance.bottomRows(4) - exact;
      sum += (error - error.mean()).square().sum();
    }
    return sum;
  };
  EXPECT_LT(squares_of_errors(4), squares_of_errors(1) / 4);
}

// Patches of a room with a window. Eight times the samples on every other patch leave an eighth of the variance or
// less, because they are stratified: a quarter within the scatter of 16 seeds. The other patches keep every bit.
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

// The case in which all light of a mesh is known from the previous one.
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

// Beside a patch with an error of 1 by one ray, the error of one by four rays is at least half of that.
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
  // 10 cd along the aim, 4 at 90 degrees from it in the 0 degree plane, and 0 across; half of that at a tilt of 90
  // degrees.
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
  // Aimed at x, with the 0 degree plane across: 4 cd along y, and half of that at this tilt.
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
