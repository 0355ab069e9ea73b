#include "patchlight/gather/gather.h"

#include "patchlight/gather/readings.h"
#include "patchlight/scene/sides.h"

#include "form_factor/point_polygon.h"
#include "gather/doubtful_sensors.h"
#include "gather/sensor_places.h"
#include "lighting/light_paths.h"
#include "lighting/mirror_paths.h"
#include "mesh/mesher.h"
#include "scene/sensor_grid.h"
#include "support/scenes.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <numbers>
#include <string>
#include <vector>

namespace patchlight::gather_test {
namespace {

using namespace test;

PatchMesh fronts(const Scene& scene, double max_edge) {
  return tessellate(scene, kept_sides(scene, Sides::front), max_edge);
}

TEST(GatherIrradiance, InAClosedRoomOfUnitRadiosityIsOneAnywhereInAnyDirection) {
  // The closed-form form factors from a point to all patches add up to 1, to rounding.
  const Scene scene = cube_room(0.5, 0.5);
  const PatchMesh mesh = fronts(scene, 0.3);
  const Field ones = Field::Ones(mesh.size(), 1);
  const std::vector<Sensor> sensors{{Point(0.5, 0.5, 0.5), Vector::UnitZ()},
                                    {Point(0.1, 0.9, 0.3), Vector(1, -2, 0.5).normalized()},
                                    {Point(0.4, 0.3, 0), Vector::UnitZ()}};
  const Field irradiance = gather_irradiance(mesh, ones, Occluder(scene), sensors).irradiance;
  EXPECT_LT((irradiance - 1).abs().maxCoeff(), 1e-12);
}

TEST(GatherIrradiance, BelowALampFollowsLambert) {
  // A plate hides half of the lamp. Its edge lies below the lamp's middle, so by symmetry half of the closed form
  // remains.
  Scene scene = empty_scene({grey(0), grey(0, 7)});
  scene = with_quad(std::move(scene), {Point(-1, -1, 0), Point(1, -1, 0), Point(1, 1, 0), Point(-1, 1, 0)});
  scene = with_quad(std::move(scene), {Point(-.2, -.2, 1), Point(-.2, .2, 1), Point(.2, .2, 1), Point(.2, -.2, 1)}, 1);
  scene = with_quad(std::move(scene), {Point(0, -.5, .5), Point(0, .5, .5), Point(.5, .5, .5), Point(.5, -.5, .5)});
  const PatchMesh mesh = fronts(scene, 10);
  Field exitance = Field::Zero(mesh.size(), 1);
  exitance(1, 0) = 7;
  const std::vector<Sensor> sensors{{Point(0, 0, 0), Vector::UnitZ()}};
  const double root = std::sqrt(1.04);
  const double whole = 7 * 4 / std::numbers::pi * 0.2 / root * std::atan(0.2 / root);
  const Field irradiance = gather_irradiance(mesh, exitance, Occluder(scene), sensors).irradiance;
  // Eight sets of 1024 Owen-scrambled points, each of which resolves a straight edge to about 1 / sqrt(1024) / 10.
  EXPECT_NEAR(irradiance(0, 0), 0.5 * whole, 0.003 * whole);
}

// The scene of the previous test with the plate rotated by 20 degrees, so that no line of sampling points is parallel
// to its edge. Over many seeds the errors match the standard errors. These come from the scatter of eight independent
// replicates, whose variance has no bias.
TEST(GatherIrradiance, StandardErrorIsThatOfTheShadowRays) {
  Scene scene = empty_scene({grey(0), grey(0, 7)});
  scene = with_quad(std::move(scene), {Point(-.2, -.2, 1), Point(-.2, .2, 1), Point(.2, .2, 1), Point(.2, -.2, 1)}, 1);
  Scene plate =
      with_quad(empty_scene({grey(0)}), {Point(0, -.5, .5), Point(0, .5, .5), Point(.5, .5, .5), Point(.5, -.5, .5)});
  plate = moved(std::move(plate), Eigen::Affine3d(Eigen::AngleAxisd(std::numbers::pi / 9, Vector::UnitZ())));
  for (const Point& corner : plate.vertices) scene.vertices.push_back(corner);
  scene.polygons.push_back({{4, 5, 6, 7}});
  const PatchMesh mesh = fronts(scene, 10);
  Field exitance = Field::Zero(mesh.size(), 1);
  exitance(0, 0) = 7;
  const Occluder occluder(scene, Occluder::Blockers::all);
  const std::vector<Sensor> sensors{{Point(0, 0, 0), Vector::UnitZ()}};
  // The plate hides half of the lamp by symmetry, at any rotation.
  const double root = std::sqrt(1.04);
  const double half = 0.5 * 7 * 4 / std::numbers::pi * 0.2 / root * std::atan(0.2 / root);
  double squared_errors = 0, variances = 0;
  constexpr int seeds = 400;
  for (int seed = 1; seed <= seeds; ++seed) {
    GatherOptions options;
    options.seed = static_cast<std::uint64_t>(seed);
    const GatheredIrradiance found = gather_irradiance(mesh, exitance, occluder, sensors, options);
    squared_errors += std::pow(found.irradiance(0, 0) - half, 2);
    variances += std::pow(found.errors.rays(0, 0), 2);
  }
  const double ratio = std::sqrt(variances / squared_errors);
  EXPECT_GT(ratio, 0.85) << "the error bars are too short";  // 400 seeds: 4 % statistical error
  EXPECT_LT(ratio, 1.15) << "the error bars are too long";
}

// A grid of sensors in a room with a box and a lamp, compared with many more rays.
TEST(GatherIrradiance, StandardErrorsHoldInAFurnishedRoom) {
  const Scene scene = furnished_room(0.5, 10);
  const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::automatic), 0.3);
  Field exitance = Field::Zero(mesh.size(), 1);
  for (PatchIndex i = 0; i < mesh.size(); ++i) exitance(i, 0) = mesh.material[i] == 1 ? 10 : 0;
  const Field radiosity = exitance + 0.5;
  const SensorGroup grid = rectangle_grid(Point(0, 0, 0.3), {Vector(4, 0, 0), Vector(0, 3, 0)}, 0.25);
  const Occluder occluder(scene, Occluder::Blockers::all);
  const GatheredIrradiance found = gather_irradiance(mesh, radiosity, occluder, grid.sensors);
  const GatherOptions many{.least_rays = 32, .rays = 1 << 16, .seed = 2};
  const GatheredIrradiance exact = gather_irradiance(mesh, radiosity, occluder, grid.sensors, many);
  const Field error = (found.irradiance - exact.irradiance).abs();
  const double ratio = found.errors.rays.matrix().norm() / error.matrix().norm();
  EXPECT_GT(ratio, 0.6) << "the error bars are too short";
  EXPECT_LT(ratio, 1.6) << "the error bars are too long";
  const auto outside = (error > 3 * found.errors.rays + 1e-9).count();
  EXPECT_LE(outside, static_cast<Eigen::Index>(grid.sensors.size() / 20)) << "of " << grid.sensors.size();
}

