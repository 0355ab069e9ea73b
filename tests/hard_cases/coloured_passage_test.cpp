#include "patchlight/base/error.h"
#include "patchlight/plan/plan.h"
#include "patchlight/simulate.h"

#include "optics/surface_optics.h"
#include "pipeline/form_factors.h"
#include "support/scenes.h"
#include "transport/ray_transport.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace patchlight::coloured_passage_test {
namespace {

using namespace test;

// A material with as many bands as `values`.
Material even(const Spectrum& values, double reflectance, double exitance = 0) {
  Material material;
  material.reflectance = Spectrum::Constant(values.size(), reflectance);
  material.exitance = Spectrum::Constant(values.size(), exitance);
  return material;
}

Material mirror(const Spectrum& specular_reflectance) {
  Material material = even(specular_reflectance, 0);
  material.name = "mirror";
  material.specular_reflectance = specular_reflectance;
  return material;
}

Material glass(const Spectrum& transmittance) {
  Material material = even(transmittance, 0.02);
  material.name = "glass";
  material.transmittance = transmittance;
  return material;
}

Spectrum one(double value) { return Spectrum::Constant(1, value); }

// A closed room of 4 x 3 x 2.5 m with a mirror at low x, divided at x = 2 by a pane from wall to wall. All other faces
// emit almost the same light, so that no patch counts as bright.
Scene divided_room(const Spectrum& reflected, const Spectrum& transmitted, double exitance_beyond) {
  Scene scene = empty_scene(
      {even(reflected, 0.6, 1), mirror(reflected), glass(transmitted), even(reflected, 0.5, exitance_beyond)});
  std::vector<Quad> faces = box_faces(Point(0, 0, 0), Point(2, 3, 2.5), true);
  for (const std::size_t k : {0, 1, 2, 4, 5})
    scene = with_quad(std::move(scene), faces[k], k == 5 ? MaterialIndex{1} : MaterialIndex{0});
  faces = box_faces(Point(2, 0, 0), Point(4, 3, 2.5), true);
  for (const std::size_t k : {0, 1, 2, 3, 4}) scene = with_quad(std::move(scene), faces[k], 3);
  scene = with_quad(std::move(scene), {Point(2, 0, 0), Point(2, 0, 2.5), Point(2, 3, 2.5), Point(2, 3, 0)}, 2);
  scene.polygons.back().back_material = 2;
  return scene;
}

Request by_few_rays(PatchIndex patches) {
  Request request;
  request.assembly.storage = Storage::rays;
  request.assembly.rays = 64;
  request.mesh.sides = Sides::front;
  request.mesh.patches = patches;
  request.solver.solver = Solver::gmres;
  request.solver.relative_error = 1e-13;
  return request;
}

double largest_difference(const Field& a, const Field& b) { return (a - b).abs().maxCoeff(); }

TEST(ColouredPassage, IsInEachBandThatOfAGreySceneOfThisValue) {
  // Only clear faces and mirrors are colored. The rays are the same, so the results differ by rounding only.
  const Spectrum reflected = rgb(1, 0.5, 0.1);
  const Spectrum transmitted = rgb(0.85, 0.05, 0.4);
  const Simulation coloured = simulate(divided_room(reflected, transmitted, 0.6), by_few_rays(400));
  for (Eigen::Index band = 0; band < 3; ++band) {
    const Scene grey = divided_room(one(reflected[band]), one(transmitted[band]), 0.6);
    const Simulation alone = simulate(grey, by_few_rays(400));
    ASSERT_EQ(alone.mesh.size(), coloured.mesh.size());
    EXPECT_LT(largest_difference(coloured.solution.radiosity.col(band), alone.solution.radiosity.col(0)), 1e-12);
    EXPECT_LT(largest_difference(coloured.solution.irradiance.col(band), alone.solution.irradiance.col(0)), 1e-12);
    EXPECT_LT(largest_difference(coloured.ray_standard_error.col(band), alone.ray_standard_error.col(0)), 1e-12);
    EXPECT_NEAR(coloured.balance.absorbed[band], alone.balance.absorbed[0], 1e-11);
  }
}

TEST(ColouredPassage, OfGreyInThreeBandsIsGrey) {
  const Simulation three = simulate(divided_room(rgb(0.7, 0.7, 0.7), rgb(0.8, 0.8, 0.8), 0.6), by_few_rays(400));
  const Simulation single = simulate(divided_room(one(0.7), one(0.8), 0.6), by_few_rays(400));
  for (Eigen::Index band = 0; band < 3; ++band)
    EXPECT_LT(largest_difference(three.solution.radiosity.col(band), single.solution.radiosity.col(0)), 1e-12);
}

// A black room with a lamp, and a second one behind a red pane of index 1 with reflecting walls and no lamp. The
// transmitted light is red.
TEST(ColouredPassage, BehindARedPaneIsRed) {
  const Scene scene = divided_room(rgb(0, 0, 0), rgb(0.8, 0.08, 0), 0);
  const Simulation simulation = simulate(scene, by_few_rays(600));
  const PatchRange beyond = simulation.mesh.patches_on(8, Side::front);
  Eigen::ArrayXd mean = Eigen::ArrayXd::Zero(3);
  for (PatchIndex i = beyond.begin; i < beyond.end; ++i) mean += simulation.solution.radiosity.row(i).transpose();
  EXPECT_GT(mean[0], 0);
  EXPECT_LT(mean[1], 0.15 * mean[0]);
  EXPECT_LT(mean[2], 1e-12 * mean[0]);
}

// A request for form factors of pairs, and the option that its refusal names.
struct PairRequest {
  const char* part;
  std::function<void(Request&)> ask;
};

std::vector<PairRequest> pair_requests() {
  return {{"assembly.storage=tiles", [](Request& r) { r.assembly.storage = Storage::tiles; }},
          {"assembly.storage=on_demand",
           [](Request& r) {
             r.assembly.storage = Storage::on_demand;
             r.solver.solver = Solver::progressive;
           }},
          {"assembly.estimator=contour", [](Request& r) { r.assembly.estimator = Estimator::contour; }},
          {"assembly.samples", [](Request& r) { r.assembly.samples = 64; }},
          {"assembly.close=false", [](Request& r) { r.assembly.close = false; }},
          {"effects.force=closure", [](Request& r) { r.effects.force = {Effect::closure}; }},
          {"effects.skip=occlusion", [](Request& r) { r.effects.skip = {Effect::occlusion}; }},
          {"effects.skip=interreflection", [](Request& r) { r.effects.skip = {Effect::interreflection}; }},
          {"solver.solver=sor", [](Request& r) { r.solver.solver = Solver::sor; }}};
}

Storage planned_storage(const Scene& scene, const std::function<void(Request&)>& ask) {
  Request request;
  request.mesh.patches = 100;
  ask(request);
  return make_plan(scene, request).assembly.storage;
}

// Form factors of pairs have one value for all bands, which is correct for gray panes only.
TEST(ColouredPassage, IsRefusedByPairs) {
  const Scene grey = divided_room(rgb(0.7, 0.7, 0.7), rgb(0.8, 0.8, 0.8), 0.6);
  const std::vector<Scene> coloured{divided_room(rgb(0.7, 0.7, 0.7), rgb(0.8, 0.5, 0.8), 0.6),
                                    divided_room(rgb(0.7, 0.6, 0.7), rgb(0.8, 0.8, 0.8), 0.6)};
  for (const auto& [part, ask] : pair_requests()) {
    EXPECT_NE(planned_storage(grey, ask), Storage::rays) << part;
    for (const Scene& scene : coloured) {
      try {
        planned_storage(scene, ask);
        ADD_FAILURE() << part << " is not refused";
      } catch (const InputError& error) {
        EXPECT_TRUE(std::string(error.what()).starts_with(part)) << error.what();
        EXPECT_NE(std::string(error.what()).find("assembly.storage=rays"), std::string::npos);
      }
    }
  }
  for (const Scene& scene : coloured) {
    EXPECT_THROW(plan_form_factors(scene, {}), InputError);
    EXPECT_NO_THROW(plan_form_factors(scene, by_few_rays(100)));
    EXPECT_THROW(make_plan(scene, {}, {.form_factors = true}), InputError);
  }
}

TEST(ColouredPassage, IsNeverPlannedByPairs) {
  const Scene scene = divided_room(rgb(0.7, 0.6, 0.7), rgb(0.8, 0.5, 0.8), 0.6);
  Scene black = scene;
  for (Material& material : black.materials) material.reflectance.setZero();
  for (const std::function<void(Request&)>& ask : std::vector<std::function<void(Request&)>>{
           [](Request&) {}, [](Request& r) { r.accuracy.cheap_error_bars = true; },
           [](Request& r) { r.effects.skip = {Effect::mirrors}; }}) {
    EXPECT_EQ(planned_storage(scene, ask), Storage::rays);
    EXPECT_EQ(planned_storage(black, ask), Storage::rays);
  }
  for (const std::function<void(Request&)>& ask : std::vector<std::function<void(Request&)>>{
           [](Request& r) { r.accuracy.relative_error = 0.05; }, [](Request& r) { r.accuracy.seconds = 1; },
           [](Request& r) { r.accuracy.error_bars = true; }}) {
    EXPECT_EQ(planned_storage(scene, ask), Storage::rays);
    EXPECT_THROW(planned_storage(black, ask), InputError) << "error bars of light that nothing reflects take pairs";
  }
}

// Steps that reuse the rows and patches of a scene for another scene.
Steps with_rows_of(const Scene& scene, const Request& request) {
  const RayFormFactors found = find_ray_form_factors(scene, request);
  Steps with;
  with.ray_exchange = [found](const PatchMesh&) { return found.exchange; };
  with.mesh = [found] { return found.mesh; };
  return with;
}

// The same patches with newly traced rays.
Simulation fresh_on_mesh_of(const Steps& with, const Scene& scene, const Request& request) {
  Steps own;
  own.mesh = with.mesh;
  return simulate(scene, request, {}, own);
}

// Three bands in colors that did not occur when the rows were traced.
TEST(ColouredPassage, HasTheSameRowsInAllColours) {
  const Request request = by_few_rays(400);
  const Steps with = with_rows_of(divided_room(rgb(0.7, 0.7, 0.7), rgb(0.8, 0.8, 0.8), 0.6), request);
  const Scene red = divided_room(rgb(1, 0.5, 0.1), rgb(0.85, 0.05, 0.4), 0.6);
  const Simulation again = simulate(red, request, {}, with);
  const Simulation fresh = fresh_on_mesh_of(with, red, request);
  EXPECT_EQ(largest_difference(again.solution.radiosity, fresh.solution.radiosity), 0);
  EXPECT_EQ(largest_difference(again.ray_standard_error, fresh.ray_standard_error), 0);
}

// A lamp is handled separately from the rows; its light also passes through the pane and over the mirror.
TEST(ColouredPassage, OfALampIsThatOfThePanesOfNow) {
  const auto with_lamp = [](Scene scene) {
    scene.materials.push_back(even(rgb(1, 1, 1), 0, 20));
    return with_quad(std::move(scene), {Point(0.5, 1, 2.4), Point(0.5, 1.5, 2.4), Point(1, 1.5, 2.4), Point(1, 1, 2.4)},
                     4);
  };
  const Request request = by_few_rays(400);
  const Steps with = with_rows_of(with_lamp(divided_room(rgb(0.7, 0.7, 0.7), rgb(0.6, 0.6, 0.6), 0.6)), request);
  const Scene red = with_lamp(divided_room(rgb(0.6, 0.5, 0.4), rgb(0.65, 0.5, 0.4), 0.6));
  const Simulation again = simulate(red, request, {}, with);
  const Simulation fresh = fresh_on_mesh_of(with, red, request);
  EXPECT_LT(largest_difference(again.solution.radiosity, fresh.solution.radiosity),
            1e-6 * fresh.solution.radiosity.maxCoeff());
}

TEST(ColouredPassage, IsRefusedWhereRaysHaveGoneAnotherWay) {
  const Request request = by_few_rays(100);
  const Scene scene = divided_room(rgb(0.7, 0.7, 0.7), rgb(0.8, 0.8, 0.8), 0.6);
  const Steps with = with_rows_of(scene, request);
  Scene thicker = scene;
  thicker.materials[2].index = 1.7;
  EXPECT_THROW(simulate(thicker, request, {}, with), InputError);
  Scene more = scene;
  more.materials[0].specular_reflectance = rgb(0.2, 0.2, 0.2);
  EXPECT_THROW(simulate(more, request, {}, with), InputError);
  Scene opaque = scene;
  opaque.materials[2].transmittance = rgb(0, 0, 0);
  EXPECT_LT(largest_difference(simulate(opaque, request, {}, with).solution.radiosity,
                               fresh_on_mesh_of(with, opaque, request).solution.radiosity),
            1e-12);
}

// The exchange between the fronts of two polygons along the ways of one class, sum_i A_i F_ij in m^2, for each half of
// the rays.
using Exchanged = std::map<std::tuple<std::uint32_t, PolygonIndex, PolygonIndex>, std::array<double, 2>>;

Exchanged exchanged_by_class(const RowsByClass& by_class, const PatchMesh& mesh, const Eigen::VectorXd& area) {
  Exchanged sums;
  for (std::size_t half = 0; half < 2; ++half) {
    for (const ClassEntry& e : by_class.halves[half])
      sums[{e.way_class, mesh.polygon[e.from], mesh.polygon[e.to]}][half] +=
          area[e.from] * static_cast<double>(e.form_factor);
  }
  return sums;
}

// Reciprocity holds for each class of ways: A_i F_ij = A_j F_ji. The halves of the rays are independent, so half of
// their difference estimates the standard error of their mean. Over about a hundred pairs the sum of squared
// differences matches the sum of variances, up to chance.
TEST(ColouredPassage, IsSymmetricInEachClassOfWays) {
  const Scene scene = divided_room(one(0.7), one(0.8), 0.6);
  Request request = by_few_rays(800);
  request.assembly.rays = 1024;
  const RayFormFactors found = find_ray_form_factors(scene, request);
  const SurfaceOptics faces(scene, Reflections::followed);
  const RowsByClass by_class = rows_by_class(found.exchange.rows, scene, faces);
  const Exchanged sums = exchanged_by_class(by_class, found.mesh, found.area);
  double squares = 0, variances = 0;
  std::size_t pairs = 0;
  for (const auto& [key, there] : sums) {
    const auto [way_class, from, to] = key;
    const auto found_back = sums.find({way_class, to, from});
    if (from >= to || found_back == sums.end()) continue;
    const auto& back = found_back->second;
    const double mean = 0.5 * (there[0] + there[1]), other = 0.5 * (back[0] + back[1]);
    if (mean < 0.01) continue;
    ++pairs;
    squares += (mean - other) * (mean - other);
    variances += 0.25 * (std::pow(there[0] - there[1], 2) + std::pow(back[0] - back[1], 2));
    EXPECT_NEAR(mean / other, 1, 0.25) << name_of(by_class.classes[way_class], scene) << ' ' << from << ' ' << to;
  }
  EXPECT_GT(pairs, 50U);
  EXPECT_LT(squares, 2 * variances);
  const auto has = [&](const std::string& name) {
    return std::any_of(by_class.classes.begin(), by_class.classes.end(),
                       [&](const WayClass& one_class) { return name_of(one_class, scene) == name; });
  };
  EXPECT_TRUE(has("straight") && has("glass") && has("mirror mirrored") && has("glass mirrored") &&
              has("mirror mirrored + glass"));
}

}  // namespace
}  // namespace patchlight::coloured_passage_test
