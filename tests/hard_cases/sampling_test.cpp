// Guarantees of sampling: the number of rays for a near pair, the weight of a noisy measured lost fraction, and cracks
// that must not count as windows.
#include "base/sampling.h"

#include "patchlight/transport/assemble.h"
#include "patchlight/transport/half_differences.h"
#include "patchlight/transport/lost_share.h"

#include "form_factor/point_polygon.h"
#include "mesh/mesher.h"
#include "support/scenes.h"
#include "transport/closure.h"
#include "visibility/occluder.h"

#include <cmath>
#include <cstdint>
#include <functional>
#include <gtest/gtest.h>
#include <vector>

namespace patchlight::sampling_test {
namespace {

using namespace test;

const Quad floor_square{Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)};

PatchMesh fronts(const Scene& scene, double max_edge) {
  return tessellate(scene, kept_sides(scene, Sides::front), max_edge);
}

Eigen::VectorXd areas(const PatchMesh& mesh) {
  return Eigen::Map<const Eigen::VectorXd>(mesh.area.data(), mesh.size());
}

struct Moments {
  double mean = 0;
  double variance = 0;
};

constexpr int replicates = 256;

Moments moments(const std::function<double(std::uint64_t)>& estimate) {
  double sum = 0;
  double squares = 0;
  for (int k = 1; k <= replicates; ++k) {
    const double value = estimate(static_cast<std::uint64_t>(k));
    sum += value;
    squares += value * value;
  }
  const double mean = sum / replicates;
  return {mean, (squares - replicates * mean * mean) / (replicates - 1)};
}

// The control variate of docs/theory/occluded-form-factors.md by plain loops: the exact value less the mean blocked
// part.
double reference_estimate(const PatchMesh& mesh, const Occluder& occluder, double exact, std::uint32_t rays,
                          std::uint32_t seed) {
  double blocked_weight = 0;
  for (const auto& [u, v, s, t] : scrambled_sobol(rays, seed)) {
    const Point x = square_to_quad(mesh.corner_points(0).points, u, v);
    const PolygonSample y = sample_solid_angle(x, mesh.normal[0], mesh.corner_points(1), s, t);
    const std::vector<Segment> shadow_ray{{x, y.point, 0, 1}};
    if (y.weight > 0 && occluder.occluded(shadow_ray)[0]) blocked_weight += mesh.area[0] * y.weight;
  }
  return exact - blocked_weight / rays;
}

// These pairs have form factors of 0.2 and take most_effort times `samples` rays. A quarter of the rays would give five
// to six times the variance, half of them 2.3 times. The ratio of two variances of 256 replicates has a standard error
// of sqrt(2 * 2 / 256) = 1/8; a limit of 1.5 allows four of these.
TEST(NearPairs, HaveTheVarianceOfAllTheirSamples) {
  const std::vector<Quad> seconds{{Point(0, 0, 1), Point(0, 1, 1), Point(1, 1, 1), Point(1, 0, 1)},   // opposite
                                  {Point(0, 0, 0), Point(0, 1, 0), Point(0, 1, 1), Point(0, 0, 1)}};  // sharing an edge
  const std::vector<std::vector<Point>> blockers{{Point(0, 0, 0.5), Point(1, 0, 0.5), Point(1, 1, 0.5)},
                                                 {Point(0.2, 0, 0.2), Point(0.2, 0.7, 0.2), Point(0.5, 0.4, 0.6)}};
  for (std::size_t k = 0; k < seconds.size(); ++k) {
    const Scene pair = with_quad(with_quad(empty_scene({grey(0.5)}), floor_square), seconds[k]);
    const Scene scene = with_polygon(pair, blockers[k]);
    const PatchMesh mesh = fronts(scene, 2);
    const Occluder occluder(scene);
    const double exact = assemble_exchange_areas(fronts(pair, 2), Occluder(pair)).exchange_areas.at(0, 1);
    for (const int samples : {8, 32}) {
      const Moments assembled = moments([&](std::uint64_t seed) {
        return static_cast<double>(assemble_exchange_areas(mesh, occluder, {samples, seed}).exchange_areas.at(0, 1));
      });
      const Moments reference = moments([&](std::uint64_t seed) {
        return reference_estimate(mesh, occluder, exact, most_effort * static_cast<std::uint32_t>(samples),
                                  hash({seed, 77}));
      });
      EXPECT_GT(assembled.variance, 0);
      EXPECT_LT(assembled.variance, 1.5 * reference.variance) << "pair " << k << ", " << samples << " samples";
      const double standard_error = std::sqrt((assembled.variance + reference.variance) / replicates);
      EXPECT_NEAR(assembled.mean, reference.mean, 4 * standard_error) << "pair " << k << ", " << samples;
    }
  }
}

// A cube without a lid has no occluders, so its rows are exact to 1e-6. The lost fraction measured with 256 rays
// scatters by up to sqrt(p (1 - p) / 256) = 0.03, less with stratification. Closure weighs both. 150 equal entries with
// an error of 2 % give the row sum to 0.02 / sqrt(150) = 0.0016. Therefore at most a few percent of the scatter may
// reach the rows. All of it would if closure took the measured fraction as exact.
TEST(OpenScene, ClosureWeighsTheLostSharesNoise) {
  Scene scene = cube_room(0.5, 1);
  scene.polygons.erase(scene.polygons.begin() + 1);
  const PatchMesh mesh = fronts(scene, 0.2001);
  const Occluder occluder(scene);
  const Eigen::ArrayXd area = areas(mesh).array();
  const ExchangeAreas raw = assemble_exchange_areas(mesh, occluder).exchange_areas;
  const Eigen::ArrayXd exact = row_sums(raw).array() / area;
  const LostShare lost = measure_lost_share(mesh, occluder, 256, 1);
  const ClosedExchangeAreas closed = close_exchange_areas(raw, areas(mesh), lost);
  EXPECT_EQ(closed.method, "least squares, open scene");

  const auto rms = [](const Eigen::ArrayXd& x) { return std::sqrt(x.square().mean()); };
  const double scatter = rms(1 - lost.escaped.array() - lost.at_backs.array() - exact);
  const Eigen::ArrayXd rows = (row_sums(closed.exchange_areas) + closed.remainder).array() / area;
  EXPECT_GT(scatter, 1e-3);
  EXPECT_LT(rms(rows - exact), 0.1 * scatter);
}

// The opposite case: the entries have large errors, the lost fraction is accurate, and the rows must follow it. Every
// entry is 10 % too large; a million rays have a binomial error of 5e-4.
TEST(OpenScene, ClosureMendsEntriesByAWellKnownLostShare) {
  Scene scene = cube_room(0.5, 1);
  scene.polygons.erase(scene.polygons.begin() + 1);
  const PatchMesh mesh = fronts(scene, 0.5001);
  ExchangeAreas raw = assemble_exchange_areas(mesh, Occluder(scene)).exchange_areas;
  const Eigen::ArrayXd exact = row_sums(raw).array() / areas(mesh).array();
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    for (PatchIndex j = i; j < mesh.size(); ++j) raw.set(i, j, 1.1F * raw.at(i, j));
  }
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(mesh.size());
  const ClosedExchangeAreas closed =
      close_exchange_areas(raw, areas(mesh), {(1 - exact).matrix(), zero, zero, 1 << 20});
  const Eigen::ArrayXd rows = (row_sums(closed.exchange_areas) + closed.remainder).array() / areas(mesh).array();
  EXPECT_LT((rows - exact).abs().maxCoeff(), 3 * 5e-4);
}

