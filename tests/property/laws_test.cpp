// Laws that every run obeys.
#include "patchlight/simulate.h"
#include "patchlight/transport/assemble.h"
#include "patchlight/transport/lost_share.h"

#include "mesh/mesher.h"
#include "support/scenes.h"
#include "transport/closure.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <numeric>
#include <utility>
#include <vector>

namespace patchlight::laws_test {
namespace {

using namespace test;

Request coarse(double max_edge = 0.4) {
  Request request;
  request.mesh.max_edge = max_edge;
  request.mesh.sides = Sides::front;
  return request;
}

// The furnished room without its ceiling, so that light escapes.
Scene open_room(double reflectance) {
  Scene scene = furnished_room(reflectance);
  scene.polygons.erase(scene.polygons.begin() + 1);
  return scene;
}

bool same_bits(const Field& a, const Field& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() &&
         std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(double)) == 0;
}

TEST(ExchangeAreas, AreSymmetricToTheBitAndZeroInOnePlane) {
  const Scene scene = furnished_room(0.5);
  const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), 0.4);
  const ExchangeAreas S = assemble_exchange_areas(mesh, Occluder(scene)).exchange_areas;
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    for (PatchIndex j = 0; j < mesh.size(); ++j) {
      ASSERT_EQ(S.at(i, j), S.at(j, i));
      ASSERT_GE(S.at(i, j), 0);
      if (mesh.polygon[i] == mesh.polygon[j]) {
        ASSERT_EQ(S.at(i, j), 0);
      }
    }
  }
}

TEST(ExchangeAreas, AreNeverMoreThanUnoccluded) {
  // The same patches with the occluders of an empty scene: a single polygon that hides nothing.
  const Scene scene = furnished_room(0.5);
  const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), 0.4);
  const Scene nothing =
      with_quad(empty_scene({grey(0)}), {Point(0, 0, -9), Point(1, 0, -9), Point(1, 1, -9), Point(0, 1, -9)});
  const ExchangeAreas occluded = assemble_exchange_areas(mesh, Occluder(scene)).exchange_areas;
  const ExchangeAreas free = assemble_exchange_areas(mesh, Occluder(nothing)).exchange_areas;
  bool some_less = false;
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    for (PatchIndex j = 0; j < mesh.size(); ++j) {
      ASSERT_LE(occluded.at(i, j), free.at(i, j));
      some_less = some_less || occluded.at(i, j) < free.at(i, j);
    }
  }
  EXPECT_TRUE(some_less);
}

TEST(Closure, MakesTheRowsOfAClosedRoomExact) {
  const Scene scene = furnished_room(0.5);
  const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), 0.4);
  const Occluder occluder(scene);
  const LostShare lost = measure_lost_share(mesh, occluder, 256, 1);
  ASSERT_FALSE(lost.closed());  // rays meet the lamp's back, which is one-sided

  // With the lamp's back kept, the room is closed.
  KeptSides sides = kept_sides(scene, Sides::front);
  sides.back[12] = 1;
  const PatchMesh closed_mesh = tessellate(scene, sides, 0.4);
  const LostShare none = measure_lost_share(closed_mesh, occluder, 256, 1);
  ASSERT_TRUE(none.closed());
  const Eigen::VectorXd area = Eigen::Map<const Eigen::VectorXd>(closed_mesh.area.data(), closed_mesh.size());
  const ClosedExchangeAreas closed =
      close_exchange_areas(assemble_exchange_areas(closed_mesh, occluder).exchange_areas, area, none);
  const Eigen::ArrayXd sums = (row_sums(closed.exchange_areas) + closed.remainder).array() / area.array();
  EXPECT_LT((sums - 1).abs().maxCoeff(), 1e-9);
  EXPECT_GE(closed.remainder.minCoeff(), 0);
  EXPECT_LT((closed.remainder.array() / area.array()).maxCoeff(), 1e-7);
}

TEST(Closure, LeavesTwoPlatesThatCannotBeClosedAlone) {
  // Two opposed plates of different size: no symmetric matrix between them has both areas as row sums.
  Scene scene = with_quad(empty_scene({grey(0.5)}), {Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)});
  scene = with_quad(std::move(scene), {Point(0, 0, 1), Point(0, 2, 1), Point(1, 2, 1), Point(1, 0, 1)});
  const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), 0.5);
  const ExchangeAreas raw = assemble_exchange_areas(mesh, Occluder(scene)).exchange_areas;
  const Eigen::VectorXd area = Eigen::Map<const Eigen::VectorXd>(mesh.area.data(), mesh.size());
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(mesh.size());
  const ClosedExchangeAreas closed = close_exchange_areas(raw, area, {zero, zero, zero, 256});
  EXPECT_EQ(closed.method.substr(0, 4), "none");
  EXPECT_EQ(row_sums(closed.exchange_areas), row_sums(raw));
}

