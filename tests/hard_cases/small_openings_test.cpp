// Light through small openings reaches the patches behind walls with slits, slats, bars and holes; the reference is
// path tracing.
#include "patchlight/gather/gather.h"
#include "patchlight/simulate.h"

#include "support/partitions.h"
#include "verify/path_tracer.h"
#include "visibility/occluder.h"

#include <cmath>
#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace patchlight::small_openings_test {
namespace {

using namespace test;

struct Opening {
  std::string name;
  Partition partition;
};

void PrintTo(const Opening& opening, std::ostream* out) { *out << opening.name; }

struct Mean {
  double value = 0;
  double error = 0;  // one standard error
};

// Mean irradiance of the far wall by paths, from 64 parts of it.
Mean by_paths(const Scene& scene) {
  std::vector<PathReceiver> parts;
  const double step = 0.25;
  for (int row = 0; row < 8; ++row) {
    for (int column = 0; column < 8; ++column) {
      const double y = column * step;
      const double z = row * step;
      parts.push_back(
          {{Point(2, y, z), Point(2, y, z + step), Point(2, y + step, z + step), Point(2, y + step, z)}, far_wall, {}});
    }
  }
  const PathEstimate paths = trace_irradiance(scene, kept_sides(scene, Sides::both), parts, {.paths = 4096});
  return {paths.irradiance.mean(), std::sqrt(paths.standard_error.square().sum()) / static_cast<double>(parts.size())};
}

Simulation simulated(const Scene& scene, double size, std::uint64_t seed = 1) {
  Request request;
  request.mesh.max_edge = 0.2501 * size;
  request.mesh.sides = Sides::both;
  request.assembly.seed = seed;
  request.accuracy.error_bars = true;
  return simulate(scene, request);
}

// The same from patches. Their errors are sampling errors, treated as independent.
Mean by_patches(const Simulation& simulation) {
  const PatchRange wall = simulation.mesh.patches_on(far_wall, Side::front);
  const Eigen::Index count = wall.end - wall.begin;
  return {simulation.solution.irradiance.middleRows(wall.begin, count).mean(),
          std::sqrt(simulation.error_bars->form_factor.middleRows(wall.begin, count).square().sum()) /
              static_cast<double>(count)};
}

class SmallOpenings : public testing::TestWithParam<Opening> {};

TEST_P(SmallOpenings, LetThroughWhatPathsFind) {
  const Scene scene = divided(GetParam().partition);
  const Mean paths = by_paths(scene);
  EXPECT_LT(paths.error, 0.02 * paths.value) << "too wide to tell anything";
  for (const double size : {1.0, 1e-3}) {
    const Eigen::AngleAxisd turn(size == 1 ? 0.0 : 0.7, Vector(1, 2, 3).normalized());
    const Eigen::Affine3d motion = Eigen::Affine3d(turn) * Eigen::Scaling(size);
    const Mean patches = by_patches(simulated(moved(scene, motion), size));
    EXPECT_NEAR(patches.value, paths.value, 3 * std::hypot(paths.error, patches.error)) << "size " << size;
    EXPECT_NEAR(patches.value, paths.value, 0.05 * paths.value) << "size " << size;
  }
}

// The same for sensors on the far wall: their errors come from the light of the patches and from their own rays.
TEST_P(SmallOpenings, LightSensorsAsPathsFind) {
  const Scene scene = divided(GetParam().partition);
  const std::vector<Point> spots{Point(2, 0.7, 0.35), Point(2, 1.1, 1.0), Point(2, 1.6, 1.8)};
  constexpr double half = 5e-4;
  std::vector<PathReceiver> around;
  std::vector<Sensor> sensors;
  for (const Point& spot : spots) {
    const Vector y = half * Vector::UnitY(), z = half * Vector::UnitZ();
    around.push_back({{spot - y - z, spot - y + z, spot + y + z, spot + y - z}, far_wall, {}});
    sensors.push_back({spot - 1e-4 * Vector::UnitX(), -Vector::UnitX()});
  }
  const PathEstimate paths = trace_irradiance(scene, kept_sides(scene, Sides::both), around, {.paths = 1 << 20});
  const Simulation simulation = simulated(scene, 1);
  const ErrorBars& bars = *simulation.error_bars;
  constexpr double reflectance = 0.5;
  GatherOptions options{.seed = 3};
  options.errors.sampling = reflectance * bars.form_factor;
  options.errors.mesh = reflectance * bars.mesh;
  const GatheredIrradiance found = gather_irradiance(simulation.mesh, simulation.solution.radiosity,
                                                     Occluder(scene, Occluder::Blockers::all), sensors, options);
  for (std::size_t k = 0; k < spots.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const double error = std::hypot(paths.standard_error(row, 0), found.errors.total()(row, 0));
    EXPECT_LT(paths.standard_error(row, 0), 0.02 * paths.irradiance(row, 0)) << "too wide to tell anything";
    EXPECT_NEAR(found.irradiance(row, 0), paths.irradiance(row, 0), 3 * error) << k;
    EXPECT_NEAR(found.irradiance(row, 0), paths.irradiance(row, 0), 0.05 * paths.irradiance(row, 0)) << k;
  }
}

INSTANTIATE_TEST_SUITE_P(All, SmallOpenings,
                         testing::Values(Opening{"slits", slits(20, 0.02)}, Opening{"louvres", louvres(40)},
                                         Opening{"railing", railing(20)}, Opening{"holes_2", perforated(8, 0.02)},
                                         Opening{"holes_10", perforated(8, 0.1)},
                                         Opening{"holes_98", perforated(8, 0.98)}),
                         [](const auto& one) { return one.param.name; });

// The scatter of each patch's irradiance over four seeds of the slits, against the stated error. Errors of patches are
// almost independent: the 64 patches of the far wall alone give the ratio to 1 / sqrt(2 x 3 x 64) = 5 %.
TEST(SlitsSeeds, ScatterAsStated) {
  const Scene scene = divided(slits(20, 0.02));
  constexpr int seeds = 4;
  Field sum, squares, bars;
  for (int seed = 1; seed <= seeds; ++seed) {
    const Simulation simulation = simulated(scene, 1, static_cast<std::uint64_t>(seed));
    const Field& H = simulation.solution.irradiance;
    if (seed == 1) sum = squares = bars = Field::Zero(H.rows(), 1);
    sum += H;
    squares += H.square();
    bars += simulation.error_bars->form_factor.square() / seeds;
  }
  const Field variance = (squares - sum.square() / seeds) / (seeds - 1);
  const double ratio = std::sqrt(variance.mean() / bars.mean());
  EXPECT_GT(ratio, 0.7);
  EXPECT_LT(ratio, 1.3);
}

}  // namespace
}  // namespace patchlight::small_openings_test
