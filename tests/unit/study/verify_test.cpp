#include "patchlight/study/verify.h"

#include "patchlight/base/parallel.h"
#include "patchlight/input/read_scene.h"

#include "support/scenes.h"

#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <string>

namespace patchlight {
namespace {

using namespace test;

Scene model(const std::string& name) { return read_scene(std::filesystem::path(PATCHLIGHT_MESHES) / name); }

Request request_for(std::size_t patches, Sides sides = Sides::automatic) {
  Request request;
  request.patches = patches;
  request.sides = sides;
  return request;
}

// From front sides, with bars.
Request with_error_bars(std::size_t patches) {
  Request request = request_for(patches, Sides::front);
  request.error_bars = true;
  return request;
}

// The scene with one material's reflectance so many times as high.
Scene repainted(Scene scene, const std::string& name, double factor) {
  for (Material& material : scene.materials) {
    if (material.name == name) material.reflectance *= factor;
  }
  return scene;
}

// How far the differences as a whole are from 0, in standard errors by the noise of the paths alone; the worst band.
double sigmas_of_mean(const Verification& verification) {
  const Field difference = verification.irradiance - verification.paths.irradiance;
  const Field variance = verification.paths.standard_error.square();
  return (difference.colwise().sum().abs() / variance.colwise().sum().sqrt()).maxCoeff();
}

// How far the worst band's chi-square is above its mean, in standard deviations.
double sigmas_of_verdict(const Verification& verification) {
  const auto degrees = static_cast<double>(verification.patches.size());
  return (verification.chi_square.maxCoeff() - degrees) / std::sqrt(2 * degrees);
}

void expect_agreement(const Verification& verification) {
  EXPECT_TRUE(verification.agrees) << "p = " << verification.probability;
  EXPECT_LT(sigmas_of_verdict(verification), 2);
}

// By the noise of the paths alone, and by the verdict, which grants the bars as well.
void expect_disagreement_by_five_sigma(const Verification& verification) {
  EXPECT_FALSE(verification.agrees) << "p = " << verification.probability;
  EXPECT_GT(sigmas_of_mean(verification), 5);
  EXPECT_GT(sigmas_of_verdict(verification), 5);
}

// How many paths it takes to see a reflectance that is off by 5 %: at .7 to .8 it changes what is reflected by more
// than that, and irradiances by x bars, bar and noise together, where x is 1 to 2. Then chi-square of n patches rises
// by n x^2, and its standard deviation is sqrt(2 n): 5 sigma takes n = 50 for x = 1. The noise of 4096 paths is 2 % of
// a patch's irradiance, as much as the bar: more paths would gain little, but in the two rooms, where the bars are
// smaller, 8192 do. As right solutions stay well within their bars, chi-square begins 4 to 5 sigma below n, so that it
// takes n = 128.

TEST(Verify, CornellBoxAgreesUntilItIsRepainted) {
  const Scene scene = model("cornell_box.obj");
  const Simulation simulation = simulate(scene, with_error_bars(2000));
  const Field bar = simulation.error_bars->total();
  const VerifyOptions options{.paths = 4096, .checked = 128};
  expect_agreement(verify(scene, simulation, bar, options));
  expect_disagreement_by_five_sigma(verify(repainted(scene, "white", 1.05), simulation, bar, options));
  expect_disagreement_by_five_sigma(verify(repainted(scene, "white", 0.95), simulation, bar, options));
}

TEST(Verify, TwoRoomsAgreeUntilTheyAreRepainted) {
  const Scene scene = model("two_rooms.obj");
  const Simulation simulation = simulate(scene, with_error_bars(8000));
  const Field bar = simulation.error_bars->total();
  const VerifyOptions options{.paths = 8192, .checked = 128};
  expect_agreement(verify(scene, simulation, bar, options));
  expect_disagreement_by_five_sigma(verify(repainted(scene, "plaster_white", 1.05), simulation, bar, options));
  expect_disagreement_by_five_sigma(verify(repainted(scene, "plaster_white", 0.95), simulation, bar, options));
}

TEST(Verify, ChecksEveryPatchWhenFewerAreThere) {
  // A furnace has B = H = 1 without any error of the mesh: what is left is the noise of the paths, so that no bar is
  // needed.
  const Scene scene = cube_room(0.5, 0.5);
  Request request;
  request.max_edge = 0.5;
  request.tolerance = 1e-9;
  const Simulation simulation = simulate(scene, request);
  const Verification verification = verify(scene, simulation, irradiance_bar(simulation, 0));
  ASSERT_EQ(verification.patches.size(), simulation.mesh.size());
  EXPECT_TRUE(verification.agrees);
  EXPECT_LT(verification.bar.maxCoeff(), 1e-6);
  // Without bars both deviations are the same but for the variance of Student's t.
  const Field ratio = deviations_by_noise(verification) / deviations(verification);
  EXPECT_LT((ratio - std::sqrt(31.0 / 29)).abs().maxCoeff(), 1e-3);
}

TEST(Verify, LargePatchesAreChosenMoreOften) {
  // Two plates that see each other, a patch of 4 m^2 and sixteen that add up to as much: of one checked patch, half the
  // seeds choose the large one. 200 seeds: 100 with a standard deviation of 7.
  Scene scene = empty_scene({grey(0.5, 1)});
  scene = with_quad(std::move(scene), {Point(0, 0, 0), Point(2, 0, 0), Point(2, 2, 0), Point(0, 2, 0)});
  for (int k = 0; k < 16; ++k) {
    const double x = 0.5 * (k % 4);
    const double y = 0.5 * (k / 4);
    scene = with_quad(std::move(scene),
                      {Point(x, y, 1), Point(x, y + 0.5, 1), Point(x + 0.5, y + 0.5, 1), Point(x + 0.5, y, 1)});
  }
  const Simulation simulation = simulate(scene, request_for(1, Sides::front));
  ASSERT_EQ(simulation.mesh.size(), 17U);
  int large = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const VerifyOptions options{.paths = 1, .checked = 1, .seed = seed};
    large += verify(scene, simulation, irradiance_bar(simulation, 1), options).patches.front() == 0 ? 1 : 0;
  }
  EXPECT_NEAR(large, 100, 28);
}

TEST(Verify, SameBitsWithAnyNumberOfThreads) {
  const Scene scene = furnished_room(0.5);
  const Simulation simulation = simulate(scene, request_for(200));
  const auto check = [&](int threads) {
    const ThreadLimit limit(threads);
    return verify(scene, simulation, irradiance_bar(simulation, 0.02), {.paths = 256});
  };
  const Verification one = check(1);
  const Verification two = check(2);
  EXPECT_EQ(one.patches, two.patches);
  EXPECT_EQ(one.probability, two.probability);
  EXPECT_TRUE((one.paths.irradiance == two.paths.irradiance).all());
}

}  // namespace
}  // namespace patchlight
