#include "patchlight/base/error.h"
#include "patchlight/simulate.h"
#include "patchlight/views/picture.h"
#include "patchlight/views/views.h"

#include "base/parallel.h"
#include "light/photometry.h"
#include "support/scenes.h"
#include "support/test_room.h"
#include "verify/path_tracer.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

// Final pictures against laws of light.
namespace patchlight::pictures_test {
namespace {

using namespace test;

constexpr double pi = std::numbers::pi;

Simulation solved(const Scene& scene, std::size_t patches, Storage storage = Storage::automatic) {
  Request request;
  request.mesh.patches = patches;
  request.assembly.storage = storage;
  if (storage == Storage::rays) request.solver.solver = Solver::gmres;
  return simulate(scene, request);
}

// Into the test room, from a corner.
Camera into_room() { return {Point(0.3, 0.3, 1.6), Point(3, 2.2, 0.9), 60}; }

PictureOptions final_options(const Camera& camera, int edge, double error = 0.02) {
  return {.camera = camera, .width = edge, .height = edge, .quality = PictureQuality::final, .error = error};
}

// Luminances of all pixels, cd/m^2.
Eigen::VectorXd luminances(const Picture& picture) {
  return luminous_efficacy * picture.radiance.pixels.col(0).matrix();
}

TEST(FinalPicture, OfAFurnaceHasTheSameRadianceEverywhere) {
  // B = E + rho B: B = E / (1 - rho) in a closed room of one material.
  const Scene scene = with_box(empty_scene({grey(0.5, 3)}), Point(0, 0, 0), Point(2, 1, 1), true);
  const Picture picture =
      take_picture(scene, solved(scene, 600), final_options({Point(0.2, 0.4, 0.3), Point(2, 0.6, 0.6), 80}, 40));
  const Eigen::ArrayXd values = luminances(picture).array();
  const double expected = luminous_efficacy * 6 / pi;
  // Half a per cent for the solution's form factors.
  EXPECT_LT(((values - expected).abs() - 4 * picture.radiance.error.array()).maxCoeff(), 0.005 * expected);
  EXPECT_NEAR(values.mean(), expected, 0.005 * expected);
}

TEST(FinalPicture, IsLinearInTheEmission) {
  Scene scene = test_room(0.6);
  const Picture first = take_picture(scene, solved(scene, 500), final_options(into_room(), 24));
  for (Material& material : scene.materials) material.exitance *= 4;
  const Picture second = take_picture(scene, solved(scene, 500), final_options(into_room(), 24));
  // A power of two changes no rounding of the picture; the solver stops by relative errors.
  EXPECT_LT((second.radiance.pixels - 4 * first.radiance.pixels).abs().maxCoeff(),
            1e-5 * second.radiance.pixels.maxCoeff());
}

TEST(FinalPicture, HasTheSameBitsOnOneThreadAndOnTwo) {
  const Scene scene = test_room(0.5);
  const Simulation simulation = solved(scene, 400);
  const auto on = [&](int threads) {
    const ThreadLimit limit(threads);
    return take_picture(scene, simulation, final_options(into_room(), 40));
  };
  const Picture one = on(1);
  const Picture two = on(2);
  EXPECT_TRUE((one.radiance.pixels == two.radiance.pixels).all());
  EXPECT_TRUE(one.radiance.error == two.radiance.error);
}

TEST(FinalPicture, HidesTheMesh) {
  const Scene scene = test_room(0.5);
  const Eigen::ArrayXd coarse =
      luminances(take_picture(scene, solved(scene, 400), final_options(into_room(), 64, 0.01))).array();
  const Eigen::ArrayXd fine =
      luminances(take_picture(scene, solved(scene, 6000), final_options(into_room(), 64, 0.01))).array();
  // Lamps are so much brighter than all else that they would decide the mean.
  const double mean = fine.min(2 * fine.mean()).mean();
  EXPECT_LT(std::sqrt((coarse - fine).square().mean()), 0.02 * mean);
}

TEST(FinalPicture, ErrorsCoverWhatSeedsDiffer) {
  const Scene scene = test_room(0.5);
  Simulation simulation = solved(scene, 400);
  constexpr int seeds = 12;
  std::vector<Picture> pictures;
  Eigen::ArrayXd mean = Eigen::ArrayXd::Zero(32 * 32);
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    simulation.plan.assembly.seed = seed;
    pictures.push_back(take_picture(scene, simulation, final_options(into_room(), 32)));
    mean += luminances(pictures.back()).array() / seeds;
  }
  double beyond = 0;
  for (const Picture& picture : pictures) {
    const Eigen::ArrayXd error = picture.radiance.error.array();
    beyond += ((luminances(picture).array() - mean).abs() > 2 * error).cast<double>().mean() / seeds;
  }
  // One in twenty of a normal distribution; errors are pooled from a few samples.
  EXPECT_LT(beyond, 0.1);
}

TEST(FinalPicture, OfAFisheyeIntegratesToTheIrradianceOfASensor) {
  Scene scene = test_room(0.5);
  const Sensor sensor{Point(2, 1.5, 0.2), Vector::UnitZ()};
  scene.sensors = {{"up", {sensor}}};
  const Simulation simulation = solved(scene, 2000);
  const double expected = read_sensors(scene, simulation).readings.irradiance(0, 0);
  Camera camera{sensor.point, sensor.point + sensor.normal, 180};
  camera.projection = Projection::hemispherical;
  const Picture picture = take_picture(scene, simulation, final_options(camera, 200));
  // E = int L cos dw = pi times the mean over the disc, whose area is pi / 4 of the picture's.
  const double found = picture.radiance.pixels.col(0).mean() * 4;
  EXPECT_NEAR(found, expected, 0.01 * expected);
}

TEST(FinalPicture, OfAMirrorIsThatFromTheMirroredEye) {
  // A box with a lamp as its ceiling's middle, and a mirror for its wall at x = 4.
  Scene scene = empty_scene({grey(0.5), grey(0.5, 10), grey(0)});
  scene.materials[2].specular_reflectance = Spectrum::Constant(1, 0.8);
  const std::vector<Quad> faces = box_faces(Point(0, 0, 0), Point(4, 3, 2.5), true);
  for (std::size_t face = 0; face < faces.size(); ++face)
    scene = with_quad(std::move(scene), faces[face], face == 3 ? 2 : 0);
  scene = with_quad(std::move(scene), {Point(1, 1, 2.4), Point(1, 2, 2.4), Point(2, 2, 2.4), Point(2, 1, 2.4)}, 1);
  const Simulation simulation = solved(scene, 800, Storage::rays);
  constexpr int edge = 48;
  const Point at(4, 1.5, 1.3);
  const Picture mirror = take_picture(scene, simulation, final_options({Point(2.5, 1.5, 1.3), at, 40}, edge));
  const Picture behind = take_picture(scene, simulation, final_options({Point(5.5, 1.5, 1.3), at, 40}, edge));
  const Eigen::VectorXd in_mirror = luminances(mirror);
  const Eigen::VectorXd straight = luminances(behind);
  double square = 0, errors = 0;
  for (Eigen::Index y = 0; y < edge; ++y) {
    for (Eigen::Index x = 0; x < edge; ++x) {
      const Eigen::Index a = y * edge + x;
      const Eigen::Index b = y * edge + edge - 1 - x;
      square += std::pow(in_mirror[a] - 0.8 * straight[b], 2);
      errors += std::pow(mirror.radiance.error[a], 2) + std::pow(0.8 * behind.radiance.error[b], 2);
    }
  }
  EXPECT_GT(straight.mean(), 0);
  // What is less than a thousandth of the mean is rounding of paths.
  EXPECT_LT(std::sqrt(square), 1.5 * std::sqrt(errors) + 1e-3 * straight.mean() * edge);
}

TEST(FinalPicture, AgreesWithPathTracing) {
  const Scene scene = test_room(0.5);
  const Simulation simulation = solved(scene, 2000);
  // A square of the floor as an orthographic picture of just that.
  const std::array<Point, 4> square = {Point(1, 0.1, 0), Point(1.4, 0.1, 0), Point(1.4, 0.5, 0), Point(1, 0.5, 0)};
  Camera camera{Point(1.2, 0.3, 0.05), Point(1.2, 0.3, 0)};
  camera.projection = Projection::orthographic;
  camera.height = 0.4;
  const Picture picture = take_picture(scene, simulation, final_options(camera, 32, 0.005));
  const PathReceiver receiver{square, 0, Side::front};
  const PathEstimate paths = trace_irradiance(scene, simulation.plan.sides, {&receiver, 1}, {.paths = 1 << 18});
  const double expected = 0.5 / pi * paths.irradiance(0, 0);
  EXPECT_NEAR(picture.radiance.pixels.col(0).mean(), expected, 0.01 * expected);
}

TEST(FinalPicture, WithoutTimeIsCancelled) {
  const Scene scene = test_room(0.5);
  const Simulation simulation = solved(scene, 400);
  EXPECT_THROW(take_picture(scene, simulation, final_options(into_room(), 40), [](const Progress&) { return false; }),
               Cancelled);
}

}  // namespace
}  // namespace patchlight::pictures_test
