#include "study/verify.h"

#include "patchlight/input/read_scene.h"

#include "base/parallel.h"
#include "support/meshes.h"
#include "support/scenes.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <initializer_list>
#include <string>

namespace patchlight::verify_test {
namespace {

using namespace test;

Scene model(const std::string& name) { return read_scene(mesh_folder() / name); }

Request request_for(std::size_t patches, Sides sides = Sides::automatic) {
  Request request;
  request.mesh.patches = patches;
  request.mesh.sides = sides;
  return request;
}

// Front sides, with bars.
Request with_error_bars(std::size_t patches) {
  Request request = request_for(patches, Sides::front);
  request.accuracy.error_bars = true;
  return request;
}

// The scene with the reflectance of one material multiplied by this factor.
Scene repainted(Scene scene, const std::string& name, double factor) {
  for (Material& material : scene.materials) {
    if (material.name == name) material.reflectance *= factor;
  }
  return scene;
}

// Distance of the mean difference from 0, in standard errors of the paths' noise alone, in the worst band.
double sigmas_of_mean(const Verification& verification) {
  const Field difference = verification.irradiance - verification.paths.irradiance;
  const Field variance = verification.paths.standard_error.square();
  return (difference.colwise().sum().abs() / variance.colwise().sum().sqrt()).maxCoeff();
}

// Distance of the worst band's chi-square above its mean, in standard deviations.
double sigmas_of_verdict(const Verification& verification) {
  const auto degrees = static_cast<double>(verification.patches.size());
  return (verification.parts.front().chi_square.maxCoeff() - degrees) / std::sqrt(2 * degrees);
}

void expect_agreement(const Verification& verification) {
  EXPECT_EQ(verification.verdict, Verdict::agrees) << "p = " << verification.probability;
  EXPECT_LT(sigmas_of_verdict(verification), 2);
}

// Both tests must fail: by the noise of the paths alone, and by the verdict, which also includes the bars.
void expect_disagreement_by_five_sigma(const Verification& verification) {
  EXPECT_EQ(verification.verdict, Verdict::disagrees) << "p = " << verification.probability;
  EXPECT_GT(sigmas_of_mean(verification), 5);
  EXPECT_GT(sigmas_of_verdict(verification), 5);
}

// An error of 5 % in a reflectance of 0.7 to 0.8 changes the reflected light by more than 5 %. Bars are 1 to 2 %, and
// the noise of 4096 paths is 2 %. So each of 64 patches differs by x = 2 to 3 standard deviations. Chi-square rises by
// 64 x^2, and its own standard deviation is sqrt(2 64). In the two rooms bars are larger in the gaps behind the shelves
// and beside the dividing wall, so fewer patches detect it. The solution is 1 % too dark there, so a lower reflectance
// is the harder case.

void expect_agreement_until_repainted(const Scene& scene, const std::string& material,
                                      std::initializer_list<double> factors) {
  const Simulation simulation = simulate(scene, with_error_bars(default_patches));
  const Field bar = simulation.error_bars->total();
  expect_agreement(verify(scene, simulation, bar));
  for (const double factor : factors)
    expect_disagreement_by_five_sigma(verify(repainted(scene, material, factor), simulation, bar));
}

TEST(Verify, CornellBoxAgreesUntilItIsRepainted) {
  expect_agreement_until_repainted(model("cornell_box.obj"), "white", {1.05, 0.95});
}

TEST(Verify, TwoRoomsAgreeUntilTheyAreRepainted) {
  expect_agreement_until_repainted(model("two_rooms.obj"), "plaster_white", {0.95});
}

// A room of 2 x 1 x 1 m, divided by a wall except for a gap of 1 cm, with a lamp below the ceiling on one side.
Scene rooms_with_a_gap() {
  Scene scene = with_box(empty_scene({grey(0.7), grey(0, 10)}), Point(0, 0, 0), Point(2, 1, 1), true);
  scene = with_quad(std::move(scene), {Point(1, 0, 0), Point(1, 0.99, 0), Point(1, 0.99, 1), Point(1, 0, 1)});
  return with_quad(std::move(scene),
                   {Point(0.4, 0.4, 0.9), Point(0.4, 0.6, 0.9), Point(0.6, 0.6, 0.9), Point(0.6, 0.4, 0.9)}, 1);
}

TEST(Verify, FewPathsThatMissAGapAreNotBelieved) {
  // Few of 32 paths meet the gap, so their spread is too small. A correct solution that they reject gets a second look.
  // A solution with walls that reflect a tenth more is still rejected.
  const Scene scene = rooms_with_a_gap();
  Request request = with_error_bars(600);
  request.mesh.sides = Sides::automatic;
  const Simulation simulation = simulate(scene, request);
  const Field bar = simulation.error_bars->total();
  Scene brighter = scene;
  brighter.materials[0].reflectance *= 1.1;
  int looked_at_again = 0;
  const auto with_seed = [](std::uint64_t seed) { return VerifyOptions{.paths = 32, .checked = 200, .seed = seed}; };
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Verification right = verify(scene, simulation, bar, with_seed(seed));
    EXPECT_NE(right.verdict, Verdict::disagrees) << seed;
    looked_at_again += right.first_paths == 32;
  }
  EXPECT_GT(looked_at_again, 0);
  EXPECT_EQ(verify(brighter, simulation, bar, with_seed(1)).verdict, Verdict::disagrees);
}

TEST(Verify, ChecksEveryPatchWhenFewerAreThere) {
  // A furnace has B = H = 1 without any error of the mesh. The only difference is the noise of the paths, so no bar is
  // needed.
  const Scene scene = cube_room(0.5, 0.5);
  Request request;
  request.mesh.max_edge = 0.5;
  request.solver.relative_error = 1e-9;
  const Simulation simulation = simulate(scene, request);
  const Verification verification = verify(scene, simulation, irradiance_bar(simulation, 0));
  ASSERT_EQ(verification.patches.size(), simulation.mesh.size());
  EXPECT_EQ(verification.verdict, Verdict::agrees);
  EXPECT_LT(verification.bar.maxCoeff(), 1e-6);
  // Without bars both deviations are equal, except for the variance of Student's t.
  const Field ratio = deviations_by_noise(verification) / deviations(verification);
  EXPECT_LT((ratio - std::sqrt(31.0 / 29)).abs().maxCoeff(), 1e-3);
}

// An irradiance that is a quarter too high everywhere differs by a quarter of the paths' irradiance. The solution's own
// error adds about 1 %, plus the scatter of the noise.
TEST(Verify, TellsTheTypicalErrorOfAPatch) {
  const Scene scene = model("cornell_box.obj");
  Simulation simulation = simulate(scene, request_for(1000, Sides::front));
  simulation.solution.irradiance *= 1.25;
  const Field bar = Field::Zero(simulation.solution.irradiance.rows(), simulation.solution.irradiance.cols());
  const Verification verification = verify(scene, simulation, bar, {.paths = 8192, .checked = 64});
  const VerifiedPart& part = verification.parts.front();
  const Eigen::ArrayXd by_chance = 3 * part.noise.square() * std::sqrt(2.0 / 64) / 0.25;
  EXPECT_LT(((part.error - 0.25).abs() - by_chance).maxCoeff(), 0.03);
  EXPECT_GT(part.noise.minCoeff(), 0.001);
  EXPECT_LT(part.noise.maxCoeff(), 0.05);
}

// Two plates see each other, repainted so that each patch differs by about two of its bars. A third plate of four times
// their area faces away from all light. Its patches are 0 to both, and do not make the other differences likely.
TEST(Verify, PatchesThatAreDarkInBothGrantNothing) {
  Scene scene = empty_scene({grey(0.5, 1), grey(0.5, 0)});
  scene = with_quad(std::move(scene), {Point(0, 0, 0), Point(2, 0, 0), Point(2, 2, 0), Point(0, 2, 0)});
  scene = with_quad(std::move(scene), {Point(0, 0, 1), Point(0, 2, 1), Point(2, 2, 1), Point(2, 0, 1)});
  scene = with_quad(std::move(scene), {Point(0, 0, 3), Point(8, 0, 3), Point(8, 4, 3), Point(0, 4, 3)});
  scene.polygons.back().material = 1;
  const Simulation simulation = simulate(scene, request_for(100, Sides::front));
  scene.materials[0].reflectance *= 1.2;
  const Verification verification =
      verify(scene, simulation, irradiance_bar(simulation, 0.03), {.paths = 1 << 14, .checked = 1000});
  ASSERT_EQ(verification.parts.size(), 1U);
  const VerifiedPart& part = verification.parts.front();
  ASSERT_EQ(part.rows.size(), simulation.mesh.size());
  const auto lit = static_cast<double>((simulation.solution.irradiance.col(0) > 0).count());
  EXPECT_EQ(part.dark[0], static_cast<double>(part.rows.size()) - lit);
  EXPECT_GT(part.dark[0], lit);
  EXPECT_GT(part.chi_square[0], 2 * lit);
  EXPECT_EQ(verification.verdict, Verdict::disagrees) << "p = " << verification.probability;
}

TEST(Verify, LargePatchesAreChosenMoreOften) {
  // Two plates that see each other: a patch of 4 m^2 and sixteen with the same total area. With one checked patch, half
  // the seeds choose the large one. 200 seeds: 100 with a standard deviation of 7.
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

// A room with a block in it. The outer sides of the room and the inner ones of the block are omitted and dark. One lit
// side is omitted by mistake. It is black to both the solution and the paths, so they agree on the rest. A separate
// check finds it. In m, rotated, and in mm.
TEST(Verify, FindsLightOnASideThatWasLeftOut) {
  for (const double scale : {1.0, 1e-3}) {
    const Eigen::AngleAxisd turn(scale == 1 ? 0.0 : 0.7, Vector(1, 2, -0.5).normalized());
    const Scene scene = moved(furnished_room(0.5), Eigen::Affine3d(Eigen::Scaling(scale) * turn));
    for (const bool wrong : {false, true}) {
      Request request;
      request.mesh.max_edge = 0.5 * scale;
      request.mesh.kept_sides = kept_sides(scene, Sides::automatic);
      std::vector<std::uint8_t>& front = request.mesh.kept_sides->front;
      const auto lit = static_cast<PolygonIndex>(std::find(front.begin(), front.end(), 1) - front.begin());
      if (wrong) front[lit] = 0;
      const Simulation simulation = simulate(scene, request);
      const Verification verification =
          verify(scene, simulation, irradiance_bar(simulation, 0.05), {.paths = 1024, .checked = 16, .left_out = 100});
      EXPECT_FALSE(verification.left_out.empty());
      EXPECT_LT(verification.left_out.size(), 100U);
      for (const LeftOutSide& side : verification.left_out)
        EXPECT_EQ(side.is_lit, wrong && side.polygon == lit && side.side == Side::front)
            << scale << ' ' << side.polygon;
      EXPECT_GT(verification.probability, least_probability);
      EXPECT_EQ(verification.verdict, wrong ? Verdict::disagrees : Verdict::agrees);
    }
  }
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
}  // namespace patchlight::verify_test