// A furnished room of two bands with a colored pane across it, light that varies over its patches, and their errors.
struct DividedRoom {
  Scene scene = furnished_room(0.5, 10);
  PatchMesh mesh;
  Field radiosity;
  GatherOptions options;
};

DividedRoom divided_room() {
  DividedRoom room;
  for (Material& material : room.scene.materials) {
    material.reflectance = Spectrum::Constant(2, material.reflectance[0]);
    material.exitance = Spectrum::Constant(2, material.exitance[0]);
  }
  Material pane = room.scene.materials[0];
  pane.reflectance = Spectrum::Zero(2);
  pane.transmittance = Eigen::Array2d(0.9, 0.3).transpose();
  room.scene.materials.push_back(pane);
  room.scene =
      with_quad(std::move(room.scene), {Point(2.2, 0, 0), Point(2.2, 3, 0), Point(2.2, 3, 2.5), Point(2.2, 0, 2.5)}, 2);
  room.mesh = tessellate(room.scene, kept_sides(room.scene, Sides::automatic), 0.15);
  const PatchMesh& mesh = room.mesh;
  room.radiosity = Field::Zero(mesh.size(), 2);
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    if (mesh.material[i] == 2) continue;
    const Point& at = mesh.centroid[i];
    room.radiosity.row(i) = mesh.material[i] == 1
                                ? Spectrum(Spectrum::Constant(2, 10))
                                : Spectrum(Eigen::Array2d(1 + 0.3 * at.x(), 2 - 0.5 * at.z()).transpose());
  }
  room.options.errors = {.sampling = 0.1 * room.radiosity,
                         .correlated = {0.05 * room.radiosity, -0.05 * room.radiosity},
                         .mesh = 0.02 * room.radiosity,
                         .solver = 0.01 * room.radiosity,
                         .display = 0.1 * room.radiosity,
                         .reflected = {}};
  return room;
}

// The mean of values, and how many of its standard errors it is off.
double standard_errors_off(const std::vector<double>& values, double expected) {
  double sum = 0, squares = 0;
  for (const double value : values) {
    sum += value;
    squares += value * value;
  }
  const auto count = static_cast<double>(values.size());
  const double mean = sum / count;
  return (mean - expected) / std::sqrt((squares / count - mean * mean) / (count - 1));
}

