#include "annual/adjoint_light.h"

#include "patchlight/simulate.h"

#include "base/sampling.h"
#include "support/daylight_office.h"

#include <gtest/gtest.h>

namespace patchlight::adjoint_light_test {
namespace {

using test::daylight_office;

// An office with a translucent sheet, whose light depends on both of its sides.
Scene with_sheet(Scene scene) {
  Material sheet = test::named("sheet", 0.3);
  sheet.diffuse_transmittance = test::watts(0.4);
  scene.materials.push_back(sheet);
  return test::with_quad(std::move(scene), {Point(3, 1, 0.5), Point(3, 2, 0.5), Point(3, 2, 2), Point(3, 1, 2)},
                         static_cast<MaterialIndex>(scene.materials.size() - 1));
}

SolvedTransport transport_of(const Scene& scene, Storage storage) {
  Request request;
  request.mesh.patches = 400;
  request.assembly.storage = storage;
  if (storage == Storage::rays) request.solver.solver = Solver::gmres;
  const Simulation simulation = simulate(scene, request, {}, {.keeps_transport = true});
  EXPECT_EQ(simulation.transports.size(), 1U);
  return simulation.transports.front();
}

// Numbers in [0, 1), a third of which are 0.
Field numbers(Eigen::Index rows, Eigen::Index columns, std::uint32_t seed) {
  Field field(rows, columns);
  for (Eigen::Index i = 0; i < rows; ++i)
    for (Eigen::Index k = 0; k < columns; ++k) {
      const double u = hash({seed, static_cast<std::uint64_t>(i), static_cast<std::uint64_t>(k)}) * 0x1p-32;
      field(i, k) = u < 1.0 / 3 ? 0 : u;
    }
  return field;
}

// <g, B> = <W, H> where B is the light by H after all reflections.
void expect_duality(const SolvedTransport& solved) {
  const Eigen::Index size = solved.area.size();
  constexpr Eigen::Index sensors = 3;
  const Field seen = numbers(size, sensors, 1);
  const Field arriving = numbers(size, 1, 2);
  const Field weights = AdjointLight(solved).weights(seen, {0, 0, 0}, 1e-10).values;
  const RadiosityProblem problem{solved.scattering, Field::Zero(size, 1), solved.area, arriving};
  const Solution solution =
      solve(*solved.light, problem, {.solver = usual_solver(*solved.light, problem), .relative_error = 1e-10});
  ASSERT_TRUE(solution.converged);
  for (Eigen::Index k = 0; k < sensors; ++k) {
    const double forward = (seen.col(k) * solution.radiosity.col(0)).sum();
    const double backward = (weights.col(k) * arriving.col(0)).sum();
    EXPECT_NEAR(backward / forward, 1, 1e-6);
  }
}

TEST(AdjointLight, IsDualToTheSolutionByPairs) { expect_duality(transport_of(daylight_office(), Storage::tiles)); }

TEST(AdjointLight, IsDualToTheSolutionByRays) { expect_duality(transport_of(daylight_office(), Storage::rays)); }

TEST(AdjointLight, IsDualBetweenTheSidesOfSheets) {
  const SolvedTransport solved = transport_of(with_sheet(daylight_office()), Storage::rays);
  ASSERT_FALSE(solved.scattering.is_diagonal());
  expect_duality(solved);
}

}  // namespace
}  // namespace patchlight::adjoint_light_test
