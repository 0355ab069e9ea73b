// Laws of solutions by rows of rays.
#include "patchlight/base/error.h"
#include "patchlight/input/read_scene.h"
#include "patchlight/simulate.h"

#include "support/meshes.h"
#include "support/scenes.h"
#include "support/test_room.h"

#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <string>
#include <utility>

namespace patchlight::rays_test {
namespace {

using namespace test;

Request by_rays(std::size_t patches = 1000) {
  Request request;
  request.mesh.patches = patches;
  request.assembly.storage = Storage::rays;
  request.solver.solver = Solver::gmres;
  return request;
}

double norm(const Field& x, const Simulation& s) {
  return std::sqrt((x.square().colwise() * s.problem.area.array()).sum());
}

Field reflected(const Simulation& s) { return s.solution.radiosity - s.problem.exitance; }

// The error against another solution on the same mesh, and the bars, both relative to the reflected light.
struct Compared {
  double error = 0;
  double stated = 0;
};

Compared compared(const Simulation& rays, const Simulation& exact) {
  const double all = norm(reflected(exact), exact);
  const Field bars = rays.problem.scattering.reflectance * rays.ray_standard_error;
  return {norm(rays.solution.radiosity - exact.solution.radiosity, exact) / all, norm(bars, exact) / all};
}

Simulation by_matrix(const Scene& scene, Request request) {
  request.assembly.storage = Storage::tiles;
  request.solver.solver = Solver::cg;
  request.assembly.samples = 32;
  request.accuracy.error_bars = true;  // so that the mesh is nested as with rays
  return simulate(scene, request);
}

// In a closed room where every patch emits 1 - rho, all radiosities are 1: row sums of 1 ensure it, whatever the rays
// hit. A uniform exitance does not count as a lamp.
TEST(Rays, KeepTheFurnaceEven) {
  Scene scene = cube_room(0.7, 0.3);
  scene.materials.push_back(grey(0.4, 0.6));
  scene = with_box(std::move(scene), Point(0.3, 0.3, 0.3), Point(0.6, 0.7, 0.5), false, 1);
  const Simulation s = simulate(scene, by_rays(1000));
  EXPECT_TRUE(s.solution.converged);
  EXPECT_LT((s.solution.radiosity - 1).abs().maxCoeff(), 1e-5);
  EXPECT_LT(s.ray_standard_error.maxCoeff(), 1e-5);
  ASSERT_TRUE(s.error_bars);
  EXPECT_LT(s.error_bars->mesh.maxCoeff(), 1e-5);
  EXPECT_EQ(s.balance.escaped[0], 0);
}

// Surfaces absorb the emitted flux. R rays that carry equal parts of the light have a relative error of about 1 /
// sqrt(R), here 0.3 %, and less with stratification.
TEST(Rays, BalanceTheFlux) {
  const Simulation s = simulate(test_room(0.7), by_rays(2000));
  EXPECT_LT(s.balance.imbalance, 3e-3);
  EXPECT_GT(s.balance.absorbed[0], 0.9 * s.balance.emitted[0]);
}

// All emitted light arrives: errors of rows do not change the total, which 1 / (1 - rho) = 33 reflections would
// amplify. Root mean square over four seeds.
TEST(Rays, KeepTheLevelOfBrightRooms) {
  const Scene scene = test_room(0.97);
  const auto level = [](const Simulation& s) { return (reflected(s).col(0) * s.problem.area.array()).sum(); };
  const double exact = level(by_matrix(scene, by_rays(600)));
  double squares = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    Request request = by_rays(600);
    request.assembly.seed = seed;
    squares += std::pow(level(simulate(scene, request)) / exact - 1, 2) / 4;
  }
  EXPECT_LT(std::sqrt(squares), 2e-3);
}

TEST(Rays, AreWithinTheirBarsOfTheMatrixInTheCornellBox) {
  const Scene scene = read_scene({mesh_folder() / "cornell_box.obj"});
  const Compared by = compared(simulate(scene, by_rays()), by_matrix(scene, by_rays()));
  EXPECT_LT(by.error, 0.03);
  EXPECT_GT(by.error, 0.6 * by.stated);
  EXPECT_LT(by.error, 1.4 * by.stated);
}

// Floating blocks and a slab hide the lamp from most of the room.
TEST(Rays, AreWithinTheirBarsOfTheMatrixInARoomWithBlocks) {
  const Simulation exact = by_matrix(test_room(0.7), by_rays());
  const Compared by = compared(simulate(test_room(0.7), by_rays()), exact);
  EXPECT_LT(by.error, 0.04);
  EXPECT_GT(by.error, 0.6 * by.stated);
  EXPECT_LT(by.error, 1.4 * by.stated);
}

// Two squares in the open with equal exitance, each of which fills a sixteenth of the other's hemisphere. About ten
// rays of a patch hit the other square, and the uncertainty is that of their number. The halves of all rows agree
// nevertheless: they carry the same light and are scaled to the same sums. The values are root mean squares over four
// seeds. The rays are stratified, so the error may be below the stated one for independent hits.
TEST(Rays, StateWhatSmallRowSumsErr) {
  Scene scene =
      with_quad(empty_scene({grey(0.5, 1)}), {Point(0, 0, 0), Point(2, 0, 0), Point(2, 2, 0), Point(0, 2, 0)});
  scene = with_quad(std::move(scene), {Point(0, 0, 4), Point(0, 2, 4), Point(2, 2, 4), Point(2, 0, 4)});
  Request request = by_rays(500);
  request.mesh.sides = Sides::front;
  const Simulation exact = by_matrix(scene, request);
  double error = 0;
  double stated = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    request.assembly.seed = seed;
    const Compared by = compared(simulate(scene, request), exact);
    error += by.error * by.error / 4;
    stated += by.stated * by.stated / 4;
  }
  EXPECT_GT(std::sqrt(error), 0.01);
  EXPECT_LT(std::sqrt(error), 1.4 * std::sqrt(stated));
  EXPECT_LT(std::sqrt(stated), 3 * std::sqrt(error));
}