// Light and errors by rays over the hemisphere agree with those by shadow rays to every patch. The variances of 165
// sensors with seven degrees of freedom each give the root mean square of their differences to about 7 %. The errors of
// the solver and of sampling have no bias: their ratios over eight seeds have a mean of 1. Student's t with seven
// degrees of freedom exceeds 6 once in 2,000 draws. The hidden ends of patches are squared, so that their noise makes
// this part slightly larger. An error bar has two digits, so that 1 % more does not count.
TEST(GatherIrradiance, ByTheHemisphereAgreesWithShadowRaysToEveryPatch) {
  DividedRoom room = divided_room();
  ASSERT_GT(room.options.least_rays * static_cast<int>(room.mesh.size()), room.options.rays);
  const Tracing tracing(room.scene, {}, Occluder::Blockers::all);
  const LightPaths paths(room.scene, tracing);
  room.options.paths = &paths;
  const SensorGroup grid = rectangle_grid(Point(0, 0, 0.3), {Vector(4, 0, 0), Vector(0, 3, 0)}, 0.25);
  const auto gathered = [&](const GatherOptions& options) {
    return gather_irradiance(room.mesh, room.radiosity, tracing.all_faces(), grid.sensors, options);
  };
  GatherOptions all = room.options;
  all.rays = 16 * static_cast<int>(room.mesh.size());
  const GatheredIrradiance exact = gathered(all);
  std::vector<double> solver, sampling, mesh;
  const auto ratio = [](const Field& a, const Field& b) { return std::sqrt(a.square().sum() / b.square().sum()); };
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    GatherOptions options = room.options;
    options.seed = seed;
    const GatheredIrradiance found = gathered(options);
    const Field variance = found.errors.rays.square() + exact.errors.rays.square();
    const Field z = (found.irradiance - exact.irradiance) / variance.sqrt();
    EXPECT_GT(found.errors.rays.sum(), exact.errors.rays.sum()) << "both took the same rays";
    EXPECT_LT(std::sqrt(z.square().mean()), 1.3);
    EXPECT_LT(std::abs(z.mean()), 3.5 / std::sqrt(static_cast<double>(z.rows())));
    solver.push_back(ratio(found.errors.solver, exact.errors.solver));
    sampling.push_back(ratio(found.errors.sampling, exact.errors.sampling));
    mesh.push_back(ratio(found.errors.mesh, exact.errors.mesh));
  }
  EXPECT_LT(std::abs(standard_errors_off(solver, 1)), 6);
  EXPECT_LT(std::abs(standard_errors_off(sampling, 1)), 6);
  for (const double one : mesh) EXPECT_NEAR(one, 1, 0.01);
}

// A sensor sees one uncertain patch directly and in a mirror without losses. Its image has a form factor as well, and
// the error of the patch counts with the sum of both.
TEST(SensorErrors, OfAPatchThatIsSeenInAMirrorAsWellAddUp) {
  const Quad lamp{Point(0.3, 0.3, 1), Point(0.3, 0.7, 1), Point(0.7, 0.7, 1), Point(0.7, 0.3, 1)};
  Scene scene = with_quad(empty_scene({grey(0.5), grey(0)}), lamp);
  scene.materials[1].specular_reflectance = Spectrum::Ones(scene.materials[0].reflectance.size());
  scene = with_quad(std::move(scene), {Point(-9, 0, -9), Point(-9, 0, 9), Point(9, 0, 9), Point(9, 0, -9)}, 1);
  const Occluder occluder(scene, Occluder::Blockers::all, {}, Reflections::followed);
  const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), 20);
  Field radiosity = Field::Zero(mesh.size(), occluder.optics().bands());
  for (PatchIndex i = 0; i < mesh.size(); ++i)
    if (mesh.polygon[i] == 0) radiosity.row(i).setOnes();
  const SpecularAim aim(scene, occluder.optics());
  GatherOptions options{.slopes = false, .aim = &aim};
  options.errors.sampling = 0.1 * radiosity;
  const std::vector<Sensor> sensors{{Point(0.5, 0.4, 0), Vector::UnitZ()}};
  const GatheredIrradiance found = gather_irradiance(mesh, radiosity, occluder, sensors, options);
  Quad image = lamp;
  for (Point& corner : image) corner.y() *= -1;
  std::reverse(image.begin(), image.end());
  const double expected = point_to_polygon(sensors[0].point, sensors[0].normal, lamp) +
                          point_to_polygon(sensors[0].point, sensors[0].normal, image);
  EXPECT_NEAR(found.irradiance(0, 0), expected, 5 * found.errors.rays(0, 0));
  EXPECT_LT(found.errors.rays(0, 0), 0.02 * expected);
  EXPECT_NEAR(found.errors.sampling(0, 0), 0.1 * expected, 0.1 * 5 * found.errors.rays(0, 0));
}