TEST(Closure, DoesNotCloseAnOpenRoom) {
  const Scene scene = open_room(0.5);
  const Simulation simulation = simulate(scene, coarse());
  // A floor patch in the middle sees at least a third of the open ceiling, so its row sum is far below 1.
  EXPECT_LT(simulation.transport.row_sum.minCoeff(), 0.7);
  const Eigen::ArrayXd seen =
      1 - simulation.transport.lost.escaped.array() - simulation.transport.lost.at_backs.array();
  // 256 rays give a fraction to 0.031 at worst (binomial, less with stratification); the limit is three of these.
  EXPECT_LT((simulation.transport.row_sum.array() - seen).abs().maxCoeff(), 0.1);
}

TEST(Simulate, GivesTheSameBitsForAnyThreadCountAndEveryRun) {
  const Scene scene = furnished_room(0.6);
  Request one = coarse();
  one.resources.threads = 1;
  Request two = coarse();
  two.resources.threads = 2;
  const Simulation first = simulate(scene, one);
  const Simulation again = simulate(scene, one);
  const Simulation threaded = simulate(scene, two);
  EXPECT_TRUE(same_bits(first.solution.radiosity, again.solution.radiosity));
  EXPECT_TRUE(same_bits(first.solution.radiosity, threaded.solution.radiosity));
  EXPECT_TRUE(same_bits(first.solution.irradiance, threaded.solution.irradiance));
}

TEST(Simulate, ASeedChangesTheSamplesAndLittleElse) {
  const Scene scene = furnished_room(0.6);
  Request other = coarse();
  other.assembly.seed = 2;
  const Field first = simulate(scene, coarse()).solution.irradiance;
  const Field second = simulate(scene, other).solution.irradiance;
  const double rms = std::sqrt((first - second).square().mean()) / first.mean();
  EXPECT_GT(rms, 1e-6);
  // The default samples give a partly hidden entry to about 10 %, and such entries carry about a fifth of the light.
  EXPECT_LT(rms, 0.05);
}

TEST(Simulate, BalancesEnergy) {
  for (const Scene& scene : {furnished_room(0.8), open_room(0.8)}) {
    const Simulation simulation = simulate(scene, coarse());
    EXPECT_LT(simulation.balance.imbalance, 1e-6);
    // The form factors lose or gain little beyond the measured lost fractions.
    EXPECT_LT(std::abs(simulation.balance.defect[0]), 0.01 * simulation.balance.emitted[0]);
  }
}

TEST(Simulate, IsLinearInTheLamps) {
  // Twice the exitance gives twice the radiosity: scaling by 2 is exact in floating point.
  const Simulation once = simulate(furnished_room(0.6, 5), coarse());
  const Simulation twice = simulate(furnished_room(0.6, 10), coarse());
  EXPECT_TRUE(same_bits(2 * once.solution.radiosity, twice.solution.radiosity));
}

// Root mean square difference in irradiance between two runs, relative to the mean; `order` maps the patches of `a` to
// `b`.
double difference(const Simulation& a, const Simulation& b, const std::vector<PatchIndex>& order) {
  double sum = 0;
  for (PatchIndex i = 0; i < a.mesh.size(); ++i) {
    const double change = b.solution.irradiance(order[i], 0) - a.solution.irradiance(i, 0);
    sum += change * change;
  }
  return std::sqrt(sum / a.mesh.size()) / a.solution.irradiance.mean();
}

TEST(Simulate, DoesNotDependOnPositionAndScale) {
  // Random points follow from the places of patches in the scene's own frame. Only shadow rays that graze an edge
  // differ: one of the 16 rays of a single entry shifts a patch's irradiance by at most 1e-4.
  const Simulation here = simulate(furnished_room(0.6), coarse());
  std::vector<PatchIndex> same(here.mesh.size());
  std::iota(same.begin(), same.end(), PatchIndex{0});
  const Eigen::Affine3d turned(Eigen::AngleAxisd(0.7, Vector(1, 2, 3).normalized()));
  const Eigen::Affine3d far(Eigen::Translation3d(1e6, -1e6, 1e6));
  const Eigen::Affine3d small(Eigen::UniformScaling<double>(1e-3));
  for (const auto& [motion, scale] : {std::pair{turned, 1.0}, std::pair{far, 1.0}, std::pair{small, 1e-3}}) {
    const Simulation there = simulate(moved(furnished_room(0.6), motion), coarse(0.4 * scale));
    ASSERT_EQ(there.mesh.size(), here.mesh.size());
    EXPECT_LT(difference(here, there, same), 1e-4);
    EXPECT_EQ(there.solution.history.size(), here.solution.history.size());
  }
}

