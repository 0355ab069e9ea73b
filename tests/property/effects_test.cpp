// Effects that the planner leaves out change the result by less than the requested error, and effects that it simulates
// matter. Each effect is tested with and without simulation, in a scene made for it.
#include "patchlight/simulate.h"

#include "light/photometry.h"
#include "light/spectra.h"
#include "scene/spectral_bands.h"
#include "support/effect_scenes.h"

#include <cmath>
#include <gtest/gtest.h>
#include <utility>
#include <vector>

namespace patchlight::effects_test {
namespace {

using namespace test;

// The solver's relative error is 1e-6; two solutions may differ by twice that, in the norm of the reflected light.
constexpr double solver_error = 2e-6;

// The error of closed forms and quadrature for a pair without shadow rays is 1e-3 (docs/benchmarks/form-factors.md).
// Sampled pairs add a tenth, since their errors have both signs and average out over a row.
constexpr double form_factor_error = 1.1e-3;

// The least difference that an effect must make for its test to be meaningful.
constexpr double clear_difference = 0.02;

// ||H_a - H_b||_A / ||H_b||_A, worst band.
double difference(const Simulation& a, const Simulation& b) {
  const Field& H = b.solution.irradiance;
  const Field apart = a.solution.irradiance - H;
  return (area_norm(apart, b.problem.area) / area_norm(H, b.problem.area)).maxCoeff();
}

// The difference between the planned run, which leaves the effect out, and a run with the effect enabled.
double planned_difference(const Scene& scene, Effect effect, const Request& request) {
  const Simulation planned = simulate(scene, request);
  const Simulation forced = simulate(scene, forcing(effect, request));
  EXPECT_FALSE(decision(planned, effect).simulate);
  EXPECT_FALSE(decision(planned, effect).forced);
  EXPECT_TRUE(decision(forced, effect).simulate);
  EXPECT_TRUE(decision(forced, effect).forced);
  return difference(planned, forced);
}

// The difference between the planned run, which simulates the effect, and a run with the effect disabled.
double skipped_difference(const Scene& scene, Effect effect, Request request) {
  request.mesh.contact_lines = false;  // so that the patches do not depend on the lights
  const Simulation planned = simulate(scene, request);
  const Simulation skipped = simulate(scene, skipping(effect, request));
  EXPECT_TRUE(decision(planned, effect).simulate);
  EXPECT_FALSE(decision(skipped, effect).simulate);
  EXPECT_TRUE(decision(skipped, effect).forced);
  return difference(skipped, planned);
}

// With shadow rays that hit nothing, entries differ only by rounding to float, 6e-8 each.
TEST(Occlusion, IsNotNeededInAnEmptyRoom) {
  EXPECT_LT(planned_difference(lit_box(0.5), Effect::occlusion, coarse()), solver_error + 1e-7);
}

TEST(Occlusion, MattersInAFurnishedRoom) {
  EXPECT_GT(skipped_difference(furnished_room(0.5), Effect::occlusion, coarse()), clear_difference);
}

// The rows of the lamps have the same bits as the matrix; sums of about a hundred terms have another order.
TEST(Interreflection, IsNotNeededWhereNothingReflects) {
  Request raw = coarse();
  raw.assembly.close = false;
  EXPECT_LT(planned_difference(furnished_room(0), Effect::interreflection, raw), 1e-12);
}

TEST(Interreflection, MattersWhereSomethingReflects) {
  EXPECT_GT(skipped_difference(furnished_room(0.5), Effect::interreflection, coarse()), clear_difference);
}

// H = F E and B = E + rho o H without second reflections: the first two terms of the Neumann series.
TEST(Interreflection, SkippedLeavesTheLightOfTheLamps) {
  const Simulation whole = simulate(furnished_room(0.5), coarse());
  Request request = skipping(Effect::interreflection, coarse());
  request.effects.force = {Effect::closure};
  const Simulation direct = simulate(furnished_room(0.5), request);
  EXPECT_LT((direct.solution.irradiance - whole.solution.direct_irradiance).abs().maxCoeff(),
            1e-12 * whole.solution.direct_irradiance.maxCoeff());
  const Field B = direct.problem.exitance + direct.problem.scattering.reflectance * direct.solution.irradiance;
  EXPECT_EQ((direct.solution.radiosity - B).abs().maxCoeff(), 0);
}

TEST(Colour, OneBandStandsForAllOfGreySurfaces) {
  const Scene scene = in_colours(rgb(0.5, 0.5, 0.5), rgb(10, 7, 3), rgb(20, 14, 6));
  EXPECT_LT(planned_difference(scene, Effect::colour, coarse()), solver_error);
  const Simulation planned = simulate(scene, coarse());
  EXPECT_NEAR((planned.solution.irradiance.col(1) / planned.solution.irradiance.col(0) - 0.7).abs().maxCoeff(), 0,
              1e-12);
}

TEST(Colour, MattersWhereSurfacesOrLightsDiffer) {
  const Scene red_walls = in_colours(rgb(0.8, 0.3, 0.1), rgb(10, 10, 10), rgb(20, 20, 20));
  EXPECT_GT(skipped_difference(red_walls, Effect::colour, coarse()), clear_difference);
  const Scene two_lights = in_colours(rgb(0.5, 0.5, 0.5), rgb(10, 7, 3), rgb(1, 1, 1));
  EXPECT_GT(skipped_difference(two_lights, Effect::colour, coarse()), clear_difference);
}

TEST(Colour, SkippedLeavesTheSameLuminanceInAllBands) {
  const Scene scene = in_colours(rgb(0.8, 0.3, 0.1), rgb(10, 7, 3), rgb(20, 14, 6));
  const Simulation skipped = simulate(scene, skipping(Effect::colour, coarse()));
  const Field& H = skipped.solution.irradiance;
  EXPECT_EQ((H.col(0) - H.col(1)).abs().maxCoeff(), 0);
  EXPECT_EQ((H.col(0) - H.col(2)).abs().maxCoeff(), 0);
}

// Irradiance of the patches on the front sides of the first polygons.
Field irradiance_on_first(const Simulation& simulation, PolygonIndex polygons) {
  std::vector<PatchIndex> patches;
  for (PolygonIndex p = 0; p < polygons; ++p) {
    const PatchRange range = simulation.mesh.patches_on(p, Side::front);
    for (PatchIndex i = range.begin; i < range.end; ++i) patches.push_back(i);
  }
  Field H(static_cast<Eigen::Index>(patches.size()), simulation.solution.irradiance.cols());
  for (Eigen::Index k = 0; k < H.rows(); ++k)
    H.row(k) = simulation.solution.irradiance.row(patches[static_cast<std::size_t>(k)]);
  return H;
}

Request automatic(double max_edge = 0.4) {
  Request request = coarse(max_edge);
  request.mesh.sides = Sides::automatic;
  return request;
}

// Dark patches neither emit nor block, but with them other pairs are sampled with rays, whose errors differ. The limit
// is the difference between two solutions with other random points. It is raised by half, as it is a root mean square
// over about a hundred patches.
double noise(const Scene& scene) {
  Request other = automatic();
  other.assembly.seed = 2;
  return 1.5 * difference(simulate(scene, automatic()), simulate(scene, other));
}

TEST(Reach, RoomsWithoutLightNeedNoPatches) {
  const Scene scene = two_rooms(0.5);
  const Simulation planned = simulate(scene, automatic());
  const Simulation forced = simulate(scene, forcing(Effect::reach, automatic()));
  EXPECT_FALSE(decision(planned, Effect::reach).simulate);
  EXPECT_EQ(planned.mesh.patches_on(13, Side::front).begin, planned.mesh.patches_on(13, Side::front).end);
  EXPECT_GT(forced.mesh.size(), planned.mesh.size() + 100);
  constexpr PolygonIndex lit = polygons_of_lit_room;
  const Field H = irradiance_on_first(planned, lit);
  const Field H_forced = irradiance_on_first(forced, lit);
  ASSERT_EQ(H.rows(), H_forced.rows());
  EXPECT_LT(std::sqrt((H - H_forced).square().sum() / H_forced.square().sum()), noise(scene));
  const PatchRange dark = forced.mesh.patches_on(lit, Side::front);
  EXPECT_EQ(forced.solution.irradiance.middleRows(dark.begin, dark.end - dark.begin).abs().maxCoeff(), 0);
}

// A lamp in the second room keeps its sides; without them, the lamp's light would be lost.
TEST(Reach, MattersWhereALampIs) {
  Scene scene = two_rooms(0.5);
  Request left_out = automatic();
  left_out.mesh.kept_sides = kept_sides(scene, Sides::automatic);
  scene = with_quad(std::move(scene), {Point(5.5, 1, 2.4), Point(5.5, 2, 2.4), Point(6, 2, 2.4), Point(6, 1, 2.4)}, 1);
  left_out.mesh.kept_sides->front.push_back(1);
  left_out.mesh.kept_sides->back.push_back(1);
  const Simulation planned = simulate(scene, automatic());
  const Simulation without = simulate(scene, left_out);
  EXPECT_GT(planned.balance.absorbed[0], (1 + clear_difference) * without.balance.absorbed[0]);
  EXPECT_LT(without.balance.escaped[0] + without.balance.lost_at_backs[0] + without.balance.absorbed[0],
            1.01 * without.balance.emitted[0]);
}

TEST(Backs, SidesInTheDarkNeedNoPatches) {
  const Scene scene = furnished_room(0.5);
  const Simulation planned = simulate(scene, automatic());
  const Simulation forced = simulate(scene, forcing(Effect::backs, automatic()));
  EXPECT_FALSE(decision(planned, Effect::backs).simulate);
  EXPECT_GT(forced.mesh.size(), planned.mesh.size() + 100);
  const Field H = irradiance_on_first(planned, 13);
  const Field H_forced = irradiance_on_first(forced, 13);
  ASSERT_EQ(H.rows(), H_forced.rows());
  EXPECT_LT(std::sqrt((H - H_forced).square().sum() / H_forced.square().sum()), noise(scene));
}

// A second lamp outside lights the outer sides, and by reflection a wall beside the room.
TEST(Backs, MatterWhereALampShinesOnThem) {
  Scene scene = furnished_room(0.5);
  scene = with_quad(std::move(scene), {Point(-2, 0, 0), Point(-2, 3, 0), Point(-2, 3, 2.5), Point(-2, 0, 2.5)}, 0);
  scene = with_quad(std::move(scene), {Point(-1.9, 1, 1), Point(-1.9, 2, 1), Point(-1.9, 2, 2), Point(-1.9, 1, 2)}, 1);
  const Simulation planned = simulate(scene, automatic());
  EXPECT_TRUE(planned.plan.sides.back[5]) << "the wall at low x looks at the lamp";
  Request left_out = automatic();
  left_out.mesh.kept_sides = planned.plan.sides;
  for (PolygonIndex p = 0; p < 6; ++p) left_out.mesh.kept_sides->back[p] = 0;
  const Simulation without = simulate(scene, left_out);
  EXPECT_GT(planned.balance.absorbed[0], (1 + clear_difference) * without.balance.absorbed[0]);
}

TEST(Luminaires, MatterWhereTheyAre) {
  EXPECT_FALSE(decision(simulate(furnished_room(0.5), coarse()), Effect::luminaires).simulate);
  EXPECT_GT(
      skipped_difference(with_point_light(furnished_room(0.5), Spectrum::Constant(1, 5)), Effect::luminaires, coarse()),
      clear_difference);
}

// A closed room whose inner sides are kept: rays toward sun and sky end at its walls. Edges are tight to 1e-7 of the
// extent, so a few of 1,024 sky rays per patch may leak.
TEST(Daylight, IsNotNeededInAClosedRoom) {
  const Scene scene = with_daylight(furnished_room(0.5));
  EXPECT_LT(planned_difference(scene, Effect::sun, coarse()), solver_error);
  EXPECT_LT(planned_difference(scene, Effect::sky, coarse()), solver_error);
}

TEST(Daylight, MattersThroughAnOpening) {
  Scene scene = with_daylight(furnished_room(0.5));
  Material glass = grey(0);
  glass.transmittance = Spectrum::Constant(1, 0.8);
  scene.materials.push_back(glass);
  scene.polygons[1].material = 2;
  EXPECT_GT(skipped_difference(scene, Effect::sun, coarse()), clear_difference);
  EXPECT_GT(skipped_difference(scene, Effect::sky, coarse()), clear_difference);
}

TEST(Daylight, MattersThroughAHole) {
  Scene scene = with_daylight(furnished_room(0.5));
  scene.polygons.erase(scene.polygons.begin() + 1);
  EXPECT_GT(skipped_difference(scene, Effect::sun, coarse()), clear_difference);
  EXPECT_GT(skipped_difference(scene, Effect::sky, coarse()), clear_difference);
}

// Without second reflections, closure moves irradiance by the error of the form factors.
TEST(Closure, IsNotNeededWithoutInterreflection) {
  EXPECT_LT(planned_difference(lit_box(0), Effect::closure, coarse()), form_factor_error);
}

// A closed room loses no light. With many reflections, errors of row sums are amplified up to 1 / (1 - rho) times.
// Light lost by raw rows is a random number of either sign, near 0 for some seeds. So the law is about root mean
// squares. The true one is 5e-4; that of 16 normal draws falls below 0.4 of it once in ten thousand times.
TEST(Closure, MattersWithInterreflection) {
  constexpr int seeds = 16;
  double apart = 0;
  double lost_by_raw = 0;
  const auto lost = [](const Simulation& simulation) {
    return simulation.balance.defect.abs().maxCoeff() / simulation.balance.emitted.maxCoeff();
  };
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    Request few = automatic();
    few.assembly.samples = 4;
    few.assembly.seed = seed;
    const Simulation closed = simulate(furnished_room(0.98), few);
    const Simulation raw = simulate(furnished_room(0.98), skipping(Effect::closure, few));
    EXPECT_TRUE(decision(closed, Effect::closure).simulate);
    EXPECT_TRUE(decision(raw, Effect::closure).forced);
    EXPECT_LT(lost(closed), solver_error) << seed;
    apart += std::pow(difference(raw, closed), 2);
    lost_by_raw += std::pow(lost(raw), 2);
  }
  EXPECT_GT(std::sqrt(apart / seeds), 100 * solver_error);
  EXPECT_GT(std::sqrt(lost_by_raw / seeds), 100 * solver_error);
}

// The furnished room in linear RGB with a white lamp or one like a black body of 2700 K.
Scene room_with_walls(const Spectrum& walls, bool is_warm) {
  Scene scene = furnished_room(0.5);
  scene.materials = {{"wall", walls, Spectrum::Zero(3)}, {"lamp", Spectrum::Zero(3), Spectrum::Constant(3, 10)}};
  if (is_warm) scene.materials[1].spectra.light = planckian_spectrum(2700);
  return scene;
}

// ||XYZ_a - XYZ_b||_A / ||XYZ_b||_A of the radiosity, for the worst of X, Y and Z.
double colour_difference_of(const Scene& a, const Scene& b) {
  const Simulation one = simulate(a, coarse()), other = simulate(b, coarse());
  const Field xyz = xyz_rows(other.solution.radiosity, bands_of(b));
  const Field apart = xyz_rows(one.solution.radiosity, bands_of(a)) - xyz;
  return (area_norm(apart, other.problem.area) / area_norm(xyz, other.problem.area)).maxCoeff();
}

TEST(Spectra, BandsThatNothingTellsApartAreNotNeeded) {
  const Scene all = in_wavelength_bands(room_with_walls(rgb(0.5, 0.5, 0.5), true), equal_edges(16));
  const Scene joined = with_alike_bands_joined(all);
  EXPECT_EQ(number_of_bands(joined), 1);
  EXPECT_LT(colour_difference_of(joined, all), solver_error);
}

// White is D65 in bands of wavelengths, so a gray scene has the same result as in linear RGB.
TEST(Spectra, AreNotNeededInAGreyScene) {
  const Scene grey_room = room_with_walls(rgb(0.5, 0.5, 0.5), false);
  EXPECT_LT(colour_difference_of(in_wavelength_bands(grey_room, equal_edges(16)), grey_room),
            5e-4);  // white of Rec. 709
  const Simulation spectral = simulate(in_wavelength_bands(grey_room, equal_edges(16)), coarse());
  const Simulation in_colours = simulate(grey_room, coarse());
  const Bands bands = in_wavelength_bands(grey_room, equal_edges(16)).bands;
  for (Eigen::Index i = 0; i < spectral.solution.radiosity.rows(); ++i) {
    EXPECT_NEAR(luminance(spectral.solution.radiosity.row(i), bands) / luminance(in_colours.solution.radiosity.row(i)),
                1, 1e-6);
    const Eigen::Vector3d shown =
        rgb_from_xyz() * xyz_of(spectral.solution.radiosity.row(i), bands) / luminous_efficacy;
    EXPECT_LT((shown.transpose().array() / in_colours.solution.radiosity.row(i) - 1).abs().maxCoeff(), 1e-6);
  }
}

TEST(Spectra, MatterWithColouredWallsUnderAWarmLamp) {
  const Scene scene = room_with_walls(rgb(0.8, 0.2, 0.05), true);
  EXPECT_GT(colour_difference_of(in_rgb(scene), in_wavelength_bands(scene, equal_edges(32))), clear_difference);
}

}  // namespace
}  // namespace patchlight::effects_test