// Each of more than a thousand patches: rays that all meet the same radiosity have no scatter.
TEST(GatherIrradiance, InAFineClosedRoomOfUnitRadiosityIsOne) {
  const Scene scene = cube_room(0.5, 0.5);
  const PatchMesh mesh = fronts(scene, 0.05);
  const std::vector<Sensor> sensors{{Point(0.1, 0.9, 0.3), Vector(1, -2, 0.5).normalized()},
                                    {Point(0.4, 0.3, 0), Vector::UnitZ()}};
  const Occluder occluder(scene, Occluder::Blockers::all);
  const GatheredIrradiance found = gather_irradiance(mesh, Field::Ones(mesh.size(), 1), occluder, sensors);
  EXPECT_LT((found.irradiance - 1).abs().maxCoeff(), 1e-12);
  EXPECT_LT(found.errors.rays.maxCoeff(), 1e-12);
}

// A sensor on the floor of a box below a board of this depth. The patches above a height have a radiosity of 1.
struct UnderABoard {
  Scene scene;
  PatchMesh mesh;
  Field radiosity;
  std::vector<Sensor> sensors{{Point(0.5, 0.5, 0.01), Vector::UnitZ()}};

  UnderABoard(double depth, double height)
      : scene(with_quad(cube_room(0, 0),
                        {Point(0, 0, 0.5), Point(1, 0, 0.5), Point(1, depth, 0.5), Point(0, depth, 0.5)})),
        mesh(fronts(scene, 0.025)),
        radiosity(Field::Zero(mesh.size(), 1)) {
    for (PatchIndex i = 0; i < mesh.size(); ++i) radiosity(i, 0) = mesh.centroid[i].z() > height ? 1 : 0;
  }
};

// Of many bright patches some are chosen at random. Over 40 seeds the errors have no sign and the stated size, which is
// known to 1 / sqrt(2 x 40) = 11 %.
TEST(GatherIrradiance, OfManyBrightPatchesIsThatOfAll) {
  const auto [scene, mesh, radiosity, sensors] = UnderABoard(0.97, 0.51);
  const Quad slit{Point(0, 0.97, 0.5), Point(0, 1, 0.5), Point(1, 1, 0.5), Point(1, 0.97, 0.5)};
  const double exact = point_to_polygon(sensors[0].point, sensors[0].normal, slit);
  const Occluder occluder(scene, Occluder::Blockers::all);
  constexpr int seeds = 40;
  double sum = 0, squares = 0;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const GatherOptions options{.wanted_error = 1, .seed = seed, .slopes = false};
    const GatheredIrradiance found = gather_irradiance(mesh, radiosity, occluder, sensors, options);
    const double z = (found.irradiance(0, 0) - exact) / found.errors.rays(0, 0);
    sum += z;
    squares += z * z;
  }
  EXPECT_LT(std::abs(sum / seeds), 3 / std::sqrt(seeds));
  EXPECT_LT(std::sqrt(squares / seeds), 1.3);
}

TEST(GatherIrradiance, OfBrightPatchesThatOneWallHidesIsZeroWithoutError) {
  // The upper patches lie before the sensor, but the board hides each of them.
  const auto [scene, mesh, radiosity, sensors] = UnderABoard(1, 0.55);
  const Occluder occluder(scene, Occluder::Blockers::all);
  const GatheredIrradiance found = gather_irradiance(mesh, radiosity, occluder, sensors, {.slopes = false});
  EXPECT_EQ(found.irradiance(0, 0), 0);
  EXPECT_EQ(found.errors.rays(0, 0), 0);
}

// Light that is known otherwise decides the number of rays alone: it is not added, and rays are as many as leave a
// hundredth of all light, or a seventh of its error.
TEST(GatherIrradiance, TakesNoRaysBelowTheErrorsOfOtherLight) {
  const auto [scene, mesh, radiosity, sensors] = UnderABoard(0.97, 0.51);
  const Occluder occluder(scene, Occluder::Blockers::all);
  const auto with = [&](double mean, double error) {
    const OtherIrradiance other{Field::Constant(1, 1, mean), Field::Constant(1, 1, error)};
    return gather_irradiance(mesh, radiosity, occluder, sensors,
                             {.rays = 64, .wanted_error = 0.002, .slopes = false, .other = &other});
  };
  const GatheredIrradiance alone = with(0, 0);
  const double light = alone.irradiance(0, 0);
  ASSERT_GT(light, 0);
  for (const GatheredIrradiance& found : {with(1000 * light, 0), with(0, light)}) {
    EXPECT_GT(found.errors.rays(0, 0), 2 * alone.errors.rays(0, 0));
    EXPECT_NEAR(found.irradiance(0, 0), light, 4 * std::hypot(found.errors.rays(0, 0), alone.errors.rays(0, 0)));
  }
}