TEST(Rays, HaveTheSameBitsForAnyNumberOfThreads) {
  Request request = by_rays(1500);
  const auto solved = [&](int threads) {
    request.resources.threads = threads;
    return simulate(test_room(0.7), request);
  };
  const Simulation one = solved(1);
  const Simulation two = solved(2);
  EXPECT_TRUE((one.solution.radiosity == two.solution.radiosity).all());
  EXPECT_TRUE((one.ray_standard_error == two.ray_standard_error).all());
  EXPECT_TRUE((one.error_bars->mesh == two.error_bars->mesh).all());
}

// The error by the size of patches, relative to the reflected light.
double mesh_error(const Scene& scene, std::size_t patches) {
  const Simulation s = simulate(scene, by_rays(patches));
  return norm(s.problem.scattering.reflectance * s.error_bars->mesh, s) / norm(reflected(s), s);
}

// Each quarter of a patch starts two rays above 20,000 patches and sixteen below. The mesh error found with few rays
// must not be their noise. Four times the patches reduce the error to 4^(-1.2 / 2) = 0.44 by its order; noise may raise
// that to twice as much.
TEST(Rays, StateLessErrorOfFinerPatchesFromFewerRays) {
  const Scene scene = read_scene({mesh_folder() / "cornell_box.obj"});
  EXPECT_LT(mesh_error(scene, 24000), 0.88 * mesh_error(scene, 6000));
}

// Twice the light gives twice the radiosity; two lamps give the sum of their results, within the bars.
TEST(Rays, AreLinearInTheLight) {
  Scene scene = test_room(0.7);
  const Simulation one = simulate(scene, by_rays(1000));
  scene.materials[1].exitance *= 2;
  const Simulation two = simulate(scene, by_rays(1000));
  EXPECT_LT((two.solution.radiosity - 2 * one.solution.radiosity).abs().maxCoeff(),
            1e-3 * one.solution.radiosity.maxCoeff());
}

// Bands that differ by a factor in their lamps only have the same results as if each was solved.
TEST(Rays, TellBandsThatFollowFromOthers) {
  Scene scene = test_room(0.7);
  for (Material& material : scene.materials) {
    material.reflectance = Spectrum::Constant(3, material.reflectance[0]);
    material.exitance = material.exitance[0] * Eigen::Array3d(1, 1.0 / 2, 1.0 / 3);
  }
  Request request = by_rays(1000);
  const Simulation few = simulate(scene, request);
  request.solver.every_band = true;
  const Simulation each = simulate(scene, request);
  const auto differ = [](const Field& a, const Field& b) { return ((a - b).abs() / b.maxCoeff()).maxCoeff(); };
  EXPECT_LT(differ(few.solution.radiosity, each.solution.radiosity), 1e-12);
  EXPECT_LT(differ(few.solution.direct_irradiance, each.solution.direct_irradiance), 1e-12);
  EXPECT_LT(differ(few.solution.error, each.solution.error), 1e-9);
  EXPECT_LT(differ(few.ray_standard_error, each.ray_standard_error), 1e-9);
  // The mesh errors, and their noise, scale with the light.
  ASSERT_TRUE(few.error_bars);
  const auto of_first = [](const Field& field) -> Field {
    Field bands = field.col(0).replicate(1, field.cols());
    for (Eigen::Index band = 1; band < bands.cols(); ++band) bands.col(band) /= 1 + static_cast<double>(band);
    return bands;
  };
  ASSERT_EQ(few.error_bars->mesh_noise.cols(), 3);
  EXPECT_GT(few.error_bars->mesh_noise.maxCoeff(), 0);
  EXPECT_LT(differ(few.error_bars->mesh_noise, of_first(few.error_bars->mesh_noise)), 1e-9);
  EXPECT_LT(differ(few.error_bars->mesh, of_first(few.error_bars->mesh)), 1e-9);
}

// The solvers that need only H = F B agree to their tolerance.
TEST(Rays, AreSolvedByWhatTakesTheOperatorAlone) {
  Request request = by_rays(1000);
  request.solver.relative_error = 1e-6;
  const Simulation first = simulate(test_room(0.7), request);
  EXPECT_TRUE(first.solution.converged);
  for (const Solver solver : {Solver::bicgstab, Solver::jacobi, Solver::chebyshev}) {
    request.solver.solver = solver;
    const Simulation other = simulate(test_room(0.7), request);
    EXPECT_TRUE(other.solution.converged) << name_of(solver);
    EXPECT_LT(compared(other, first).error, 2e-6) << name_of(solver);
  }
}

TEST(Rays, RefuseSolversThatTheyCannotServe) {
  for (const Solver solver : {Solver::cg, Solver::deflated_cg, Solver::progressive, Solver::sor}) {
    Request request = by_rays(1000);
    request.solver.solver = solver;
    try {
      simulate(test_room(0.7), request);
      ADD_FAILURE() << name_of(solver);
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("gmres, bicgstab"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace patchlight::rays_test
