#include "patchlight/base/error.h"
#include "patchlight/simulate.h"
#include "patchlight/solve/solve.h"

#include "base/vectors.h"
#include "mesh/nested_mesh.h"
#include "support/scenes.h"
#include "verify/path_tracer.h"

#include <Eigen/LU>
#include <cmath>
#include <gtest/gtest.h>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace patchlight::sheets_test {
namespace {

using namespace test;

Material sheet(double reflectance, double tau, double exitance = 0) {
  Material material = grey(reflectance, exitance);
  material.name = "paper";
  material.diffuse_transmittance = Spectrum::Constant(1, tau);
  return material;
}

Request fronts(PatchIndex patches, Storage storage) {
  Request request;
  request.mesh.sides = Sides::front;
  request.mesh.patches = patches;
  request.assembly.storage = storage;
  request.solver.solver = Solver::gmres;
  return request;
}

// The polygon of the sheet that divides the room at x = 2.
constexpr PolygonIndex dividing = 6;

// A closed room of 4 x 3 x 2.5 m, divided by a sheet. Material 0 is the room, 1 the sheet, 2 the wall at high x, 3 the
// wall at low x.
Scene divided_room(std::vector<Material> materials) {
  Scene scene = empty_scene(std::move(materials));
  const std::vector<Quad> faces = box_faces(Point(0, 0, 0), Point(4, 3, 2.5), true);
  for (std::size_t k = 0; k < faces.size(); ++k) {
    const MaterialIndex material = k == 3 ? 2 : k == 5 ? 3 : 0;
    scene = with_quad(std::move(scene), faces[k], material);
  }
  return with_quad(std::move(scene), {Point(2, 0, 0), Point(2, 3, 0), Point(2, 3, 2.5), Point(2, 0, 2.5)}, 1);
}

// Only the wall at low x emits, and a box touches the sheet on that side.
Scene lit_from_one_side(double tau) {
  const Scene scene = divided_room({grey(0.6), sheet(0.3, tau), grey(0.5), grey(0, 10)});
  return with_box(scene, Point(1.4, 0.8, 0), Point(2, 1.7, 1.1), false);
}

double flux_on(const Simulation& simulation, PolygonIndex polygon, Side side) {
  double flux = 0;
  const PatchRange range = simulation.mesh.patches_on(polygon, side);
  for (PatchIndex i = range.begin; i < range.end; ++i)
    flux += simulation.problem.area[i] * simulation.solution.irradiance(i, 0);
  return flux;
}

double exposed_area(const Simulation& simulation, PolygonIndex polygon, Side side) {
  const PatchRange range = simulation.mesh.patches_on(polygon, side);
  return simulation.problem.area.segment(range.begin, range.end - range.begin).sum();
}

std::string refusal_of(const Scene& scene, const Request& request) {
  try {
    simulate(scene, request);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

// Storage, reflectance and transmittance of the sheet.
class SheetFurnace : public testing::TestWithParam<std::tuple<Storage, double, double>> {};

TEST_P(SheetFurnace, IsOne) {
  // Walls emit 1 - rho, and both sides of the sheet 1 - rho - tau: B = H = 1 everywhere.
  const auto [storage, rho, tau] = GetParam();
  const Material wall = grey(0.6, 0.4);
  Scene scene = divided_room({wall, sheet(rho, tau, 1 - rho - tau), wall, wall});
  scene.polygons[dividing].back_material = MaterialIndex{1};
  const Simulation simulation = simulate(scene, fronts(600, storage));
  EXPECT_EQ(simulation.mesh.sheets.size(), tau > 0 ? 1 : 0);
  EXPECT_LT((simulation.solution.radiosity - 1).abs().maxCoeff(), 1e-3);
  EXPECT_LT(simulation.balance.imbalance, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(HardCases, SheetFurnace,
                         testing::Combine(testing::Values(Storage::tiles, Storage::rays),
                                          testing::Values(0.0, 0.1, 0.4), testing::Values(0.0, 0.4, 0.6)));

double mean_on(const Simulation& simulation, PolygonIndex polygon, Side side) {
  return flux_on(simulation, polygon, side) / exposed_area(simulation, polygon, side);
}

TEST(Sheet, BetweenInfinitePlates) {
  // The walls between the plates are perfect mirrors, so each plate sees only the sheet:
  // B_1 = E_1 + rho_1 B_b, B_b = E + rho B_1 + tau B_2, B_f = E + rho B_2 + tau B_1, B_2 = E_2 + rho_2 B_f.
  // All surfaces emit similar amounts, because bright lamps are handled separately and seen over a limited number of
  // mirrors.
  const double E_1 = 3, E_2 = 2.5, E = 2, rho_1 = 0.2, rho_2 = 0.7, rho = 0.3, tau = 0.5;
  Material mirror = grey(0);
  mirror.specular_reflectance = Spectrum::Ones(1);
  Scene scene = divided_room({mirror, sheet(rho, tau, E), grey(rho_2, E_2), grey(rho_1, E_1)});
  scene.polygons[dividing].back_material = MaterialIndex{1};
  const Simulation simulation = simulate(scene, fronts(600, Storage::rays));
  Eigen::Matrix2d K;
  K << rho_1 * rho, rho_1 * tau, rho_2 * tau, rho_2 * rho;
  const Eigen::Vector2d B =
      (Eigen::Matrix2d::Identity() - K).inverse() * Eigen::Vector2d(E_1 + rho_1 * E, E_2 + rho_2 * E);
  // Mirrors absorb at least 1e-6; one ray in 10,000 meets mirrors more than 64 times.
  EXPECT_NEAR(mean_on(simulation, dividing, Side::back) / B[0], 1, 1e-3);
  EXPECT_NEAR(mean_on(simulation, dividing, Side::front) / B[1], 1, 1e-3);
  EXPECT_NEAR(mean_on(simulation, 5, Side::front) / (E + rho * B[0] + tau * B[1]), 1, 1e-3);
  EXPECT_NEAR(mean_on(simulation, 3, Side::front) / (E + rho * B[1] + tau * B[0]), 1, 1e-3);
}

// Flux from the wall at high x to the wall at low x, or the other way round.
double flux_across(bool from_low, double rho_back) {
  const Material lamp = grey(0.5, 1), dark = grey(0.5);
  Material back = sheet(rho_back, 0.4);
  Scene scene = divided_room({grey(0.6), sheet(0.2, 0.4), from_low ? dark : lamp, from_low ? lamp : dark, back});
  scene.polygons[dividing].back_material = MaterialIndex{4};
  scene = with_box(std::move(scene), Point(1.4, 0.8, 0), Point(2, 1.7, 1.1), false);
  Request request = fronts(800, Storage::tiles);
  request.mesh.max_edge = 0.3;
  request.mesh.patches.reset();
  return flux_on(simulate(scene, request), from_low ? 3 : 5, Side::front);
}

TEST(Sheet, LetsLightThroughAlikeBothWays) {
  // R is self-adjoint even if the sides reflect differently and a box touches one of them. The solver's error is 1e-6.
  for (const double rho_back : {0.2, 0.6})
    EXPECT_NEAR(flux_across(true, rho_back) / flux_across(false, rho_back), 1, 1e-5) << rho_back;
}

class LitSheet : public testing::TestWithParam<Storage> {};

TEST_P(LitSheet, LosesNothing) {
  const Simulation simulation = simulate(lit_from_one_side(0.5), fronts(1500, GetParam()));
  EXPECT_LT(simulation.balance.imbalance, 1e-3);
  EXPECT_NEAR(simulation.balance.absorbed[0] / simulation.balance.emitted[0], 1, 1e-3);
  const Simulation dark = simulate(lit_from_one_side(0), fronts(1500, GetParam()));
  EXPECT_GT(flux_on(simulation, 3, Side::front), 0.5);
  EXPECT_EQ(flux_on(dark, 3, Side::front), 0);
}

TEST_P(LitSheet, LightsBothRoomsAsPathsDo) {
  // Means over whole faces, against path tracing without patches.
  const Scene scene = lit_from_one_side(0.5);
  const Simulation simulation = simulate(scene, fronts(3000, GetParam()));
  const KeptSides sides = kept_sides(scene, Sides::front);
  for (const auto& [polygon, side] : {std::pair(PolygonIndex{0}, Side::front), std::pair(PolygonIndex{3}, Side::front),
                                      std::pair(dividing, Side::front), std::pair(dividing, Side::back)}) {
    const PatchRange range = simulation.mesh.patches_on(polygon, side);
    const auto count = static_cast<Eigen::Index>(range.end - range.begin);
    std::vector<PathReceiver> receivers;
    for (PatchIndex i = range.begin; i < range.end; ++i)
      receivers.push_back({simulation.mesh.corner_points(i).points, polygon, side});
    const PathEstimate paths = trace_irradiance(scene, sides, receivers, {.paths = 512});
    const Eigen::ArrayXd area = simulation.problem.area.segment(range.begin, count).array();
    const double flux = (area * paths.irradiance.col(0)).sum();
    const double noise = (area * paths.standard_error.col(0)).matrix().norm() / flux;
    EXPECT_NEAR(flux_on(simulation, polygon, side) / flux, 1, 0.005 + 4 * noise) << polygon << name_of(side);
    EXPECT_LT(noise, 0.02);
  }
}

TEST_P(LitSheet, GivesTheSameBitsOnOneThreadAndOnTwo) {
  Request request = fronts(500, GetParam());
  request.resources.threads = 1;
  const Simulation one = simulate(lit_from_one_side(0.5), request);
  request.resources.threads = 2;
  const Simulation two = simulate(lit_from_one_side(0.5), request);
  EXPECT_TRUE((one.solution.radiosity == two.solution.radiosity).all());
}

TEST_P(LitSheet, ThatLetsNothingThroughIsAWall) {
  Scene wall = lit_from_one_side(0);
  wall.materials[1].diffuse_transmittance = Spectrum();
  const Simulation one = simulate(wall, fronts(500, GetParam()));
  const Simulation other = simulate(lit_from_one_side(0), fronts(500, GetParam()));
  EXPECT_TRUE(other.mesh.sheets.empty());
  EXPECT_TRUE((one.solution.radiosity == other.solution.radiosity).all());
}

TEST_P(LitSheet, IsCutAlikeOnBothSides) {
  // The same if the light differs and a box touches one side: a patch there has no counterpart on the other side.
  Request request = fronts(300, GetParam());
  request.accuracy.relative_error = 0.03;
  const Simulation simulation = simulate(lit_from_one_side(0.5), request);
  const PatchMesh& mesh = simulation.mesh;
  const Scattering& scattering = simulation.problem.scattering;
  EXPECT_EQ(scattering.other_side, other_sides(mesh));
  const PatchRange lit = mesh.patches_on(dividing, Side::back);
  ASSERT_LT(lit.begin, lit.end);
  for (PatchIndex i = lit.begin; i < lit.end; ++i) {
    const PatchIndex behind = scattering.other_side[i];
    ASSERT_EQ(mesh.side[behind], Side::front);
    EXPECT_EQ(scattering.other_side[behind], i);
    EXPECT_NEAR(mesh.area[behind], mesh.area[i], 1e-12);
    EXPECT_LT((mesh.centroid[behind] - mesh.centroid[i]).norm(), 1e-12);
    const double there = simulation.problem.area[behind] * scattering.transmittance(behind, 0);
    EXPECT_NEAR(simulation.problem.area[i] * scattering.transmittance(i, 0), there, 1e-12);
  }
  EXPECT_LT(simulation.accuracy.back().total, 0.03);
}

INSTANTIATE_TEST_SUITE_P(HardCases, LitSheet, testing::Values(Storage::tiles, Storage::rays));

TEST(Sheet, IsDarkForWhatLiesInItsPlane) {
  // A black room with a lamp on edge in the plane of a sheet, which gets no light from it.
  Scene scene = empty_scene({grey(0), sheet(0.4, 0.4), grey(0, 10)});
  scene = with_quad(std::move(scene), {Point(2, 0, 0), Point(2, 1, 0), Point(2, 1, 2), Point(2, 0, 2)}, 1);
  scene = with_quad(std::move(scene), {Point(2, 2, 0), Point(2, 3, 0), Point(2, 3, 2), Point(2, 2, 2)}, 2);
  const Simulation simulation = simulate(scene, fronts(100, Storage::tiles));
  EXPECT_EQ(flux_on(simulation, 0, Side::front) + flux_on(simulation, 0, Side::back), 0);
}

TEST(Sheet, LetsTheSunIntoAClosedBox) {
  // The lid of a black box is a sheet of reflectance 0 below the sun: the flux tau E_n sin(altitude) A enters.
  const double tau = 0.6, altitude = 0.9;
  Scene scene = empty_scene({grey(0), sheet(0, tau)});
  const std::vector<Quad> faces = box_faces(Point(0, 0, 0), Point(2, 1, 1), true);
  for (std::size_t k = 0; k < faces.size(); ++k) scene = with_quad(std::move(scene), faces[k], k == 1 ? 1 : 0);
  scene.sun = Sun{Vector(std::cos(altitude), 0, std::sin(altitude)), Spectrum::Constant(1, 500)};
  Request request = fronts(500, Storage::tiles);
  request.mesh.sides = Sides::automatic;
  const Simulation simulation = simulate(scene, request);
  double inside = 0;
  for (const PolygonIndex p : {0U, 2U, 3U, 4U, 5U}) inside += flux_on(simulation, p, Side::front);
  EXPECT_NEAR(inside / (tau * 500 * std::sin(altitude) * 2), 1, 1e-3);
}

TEST(Sheet, IsSolvedByWhatTakesTheOperatorAlone) {
  const Scene scene = lit_from_one_side(0.5);
  Request request = fronts(300, Storage::tiles);
  request.solver.solver = Solver::cg;
  const Simulation usual = simulate(scene, request);
  EXPECT_EQ(usual.plan.solver.solver, Solver::gmres);
  for (const Solver solver : all_solvers()) {
    if (solver == Solver::cg) continue;
    request.solver.solver = solver;
    if (takes_diagonal(solver)) {
      EXPECT_NE(refusal_of(scene, request).find("paper"), std::string::npos) << name_of(solver);
      continue;
    }
    const Simulation other = simulate(scene, request);
    EXPECT_LT(relative_error(usual.solution.radiosity, other.solution.radiosity, usual.problem), 2e-6);
  }
}

TEST(Sheet, KeepsWithinItsBounds) {
  const Scene scene = lit_from_one_side(0.65);
  Request request = fronts(300, Storage::tiles);
  request.solver.relative_error = 1e-12;
  const Field exact = simulate(scene, request).solution.radiosity;
  for (const double tolerance : {0.3, 0.1, 1e-2, 1e-4}) {
    request.solver.relative_error = tolerance;
    const Simulation rough = simulate(scene, request);
    EXPECT_TRUE(((rough.solution.radiosity - exact).abs() <= rough.solution.error + 1e-10).all()) << tolerance;
    EXPECT_LE(relative_error(exact, rough.solution.radiosity, rough.problem), tolerance);
  }
}

std::string refusal_of(const Scene& scene) {
  try {
    check(scene);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(Sheet, IsRefusedByNameWhereItScattersMoreThanArrives) {
  const auto is_refused = [](const Scene& scene) { return refusal_of(scene).find("'paper'") != std::string::npos; };
  const auto room = [](const Material& material) { return divided_room({grey(0.5), material, grey(0.5), grey(0, 1)}); };
  EXPECT_TRUE(is_refused(room(sheet(0.5, 0.6))));
  EXPECT_TRUE(is_refused(room(sheet(0.5, -0.1))));
  EXPECT_EQ(refusal_of(room(sheet(0.5, 0.5))), "");
  Material pane = sheet(0.1, 0.4);
  pane.transmittance = Spectrum::Constant(1, 0.3);
  EXPECT_TRUE(is_refused(room(pane)));
  Material mirror = sheet(0.1, 0.4);
  mirror.specular_reflectance = Spectrum::Constant(1, 0.3);
  EXPECT_TRUE(is_refused(room(mirror)));
  Scene two_kinds = room(sheet(0.5, 0.3));
  two_kinds.polygons[dividing].back_material = MaterialIndex{0};
  EXPECT_TRUE(is_refused(two_kinds));
}

}  // namespace
}  // namespace patchlight::sheets_test