TEST(GatherIrradiance, SeesNothingThroughTheFloor) {
  const Scene scene = cube_room(0.5, 0.5);
  const PatchMesh mesh = fronts(scene, 0.5);
  const Field ones = Field::Ones(mesh.size(), 1);
  const std::vector<Sensor> below{{Point(0.5, 0.5, -0.5), Vector::UnitZ()}, {Point(0.5, 0.5, 0), -Vector::UnitZ()}};
  const Occluder occluder(scene, Occluder::Blockers::all);
  const Field irradiance = gather_irradiance(mesh, ones, occluder, below).irradiance;
  EXPECT_EQ(irradiance(0, 0), 0);
  EXPECT_EQ(irradiance(1, 0), 0);
}

TEST(SensorErrors, AreGatheredAsTheLightOfThePatchesIs) {
  // In a closed room of unit radiosity the form factors of all patches add up to 1. So do errors of one sign.
  // Independent errors add up to less.
  const Scene scene = cube_room(0.5, 0.5);
  const PatchMesh mesh = fronts(scene, 0.2);
  const Field ones = Field::Ones(mesh.size(), 1);
  GatherOptions options;
  options.errors = {.sampling = 0.1 * ones, .mesh = 0.2 * ones, .solver = 0.3 * ones, .display = {}, .reflected = ones};
  const std::vector<Sensor> sensors{{Point(0.5, 0.5, 0.5), Vector::UnitZ()}};
  const SensorErrors errors = gather_irradiance(mesh, ones, Occluder(scene), sensors, options).errors;
  EXPECT_NEAR(errors.mesh(0, 0), 0.2, 1e-9);
  EXPECT_NEAR(errors.solver(0, 0), 0.3, 1e-9);
  EXPECT_GT(errors.sampling(0, 0), 0.001);
  EXPECT_LT(errors.sampling(0, 0), 0.03);
  EXPECT_NEAR(errors.total()(0, 0), std::sqrt((errors.rays.square() + errors.sampling.square()).value() + 0.13), 1e-9);
}

// A sampling error that all patches share does not average out: each of two draws is the level of the room.
TEST(SensorErrors, HaveTheLevelThatPatchesShare) {
  const Scene scene = cube_room(0.5, 0.5);
  const PatchMesh mesh = fronts(scene, 0.2);
  const Field ones = Field::Ones(mesh.size(), 1);
  GatherOptions options;
  options.errors = {.sampling = {},
                    .correlated = {0.1 * ones, -0.1 * ones},
                    .mesh = {},
                    .solver = {},
                    .display = {},
                    .reflected = {}};
  const std::vector<Sensor> sensors{{Point(0.5, 0.5, 0.5), Vector::UnitZ()}};
  const SensorErrors errors = gather_irradiance(mesh, ones, Occluder(scene), sensors, options).errors;
  EXPECT_NEAR(errors.sampling(0, 0), 0.1, 1e-9);
}

// A sheet hides half of a floor whose radiosity increases to one side. Rays find the visible part of each patch. Over
// many seeds the readings scatter by the stated error: the variance of 200 is known to about 10 %, the mean variance of
// eight replicates to 4 %.
TEST(GatherIrradiance, OfPlanesThatAreHiddenInPartScattersAsItStates) {
  Scene scene = with_quad(empty_scene({grey(0)}), {Point(-2, -2, 0), Point(2, -2, 0), Point(2, 2, 0), Point(-2, 2, 0)});
  const PatchMesh mesh = fronts(scene, 1);
  Field radiosity(mesh.size(), 1);
  for (PatchIndex i = 0; i < mesh.size(); ++i) radiosity(i, 0) = 2 + mesh.centroid[i].x();
  scene = with_quad(std::move(scene), {Point(-1.4, -3, .3), Point(3, -3, .3), Point(3, 3, .3), Point(-1.7, 3, .3)});
  const Occluder occluder(scene, Occluder::Blockers::all);
  const std::vector<Sensor> sensors{{Point(-1.5, 0.2, 0.6), -Vector::UnitZ()}};
  constexpr int seeds = 200;
  double sum = 0, squares = 0, stated = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    const GatherOptions options{.rays = 256, .wanted_error = 1, .seed = static_cast<std::uint64_t>(seed)};
    const GatheredIrradiance found = gather_irradiance(mesh, radiosity, occluder, sensors, options);
    sum += found.irradiance(0, 0);
    squares += std::pow(found.irradiance(0, 0), 2);
    stated += std::pow(found.errors.rays(0, 0), 2);
  }
  const double variance = (squares - sum * sum / seeds) / (seeds - 1);
  EXPECT_GT(variance, 0.5 * stated / seeds);
  EXPECT_LT(variance, 1.3 * stated / seeds);
}