// A cube whose floor lies 1e-4 m too low. Slits of 4 x 1e-4 m^2 lose that fraction of the rays from its 6 m^2, 41 of
// 614,400. The second try starts up to 5e-4 m, or 1 %, closer to the patch centroid, uniformly distributed, so one ray
// in ten meets the slit again.
TEST(LostRays, OnTheirSecondTryMissTheCrack) {
  Scene scene = cube_room(0.5, 1);
  for (const std::uint32_t corner : scene.polygons[0].corners) scene.vertices[corner].z() -= 1e-4;
  const PatchMesh mesh = fronts(scene, 0.1001);
  ASSERT_EQ(mesh.size(), 600U);
  const LostShare lost = measure_lost_share(mesh, Occluder(scene), 1024, 1);
  const double rays = 1024 * (lost.escaped.sum() + lost.at_backs.sum());
  EXPECT_LT(rays, 41.0 / 4);
}

// A closed box stands on a floor in the plane of its bottom. A ray from the floor below starts in that plane and meets
// nothing; the second try finds the bottom. These patches are fully covered, and no light escapes.
TEST(LostRays, UnderASolidThatStandsOnTheFloorAreCovered) {
  Scene scene = with_box(empty_scene({grey(0.5)}), Point(0, 0, 0), Point(2, 2, 2), true);
  scene = with_box(std::move(scene), Point(0.5, 0.5, 0), Point(1.5, 1.5, 0.7), false);
  const Eigen::Affine3d turned(Eigen::AngleAxisd(0.7, Vector(1, 2, 3).normalized()));
  for (const Scene& place : {scene, moved(scene, turned)}) {
    const PatchMesh mesh = fronts(place, 0.2501);
    const LostShare lost = measure_lost_share(mesh, Occluder(place), 256, 1);
    EXPECT_EQ(lost.escaped.maxCoeff(), 0);
    int covered = 0;
    for (PatchIndex i = 0; i < mesh.size(); ++i) {
      if (mesh.polygon[i] == 0) covered += lost.covered[i] == 1;
    }
    EXPECT_EQ(covered, 16);  // of 8 x 8 floor patches of 1/4 m
  }
}

}  // namespace
}  // namespace patchlight::sampling_test