TEST(Simulate, DoesNotDependOnTheOrderOfTheFaces) {
  const Scene scene = furnished_room(0.6);
  Scene reversed = scene;
  std::reverse(reversed.polygons.begin(), reversed.polygons.end());
  const Simulation here = simulate(scene, coarse());
  const Simulation there = simulate(reversed, coarse());
  std::vector<PatchIndex> order;
  for (PatchIndex i = 0; i < here.mesh.size(); ++i) {
    const auto polygon = static_cast<PolygonIndex>(scene.polygons.size()) - 1 - here.mesh.polygon[i];
    order.push_back(there.mesh.patches_on(polygon, Side::front).begin + i -
                    here.mesh.patches_on(here.mesh.polygon[i], Side::front).begin);
  }
  EXPECT_LT(difference(here, there, order), 1e-4);
}

class DividedRoom : public testing::TestWithParam<double> {};

TEST_P(DividedRoom, StaysDarkBehindTheWall) {
  const double rise = GetParam();
  // A closed room divided by a wall without thickness, with a level or tilted lamp on one side: the other side must be
  // exactly dark. The tilted lamp sees only a small part of some patches.
  Scene scene = with_box(empty_scene({grey(0.8), grey(0, 10)}), Point(0, 0, 0), Point(2, 1, 1), true);
  scene = with_quad(std::move(scene), {Point(1, 0, 0), Point(1, 1, 0), Point(1, 1, 1), Point(1, 0, 1)});
  scene = with_quad(std::move(scene),
                    {Point(.3, .3, .7), Point(.3, .6, .7), Point(.6, .6, .7 + rise), Point(.6, .3, .7 + rise)}, 1);
  Request request = coarse(0.25);
  request.mesh.sides = Sides::both;
  const Simulation simulation = simulate(scene, request);
  double lit = 0;
  double dark = 0;
  for (PatchIndex i = 0; i < simulation.mesh.size(); ++i) {
    // Patch edges of 0.25 m end at the wall at x = 1, so no patch straddles it.
    const double flux = simulation.mesh.area[i] * simulation.solution.irradiance(i, 0);
    const bool behind =
        simulation.mesh.centroid[i].x() > 1 || (simulation.mesh.polygon[i] == 6 && simulation.mesh.normal[i].x() > 0);
    (behind ? dark : lit) += flux;
  }
  EXPECT_GT(lit, 1);
  EXPECT_LE(dark, 1e-9 * lit);
}

INSTANTIATE_TEST_SUITE_P(LampRises, DividedRoom, testing::Values(0.0, 0.1, -0.1));

TEST(Simulate, PatchesInsideASolidTakeNoPart) {
  // A box without a bottom stands on the floor: floor patches below it see only its backs. Half-covered patches keep
  // the irradiance of their exposed half.
  Scene scene = with_box(empty_scene({grey(0.5), grey(0, 10)}), Point(0, 0, 0), Point(2, 2, 2), true);
  scene.polygons[1].material = 1;
  const Scene empty = scene;
  scene = with_box(std::move(scene), Point(0.5, 0.5, 0), Point(1.5, 1.5, 0.01), false);
  scene.polygons.erase(scene.polygons.begin() + 6);
  Request request = coarse(0.2);
  request.mesh.contact_lines = false;
  const Simulation flat = simulate(scene, request);
  for (PatchIndex i = 0; i < flat.mesh.size(); ++i) {
    if (flat.mesh.polygon[i] != 0) continue;
    const Vector from_centre = flat.mesh.centroid[i] - Point(1, 1, 0);
    const double reach = from_centre.cwiseAbs().maxCoeff();
    const double expected = reach < 0.4 - 1e-9 ? 1 : reach > 0.6 + 1e-9 ? 0 : -1;
    if (expected >= 0) {
      EXPECT_NEAR(flat.transport.lost.covered[i], expected, 1e-12);
    }
  }
  // The box is only 1 cm high, so the floor around it is lit as in the empty room. Patch edges are 0.2 m, and the box
  // ends in the middle of patches.
  const Simulation without = simulate(empty, request);
  double worst = 0;
  for (PatchIndex i = 0; i < 100; ++i) {
    if (flat.transport.lost.covered[i] < 0.99) {
      const double change = flat.solution.irradiance(i, 0) / without.solution.irradiance(i, 0) - 1;
      worst = std::max(worst, std::abs(change));
    }
  }
  // 32 stratified points give a half-covered fraction to about 1 / 32.
  EXPECT_LT(worst, 0.1);
}

}  // namespace
}  // namespace patchlight::laws_test