// A floor of 4 x 4 m whose radiosity decreases towards its middle, as means over the patches, in two units. The errors
// of patches of 5 cm are a hundredth of those of 50 cm, so they are the reference.
TEST(SensorErrors, CoverWhatThePatchesLeaveOfTheLight) {
  for (const double scale : {1.0, 1e-3}) {
    Scene scene =
        with_quad(empty_scene({grey(0)}), {Point(-2, -2, 0), Point(2, -2, 0), Point(2, 2, 0), Point(-2, 2, 0)});
    scene = moved(std::move(scene), Eigen::Affine3d(Eigen::Scaling(scale)));
    const auto light_on = [&](const PatchMesh& mesh) {
      Field radiosity(mesh.size(), 1);
      for (PatchIndex i = 0; i < mesh.size(); ++i) radiosity(i, 0) = std::abs(mesh.centroid[i].x() / scale);
      return radiosity;
    };
    std::vector<Sensor> sensors;
    for (double x = -1.9; x < 2; x += 0.17) {
      for (const double z : {0.2, 0.5, 1.0}) sensors.push_back({scale * Point(x, 0.1, z), -Vector::UnitZ()});
    }
    const Occluder occluder(scene, Occluder::Blockers::all);
    const PatchMesh coarse = fronts(scene, 0.5 * scale);
    const PatchMesh fine = fronts(scene, 0.05 * scale);
    const GatheredIrradiance found = gather_irradiance(coarse, light_on(coarse), occluder, sensors);
    const GatherOptions to_every_patch{.rays = 4 * static_cast<int>(fine.size())};
    const GatheredIrradiance exact = gather_irradiance(fine, light_on(fine), occluder, sensors, to_every_patch);
    const Field error = (found.irradiance - exact.irradiance).abs();
    const auto outside = (error > 2.6 * found.errors.total()).count();
    EXPECT_LE(outside, static_cast<Eigen::Index>(sensors.size() / 20)) << "of " << sensors.size();
    // No ray is blocked. The errors of rays alone would exclude sensors over the kink in the middle. One and a half
    // patch widths around it contain 9 of the 23 positions along x.
    EXPECT_GT((error > 2.6 * found.errors.rays).count(), static_cast<Eigen::Index>(sensors.size() / 3));
  }
}

// Fins of one patch each, whose radiosity increases upward from 0. From the side a sensor sees only the dark lower ends
// of all fins but the nearest. So the errors of the fins add up. The reference has patches of an eighth.
TEST(SensorErrors, CoverEndsOfPatchesThatAreHidden) {
  Scene scene = empty_scene({grey(0)});
  for (int k = 0; k < 40; ++k) {
    const double x = 0.2 * k;
    scene = with_quad(std::move(scene), {Point(x, -2, 1), Point(x, 2, 1), Point(x, 2, 1.4), Point(x, -2, 1.4)});
  }
  const auto light_on = [&](const PatchMesh& mesh) {
    Field radiosity(mesh.size(), 1);
    for (PatchIndex i = 0; i < mesh.size(); ++i) radiosity(i, 0) = mesh.centroid[i].z() - 1;
    return radiosity;
  };
  std::vector<Sensor> sensors;
  for (double y = -1; y < 1; y += 0.1) sensors.push_back({Point(8.5, y, 0.7), Vector::UnitZ()});
  const Occluder occluder(scene, Occluder::Blockers::all);
  const PatchMesh coarse = fronts(scene, 5);
  const PatchMesh fine = fronts(scene, 0.05);
  ASSERT_EQ(coarse.size(), 40U);
  GatherOptions options;
  options.errors.display = Field::Constant(coarse.size(), 1, 0.4 / std::sqrt(12.0));
  const GatheredIrradiance found = gather_irradiance(coarse, light_on(coarse), occluder, sensors, options);
  const GatheredIrradiance exact = gather_irradiance(fine, light_on(fine), occluder, sensors);
  const Field ratio = (found.irradiance - exact.irradiance).abs() / found.errors.total();
  EXPECT_LT(ratio.maxCoeff(), 2.6);
  EXPECT_GT(ratio.maxCoeff(), 0.3);
}

