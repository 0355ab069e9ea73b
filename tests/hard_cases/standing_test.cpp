// Solids that are closed only by the face below them.
#include "patchlight/form_factors.h"
#include "patchlight/simulate.h"

#include "accuracy/errors.h"
#include "optics/surface_optics.h"
#include "support/scenes.h"

#include <cmath>
#include <gtest/gtest.h>
#include <tuple>
#include <utility>

namespace patchlight::standing_test {
namespace {

using namespace test;

// A room with a lamp under its ceiling and a block on its floor. The block's bottom, if any, is polygon 13.
Scene room_with_block(bool bottom) {
  Scene scene = with_box(empty_scene({grey(0.6), grey(0, 10)}), Point(0, 0, 0), Point(4, 3, 2.5), true);
  scene =
      with_quad(std::move(scene), {Point(1.5, 1, 2.4), Point(1.5, 2, 2.4), Point(2.5, 2, 2.4), Point(2.5, 1, 2.4)}, 1);
  for (const Quad& face : box_faces(Point(1.1, 0.9, 0), Point(2.3, 1.7, 1), false)) {
    const bool is_bottom = face[0].z() + face[1].z() + face[2].z() == 0;
    if (bottom || !is_bottom) scene = with_quad(std::move(scene), face);
  }
  return scene;
}

// Floor patches that extend under the block send no light into it. The inside is dark, and elsewhere the light matches
// that around a closed block within the bars. The bar of a patch is one standard error of either solution.
TEST(StandingBlock, WithoutABottomIsDarkInside) {
  Request request;
  request.mesh.patches = 300;
  request.accuracy.error_bars = true;
  const Simulation open = simulate(room_with_block(false), request);
  const Simulation closed = simulate(room_with_block(true), request);
  for (PatchIndex i = 0; i < open.mesh.size(); ++i) {
    const bool of_block = open.mesh.polygon[i] >= 7;
    EXPECT_TRUE(!of_block || open.mesh.side[i] == Side::front) << "patch " << i;
  }
  const Field bar_open = open.error_bars->total();
  const Field bar_closed = closed.error_bars->total();
  // The room's own patches are the same in both.
  PatchIndex compared = 0;
  double largest = 0;
  for (PatchIndex i = 0; i < std::min(open.mesh.size(), closed.mesh.size()) && open.mesh.polygon[i] < 6; ++i) {
    ASSERT_EQ(open.mesh.centroid[i], closed.mesh.centroid[i]);
    const double bar = std::hypot(bar_open(i, 0), bar_closed(i, 0));
    largest = std::max(largest, std::abs(open.solution.radiosity(i, 0) - closed.solution.radiosity(i, 0)) / bar);
    ++compared;
  }
  EXPECT_GT(compared, 100U);
  EXPECT_LT(largest, 4);
}

// A black floor of 4 x 4 m under the sun at the zenith, and a block that covers parts of four of its patches of 1 m.
Scene block_in_the_sun(bool bottom, double size, bool rug) {
  Scene scene = with_quad(empty_scene({grey(0)}), {Point(0, 0, 0), Point(4, 0, 0), Point(4, 4, 0), Point(0, 4, 0)});
  for (const Quad& face : box_faces(Point(1.25, 1.25, 0), Point(2.75, 2.75, 1), false)) {
    const bool is_bottom = face[0].z() + face[1].z() + face[2].z() == 0;
    if (bottom || !is_bottom) scene = with_quad(std::move(scene), face);
  }
  if (rug)
    scene =
        with_quad(std::move(scene), {Point(3.2, 3.1, 0), Point(3.9, 3.1, 0), Point(3.9, 3.8, 0), Point(3.2, 3.8, 0)});
  scene = moved(std::move(scene), Eigen::Affine3d(Eigen::Scaling(size)));
  scene.up = Vector::UnitZ();
  scene.sun = Sun{Vector::UnitZ(), Spectrum::Constant(1, 100)};
  return scene;
}

// With and without a bottom; meters and millimeters; storage; with and without a rug on the same floor.
class BlockInTheSun : public testing::TestWithParam<std::tuple<bool, double, Storage, bool>> {};

Simulation solved_in_the_sun(const std::tuple<bool, double, Storage, bool>& of, bool contact_lines) {
  const auto& [bottom, size, storage, rug] = of;
  Request request;
  request.mesh.max_edge = 1.001 * size;
  request.mesh.sides = Sides::front;
  request.mesh.contact_lines = contact_lines;
  request.assembly.storage = storage;
  if (storage == Storage::rays) request.solver.solver = Solver::gmres;
  return simulate(block_in_the_sun(bottom, size, rug), request);
}

// The part of a patch beside the block gets 100 W/m^2, within four times the error of the exposed fraction. All light
// arrives, 100 W for each m^2 of the floor, on whichever face it falls.
TEST_P(BlockInTheSun, StandsOnPatchesThatAreLitBesideIt) {
  const double size = std::get<1>(GetParam());
  const Simulation lit = solved_in_the_sun(GetParam(), false);
  EXPECT_NEAR(lit.balance.arriving[0], 1600 * size * size, 0.001 * 1600 * size * size);
  const Eigen::ArrayXd error = exposure_errors(lit.transport.lost);
  int partly_covered = 0;
  for (PatchIndex i = 0; i < lit.mesh.size(); ++i) {
    if (lit.mesh.polygon[i] != 0 || lit.transport.lost.covered[i] > 0.99) continue;
    EXPECT_NEAR(lit.solution.irradiance(i, 0), 100, 1e-6 + 400 * error[i]) << "patch " << i;
    partly_covered += lit.transport.lost.covered[i] > 0.1 ? 1 : 0;
  }
  EXPECT_GE(partly_covered, 4);
}

// Patches end at the block, and none are left below it. All patches beside it get 100 W/m^2.
TEST_P(BlockInTheSun, HasNoPatchesBelow) {
  const double size = std::get<1>(GetParam());
  const Simulation lit = solved_in_the_sun(GetParam(), true);
  EXPECT_NEAR(lit.balance.arriving[0], 1600 * size * size, 0.001 * 1600 * size * size);
  double area = 0;
  for (PatchIndex i = 0; i < lit.mesh.size(); ++i) {
    if (lit.mesh.polygon[i] != 0) continue;
    EXPECT_NEAR(lit.solution.irradiance(i, 0), 100, 1e-6) << "patch " << i;
    EXPECT_EQ(lit.transport.lost.covered[i], 0) << "patch " << i;
    area += lit.mesh.area[i];
  }
  EXPECT_NEAR(area, (16 - 2.25 - (std::get<3>(GetParam()) ? 0.49 : 0)) * size * size, 1e-12 * size * size);
}

INSTANTIATE_TEST_SUITE_P(HardCases, BlockInTheSun,
                         testing::Combine(testing::Bool(), testing::Values(1.0, 1e-3),
                                          testing::Values(Storage::tiles, Storage::rays), testing::Bool()));

class BlockLitByABall : public testing::TestWithParam<Storage> {};

// No ray finds an exposed part of a patch that lies entirely under the block; its exposed area counts as a millionth.
// The uncertain light at the soft edge of the shadow must not be multiplied by a million. No standard error exceeds the
// irradiance without a shadow.
TEST_P(BlockLitByABall, LeavesNoErrorUnderIt) {
  Scene scene = with_box(empty_scene({grey(0.6)}), Point(0, 0, 0), Point(4, 3, 2.5), true);
  for (const Quad& face : box_faces(Point(1.1, 0.9, 0), Point(2.3, 1.7, 1), false))
    scene = with_quad(std::move(scene), face);
  scene.luminaires.resize(1);
  scene.luminaires[0].position = Point(3, 2.2, 2);
  scene.luminaires[0].light = SphericalLamp{0.2, Spectrum::Ones(1)};
  Request request;
  request.mesh.max_edge = 0.21;
  request.mesh.contact_lines = false;
  request.assembly.storage = GetParam();
  request.solver.solver = Solver::gmres;
  const Simulation lit = simulate(scene, request);
  const double most = lit.problem.direct_irradiance.maxCoeff();
  int under = 0;
  for (PatchIndex i = 0; i < lit.mesh.size(); ++i) {
    if (lit.mesh.polygon[i] != 0 || lit.transport.lost.covered[i] < 1) continue;
    EXPECT_EQ(lit.problem.direct_irradiance(i, 0), 0) << "patch " << i;
    ++under;
  }
  EXPECT_GT(under, 10);
  EXPECT_LT(lit.direct_standard_error.maxCoeff(), most);
}

INSTANTIATE_TEST_SUITE_P(HardCases, BlockLitByABall, testing::Values(Storage::tiles, Storage::rays));

// The same on a clear floor of transmittance 0.5 with known form factors, e.g. from a folder, which do not depend on
// materials. Each m^2 of floor beside the block receives 100 W times the fraction that is not transmitted. The top of
// 2.25 m^2 receives 100 W/m^2.
TEST(BlockOnAPane, IsLitAroundWithKnownFormFactors) {
  Scene scene = block_in_the_sun(true, 1, false);
  scene.materials.push_back(scene.materials[0]);
  scene.materials[0].transmittance = Spectrum::Constant(1, 0.5);
  for (std::size_t p = 1; p < scene.polygons.size(); ++p) scene.polygons[p].material = 1;
  Request request;
  request.mesh.max_edge = 1.001;
  request.mesh.sides = Sides::front;
  Exchange known = find_form_factors(scene, request).exchange;
  known.lost.clear = {};
  const Simulation lit = simulate(scene, request, {}, {.exchange = [&](const PatchMesh&) { return known; }});
  const double expected = 100 * SurfaceOptics(scene).nonspecular_fraction(0, Side::front) * (16 - 2.25) + 225;
  EXPECT_NEAR(lit.balance.arriving[0], expected, 0.001 * expected);
}

}  // namespace
}  // namespace patchlight::standing_test