// From close above its far end, a few square meters of a strip of 200 m give most of its form factor.
TEST(GatherIrradiance, OfALargePatchSeenInPartScattersAsItStates) {
  Scene scene =
      with_quad(empty_scene({grey(0)}), {Point(-1, -1, 0), Point(199, -1, 0), Point(199, 1, 0), Point(-1, 1, 0)});
  const PatchMesh mesh = fronts(scene, 300);
  scene = with_quad(std::move(scene), {Point(0.3, -3, .3), Point(299, -3, .3), Point(299, 3, .3), Point(0.3, 3, .3)});
  const Occluder occluder(scene, Occluder::Blockers::all);
  const Sensor sensor{Point(0, 0, 0.6), -Vector::UnitZ()};
  // A ray to x passes the edge of the plate, at half the sensor's height, at x / 2.
  const std::vector<Point> seen{Point(-1, -1, 0), Point(0.6, -1, 0), Point(0.6, 1, 0), Point(-1, 1, 0)};
  const double exact = point_to_polygon(sensor.point, sensor.normal, seen);
  for (int seed = 1; seed <= 20; ++seed) {
    const GatherOptions options{
        .rays = 64, .wanted_error = 1, .seed = static_cast<std::uint64_t>(seed), .slopes = false};
    const GatheredIrradiance found = gather_irradiance(mesh, Field::Ones(1, 1), occluder, {&sensor, 1}, options);
    EXPECT_LT(found.errors.rays(0, 0), 0.1 * exact);
    EXPECT_NEAR(found.irradiance(0, 0), exact, 4 * found.errors.rays(0, 0));  // t distribution of seven degrees
  }
}

TEST(SensorsFarOff, AreThoseFartherAwayThanTheModelIsLong) {
  // The diagonal of the cube of 1 m is sqrt(3) m.
  Scene scene = cube_room(0.5, 0.5);
  scene.sensors = {
      {.name = "near", .sensors = {{Point(0.5, 0.5, 0.5), Vector::UnitZ()}, {Point(2.7, 0, 0), Vector::UnitZ()}}}};
  EXPECT_TRUE(sensors_far_off(scene, scene.sensors).empty());
  scene.sensors[0].sensors.push_back({Point(500, 500, 500), Vector::UnitZ()});
  const std::vector<std::string> warnings = texts_of(sensors_far_off(scene, scene.sensors));
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].find("1 sensor "), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[0].find("sensor 3"), std::string::npos) << warnings[0];
}

Readings constant_readings(std::initializer_list<double> values) {
  Readings readings;
  readings.irradiance = Eigen::Map<const Field>(values.begin(), static_cast<Eigen::Index>(values.size()), 1);
  readings.standard_error = 0.1 * readings.irradiance;
  readings.bands = usual_bands(1);
  return readings;
}

TEST(ByGroup, TellsMinMeanMaxAndUniformity) {
  const Sensor sensor{Point::Zero(), Vector::UnitZ()};
  const std::vector<SensorGroup> groups = {{.name = "a", .sensors = {sensor, sensor, sensor}},
                                           {.name = "b", .sensors = {sensor}}};
  Readings readings = constant_readings({3, 1, 2, 8});
  const std::vector<GroupReadings> in_watts = by_group(groups, readings);
  ASSERT_EQ(in_watts.size(), 2U);
  EXPECT_NEAR(in_watts[0].min, 1, 1e-15);
  EXPECT_NEAR(in_watts[0].mean, 2, 1e-15);
  EXPECT_NEAR(in_watts[0].standard_error_of_mean, 0.2, 1e-15);
  EXPECT_NEAR(in_watts[0].max, 3, 1e-15);
  EXPECT_NEAR(in_watts[0].uniformity, 0.5, 1e-15);
  EXPECT_NEAR(in_watts[0].largest_standard_error, 0.3, 1e-15);
  EXPECT_NEAR(in_watts[1].mean, 8, 1e-14);
  EXPECT_FALSE(in_watts[1].mean_daylight_factor.has_value());

  Readings unknown = readings;
  unknown.standard_error(1, 0) = std::nan("");
  EXPECT_TRUE(std::isnan(by_group(groups, unknown)[0].standard_error_of_mean));
  EXPECT_NEAR(by_group(groups, unknown)[1].standard_error_of_mean, 0.8, 1e-15);

  readings.photometric = true;  // 179 lm/W
  readings.outside_by_sky = Spectrum::Constant(1, 100);
  const std::vector<GroupReadings> in_lux = by_group(groups, readings);
  EXPECT_NEAR(in_lux[0].mean, 358, 1e-12);
  EXPECT_NEAR(in_lux[0].mean_daylight_factor.value(), 2, 1e-14);
}

TEST(ByGroup, LeavesOutWhatIsInsideWalls) {
  const Sensor sensor{Point::Zero(), Vector::UnitZ()};
  const std::vector<SensorGroup> groups = {{.name = "a", .sensors = {sensor, sensor, sensor}},
                                           {.name = "b", .sensors = {sensor}}};
  Readings readings = constant_readings({std::nan(""), 1, 3, std::nan("")});
  readings.inside_wall = {1, 0, 0, 1};
  readings.outside_by_sky = Spectrum::Constant(1, 10);
  const std::vector<GroupReadings> found = by_group(groups, readings);
  EXPECT_EQ(found[0].sensors, 3U);
  EXPECT_EQ(found[0].inside_walls, 1U);
  EXPECT_NEAR(found[0].mean, 2, 1e-15);
  EXPECT_NEAR(found[0].uniformity, 0.5, 1e-15);
  EXPECT_NEAR(found[0].mean_daylight_factor.value(), 20, 1e-13);
  EXPECT_EQ(found[1].inside_walls, 1U);
  EXPECT_TRUE(std::isnan(found[1].min) && std::isnan(found[1].mean) && std::isnan(found[1].max)) << "no light is no 0";
  EXPECT_FALSE(found[1].mean_daylight_factor);
}

TEST(DoubtfulSensors, AreThoseInsideSolidsAndInSurfaces) {
  Scene scene = furnished_room(0.5);
  SensorGroup group{.name = "desk", .sensors = {}, .file = "room.toml"};
  const auto add = [&group](const Point& point, const Vector& normal, std::uint32_t line) {
    group.sensors.push_back({point, normal});
    group.lines.push_back(line);
  };
  add(Point(0.5, 0.5, 0.8), Vector::UnitZ(), 1);    // free
  add(Point(1.5, 1.4, 0.8), Vector::UnitZ(), 2);    // inside the box
  add(Point(1, 1.4, 0.8), Vector::UnitZ(), 3);      // in a side of the box
  add(Point(0.5, 0.5, 0), Vector::UnitZ(), 4);      // on the floor, facing up, the usual position of a luxmeter
  add(Point(0.999, 1.4, 0.8), Vector::UnitZ(), 5);  // 1 mm beside the box
  add(Point(1, 2.5, 0.8), Vector::UnitZ(), 6);      // in the plane of a side, beside it
  scene.sensors.push_back(group);
  const Occluder occluder(scene, Occluder::Blockers::all);
  const std::vector<std::string> found = texts_of(doubtful_sensors(
      scene.sensors, place_sensors(scene, scene.sensors, kept_sides(scene, Sides::automatic), occluder)));
  ASSERT_EQ(found.size(), 2U);
  EXPECT_TRUE(found[0].starts_with("sensor 2 of 'desk' (room.toml:2) at 1.5, 1.4, 0.8 m ")) << found[0];
  EXPECT_TRUE(found[1].starts_with("sensor 3 of 'desk' (room.toml:3) at 1, 1.4, 0.8 m ")) << found[1];
}

// The floor below has a texture, in patches of 1 x 1 m with a diagonal of 1.41 m.
TEST(SensorsCloseToPictures, AreThoseThatSeeSuchAPatchFromNearItsWidth) {
  Scene scene = with_quad(empty_scene({grey(0.5)}), {Point(0, 0, 0), Point(4, 0, 0), Point(4, 4, 0), Point(0, 4, 0)});
  const auto told = [&](const Point& point, const Vector& normal) {
    scene.sensors = {{.name = "a", .sensors = {{point, normal}}}};
    return sensors_close_to_pictures(scene, scene.sensors, tessellate(scene, kept_sides(scene, Sides::front), 1))
        .size();
  };
  const Vector down = -Vector::UnitZ();
  EXPECT_EQ(told({1.5, 1.5, 1}, down), 0U) << "the floor has no picture";
  scene.materials[0].texture = TexturedReflectance{};
  EXPECT_EQ(told({1.5, 1.5, 1}, down), 0U) << "its place on the floor is not known";
  scene.texture_maps = {{}};
  scene.polygons[0].texture_map = 0;
  EXPECT_EQ(told({1.5, 1.5, 1}, down), 1U);
  EXPECT_EQ(told({1.5, 1.5, 0.2}, Vector::UnitX()), 1U);
  EXPECT_EQ(told({1.5, 1.5, 1}, Vector::UnitZ()), 0U) << "looks away";
  EXPECT_EQ(told({1.5, 1.5, 0}, Vector::UnitZ()), 0U) << "lies in the floor";
  EXPECT_EQ(told({1.5, 1.5, -1}, Vector::UnitZ()), 0U) << "sees the back";
  EXPECT_EQ(told({1.5, 1.5, 2.2}, down), 0U) << "is 2.12 m away or more";
}

TEST(DoubtfulSensors, ManyAreCounted) {
  Scene scene = furnished_room(0.5);
  scene.sensors.push_back({.name = "all", .sensors = std::vector<Sensor>(9, {Point(1.5, 1.4, 0.8), Vector::UnitZ()})});
  const Occluder occluder(scene, Occluder::Blockers::all);
  const std::vector<std::string> found = texts_of(doubtful_sensors(
      scene.sensors, place_sensors(scene, scene.sensors, kept_sides(scene, Sides::automatic), occluder)));
  ASSERT_EQ(found.size(), 6U);
  EXPECT_EQ(found[5].rfind("4 more sensors", 0), 0U) << found[5];
}

}  // namespace
}  // namespace patchlight::gather_test
