#include "patchlight/plan/plan.h"

#include "patchlight/base/error.h"

#include "mesh/mesher.h"
#include "mesh/nested_mesh.h"
#include "plan/choose_storage.h"
#include "support/diagnostics_of.h"
#include "support/scenes.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace patchlight::plan_test {
namespace {

using namespace test;

const Decision& decision(const Plan& plan, Effect effect) {
  for (const Decision& candidate : plan.decisions) {
    if (candidate.effect == effect) return candidate;
  }
  throw std::out_of_range(name_of(effect));
}

TEST(MakePlan, RefusesASceneWithoutLamp) {
  try {
    make_plan(cube_room(0.5, 0), {});
    FAIL() << "expected an InputError";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("no light source"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("grey"), std::string::npos);
  }
}

TEST(MakePlan, TakesLuminairesSunAndSkyForLamps) {
  Scene scene = cube_room(0.5, 0);
  scene.luminaires.resize(1);
  EXPECT_NO_THROW(make_plan(scene, {}));
}

TEST(MakePlan, SaysThatTheSunIsBelowTheHorizon) {
  Scene scene = cube_room(0.5, 1);
  scene.sun = Sun{Vector(0, 0.6, 0.8), Spectrum::Ones(1)};
  EXPECT_TRUE(make_plan(scene, {}).notes.empty());
  scene.sun->direction = Vector(0, std::sqrt(3) / 2, -0.5);
  const Plan plan = make_plan(scene, {});
  ASSERT_EQ(codes_of(plan.notes), std::vector{DiagnosticCode::sun_below_horizon});
  EXPECT_NE(plan.notes[0].text.find("30 degrees below"), std::string::npos) << plan.notes[0].text;
}

TEST(MakePlan, NamesALuminaireJustBehindTheCeilingThatItShinesThrough) {
  for (const bool inward : {true, false}) {
    Scene scene = with_box(empty_scene({grey(0.5)}), Point(0, 0, 0), Point(4, 3, 2.5), inward);
    scene.luminaires.resize(1);
    scene.luminaires[0].name = "downlight";
    scene.luminaires[0].light = PointLight{Spectrum::Ones(1)};
    const auto notes_at = [&](double height) {
      scene.luminaires[0].position = {2, 1.5, height};
      const Diagnostics notes = make_plan(scene, {}).notes;
      return std::count_if(notes.begin(), notes.end(), [](const Diagnostic& note) {
        return note.code == DiagnosticCode::misplaced_luminaire &&
               note.text.find("mm behind a face") != std::string::npos;
      });
    };
    EXPECT_EQ(notes_at(2.5), 0);
    EXPECT_EQ(notes_at(std::nextafter(2.5, 3)), 0);
    EXPECT_EQ(make_plan(scene, {}).notes.size(), 1U) << "half of its light goes to either side";
    EXPECT_EQ(notes_at(2.501), 1);
    EXPECT_EQ(notes_at(2.4995), 0) << "in the room";
    EXPECT_EQ(notes_at(2.5005), 1) << "it lights the roof";
    EXPECT_EQ(notes_at(2.502), 0) << "it is meant to";
  }
}

TEST(MakePlan, OcclusionOnlyWhereSomethingCanStandBetween) {
  EXPECT_FALSE(decision(make_plan(cube_room(0.5, 1), {}), Effect::occlusion).simulate);
  EXPECT_TRUE(decision(make_plan(furnished_room(0.5), {}), Effect::occlusion).simulate);
}

TEST(MakePlan, InterreflectionOnlyWhereSomethingReflects) {
  EXPECT_FALSE(decision(make_plan(cube_room(0, 1), {}), Effect::interreflection).simulate);
  EXPECT_TRUE(decision(make_plan(cube_room(0.1, 1), {}), Effect::interreflection).simulate);
}

TEST(MakePlan, RefusesToSkipAllLight) {
  Scene scene = cube_room(0.5, 0);
  scene.luminaires.resize(1);
  Request request;
  request.effects.skip = {Effect::luminaires};
  EXPECT_THROW(make_plan(scene, request), InputError);
}

// If two scenes have the same number of patches, the one with more faces has larger errors of the patch size. The
// errors of rays do not exceed these.
TEST(ChooseStorage, TakesRaysWhereSidesHaveFewPatches) {
  const auto chosen = [](std::size_t patches, std::size_t sides, const Request& request = {}) {
    return choose_storage(request, {}, {.patches = patches, .sides = sides}).request.assembly;
  };
  EXPECT_EQ(chosen(2000, 62).storage, Storage::tiles);
  EXPECT_EQ(chosen(2000, 63).storage, Storage::rays);
  EXPECT_EQ(chosen(2000, 63).rays, 256) << "about as accurate as pairs";
  EXPECT_EQ(chosen(999, 500).storage, Storage::tiles) << "takes no time";
  EXPECT_EQ(chosen(20000, 1000).rays, AssemblyOptions().rays) << "more than pairs are taken for";
  EXPECT_EQ(choose_storage({}, {}, {.patches = 2000, .sides = 6, .has_goal = true}).request.assembly.storage,
            Storage::rays)
      << "pairs take as long for patches of the surroundings as for those of the goal";
  Request refined;
  refined.accuracy.relative_error = 0.01;
  EXPECT_EQ(chosen(2000, 63, refined).storage, Storage::tiles) << "faces get more patches where it matters";
}

// A run that does not fit by pairs gets the advice to use rays only if these fit.
TEST(RequireMemory, AdvisesRaysOnlyWhereTheyFit) {
  const Scene scene = furnished_room(0.5);
  Request request;
  request.mesh.patches = 20000;
  request.assembly.storage = Storage::tiles;
  const auto said = [&](double bytes) -> std::string {
    request.resources.memory = bytes;
    try {
      require_memory(20000, request, make_plan(scene, request));
    } catch (const MemoryError& refusal) {
      return refusal.what();
    }
    return "nothing";
  };
  EXPECT_NE(said(500e6).find("assembly.storage=rays"), std::string::npos) << said(500e6);
  EXPECT_EQ(said(60e6).find("assembly.storage=rays"), std::string::npos) << said(60e6);
  EXPECT_NE(said(60e6), "nothing");
}

// The pair method does not solve many patches unless the request requires it. Explicit requests stay.
TEST(MakePlan, TakesRaysForManyPatches) {
  const Scene scene = furnished_room(0.5);
  Request request;
  request.mesh.patches = 8000;
  EXPECT_EQ(make_plan(scene, request).assembly.storage, Storage::tiles);
  request.resources.memory = 120e6;
  EXPECT_EQ(make_plan(scene, request).assembly.storage, Storage::rays) << "pairs do not fit";
  request.resources.memory.reset();
  request.mesh.patches = 12000;
  const Plan plan = make_plan(scene, request);
  EXPECT_EQ(plan.assembly.storage, Storage::rays);
  EXPECT_EQ(plan.solver.solver, Solver::gmres);
  ASSERT_FALSE(plan.notes.empty());
  EXPECT_EQ(plan.notes.back().code, DiagnosticCode::rows_of_rays);

  const auto storage_with = [&](auto change) {
    Request changed = request;
    change(changed);
    return make_plan(scene, changed).assembly.storage;
  };
  EXPECT_EQ(storage_with([](Request& r) { r.assembly.storage = Storage::tiles; }), Storage::tiles);
  EXPECT_EQ(storage_with([](Request& r) { r.accuracy.error_bars = true; }), Storage::rays);
  EXPECT_EQ(storage_with([](Request& r) { r.accuracy.relative_error = 0.01; }), Storage::rays);
  EXPECT_EQ(storage_with([](Request& r) { r.assembly.close = false; }), Storage::tiles);
  EXPECT_EQ(storage_with([](Request& r) { r.effects.force = {Effect::closure}; }), Storage::tiles);
  EXPECT_EQ(storage_with([](Request& r) { r.solver.solver = Solver::sor; }), Storage::tiles);
  EXPECT_EQ(storage_with([](Request& r) { r.solver.solver = Solver::jacobi; }), Storage::rays);
  EXPECT_EQ(storage_with([](Request& r) { r.assembly.estimator = Estimator::contour; }), Storage::tiles);
  EXPECT_EQ(storage_with([](Request& r) { r.assembly.samples = 64; }), Storage::tiles);
  EXPECT_EQ(storage_with([](Request& r) { r.assembly.short_cuts.far = false; }), Storage::tiles);
  EXPECT_EQ(storage_with([](Request& r) { r.effects.skip = {Effect::occlusion}; }), Storage::tiles);
  EXPECT_EQ(make_plan(scene, request, {.form_factors = true}).assembly.storage, Storage::tiles);
  EXPECT_EQ(make_plan(scene, request, {.solver = true}).assembly.storage, Storage::tiles);
  EXPECT_EQ(make_plan(furnished_room(0), request).assembly.storage, Storage::on_demand) << "nothing reflects";
}

// The light of few lamps needs no matrix, unless its rows are closed or its errors are kept.
TEST(MakePlan, HasErrorBarsOfPairsWhereTheyAreCheap) {
  const Scene scene = cube_room(0.5, 1);
  const auto has_bars = [&](std::size_t patches, const auto& change) {
    Request request;
    request.mesh.patches = patches;
    request.accuracy.cheap_error_bars = true;
    change(request);
    return make_plan(scene, request).accuracy.error_bars;
  };
  const auto nothing = [](Request&) {};
  EXPECT_TRUE(has_bars(4000, nothing));
  EXPECT_TRUE(has_bars(4000, [](Request& r) { r.assembly.storage = Storage::tiles; }));
  EXPECT_FALSE(has_bars(8000, nothing));
  EXPECT_FALSE(has_bars(4000, [](Request& r) { r.accuracy.cheap_error_bars = false; }));
  // Requests that exclude error bars are accepted, without bars.
  EXPECT_FALSE(has_bars(4000, [](Request& r) { r.assembly.close = false; }));
  EXPECT_FALSE(has_bars(4000, [](Request& r) { r.effects.skip = {Effect::interreflection}; }));
  EXPECT_FALSE(has_bars(4000, [](Request& r) { r.assembly.storage = Storage::on_demand; }));
  // Standard errors of sensors follow from those of the patches.
  Scene with_sensor = scene;
  with_sensor.sensors = {{.name = "desk", .sensors = {{Point(0.5, 0.5, 0.5), Vector::UnitZ()}}}};
  Request many;
  many.mesh.patches = 8000;
  many.accuracy.cheap_error_bars = true;
  EXPECT_TRUE(make_plan(with_sensor, many).accuracy.error_bars);
  Request dark;
  dark.accuracy.cheap_error_bars = true;
  EXPECT_FALSE(make_plan(cube_room(0, 1), dark).accuracy.error_bars) << "no light is reflected";
}

TEST(MakePlan, TakesTheRowsOfLampsAloneWhereNothingReflects) {
  EXPECT_EQ(make_plan(furnished_room(0), {}).assembly.storage, Storage::on_demand);
  EXPECT_EQ(make_plan(furnished_room(0.5), {}).assembly.storage, Storage::tiles);
  Request request;
  request.effects.force = {Effect::closure};
  EXPECT_EQ(make_plan(furnished_room(0), request).assembly.storage, Storage::tiles);
  EXPECT_TRUE(make_plan(furnished_room(0), request).assembly.close);
}

// 2,000 small faces in a room of six large ones, which must be cut as well.
TEST(MakePlan, CutsLargeFacesOfModelsWithManySmallOnes) {
  Scene scene = cube_room(0.5, 1);
  for (int k = 0; k < 2000; ++k) {
    const Point corner(0.1 + 0.0004 * k, 0.5, 0.5);
    scene = with_quad(std::move(scene), {corner, corner + Vector(0.0002, 0, 0), corner + Vector(0.0002, 0.0002, 0),
                                         corner + Vector(0, 0.0002, 0)});
  }
  Request request;
  request.mesh.patches = 500;
  request.mesh.sides = Sides::front;
  const Plan plan = make_plan(scene, request);
  EXPECT_EQ(plan.assembly.storage, Storage::rays) << "most faces have one patch";
  EXPECT_EQ(plan.notes.size(), 2U);
  const PatchMesh mesh = tessellate(scene, plan.sides, plan.max_edge, plan.contacts);
  EXPECT_GT(mesh.patches_on(0, Side::front).end - mesh.patches_on(0, Side::front).begin, 30U);
  EXPECT_NEAR(static_cast<double>(mesh.size()), 2006 * 1.25, 250);
}

TEST(MakePlan, MeetsTheNumberOfPatchesWithinTenPercent) {
  const Scene scene = furnished_room(0.5);
  for (const std::size_t patches : {1000U, 4000U}) {
    Request request;
    request.mesh.patches = patches;
    const Plan plan = make_plan(scene, request);
    const double count = tessellate(scene, plan.sides, plan.max_edge, plan.contacts).size();
    EXPECT_NEAR(count / static_cast<double>(patches), 1, 0.1);
  }
}

// Small boxes in a room, in layers of 60.
Scene room_with_boxes(int boxes) {
  Scene scene = furnished_room(0.5);
  for (int k = 0; k < boxes; ++k) {
    const Point corner(0.2 + 0.3 * (k % 10), 0.2 + 0.4 * (k / 10 % 6), 0.1 + 0.2 * (k / 60));
    scene = with_box(std::move(scene), corner, corner + Vector(0.1, 0.1, 0.1), false);
  }
  return scene;
}

// The faces alone reach the number of patches for the large ones. Large faces are cut anyway, with and without error
// bars: the remaining patches are theirs.
TEST(MakePlan, CutsLargeFacesBesideFacesThatAreEnoughPatches) {
  const Scene scene = room_with_boxes(240);
  for (const bool error_bars : {false, true}) {
    Request request;
    request.mesh.patches = 100;
    request.mesh.sides = Sides::front;
    request.accuracy.error_bars = error_bars;
    const Plan plan = make_plan(scene, request);
    const double least = tessellate(scene, plan.sides, 100, plan.contacts).size();
    const NestedMesh nested = nest(tessellate(scene, plan.sides, 2 * plan.max_edge, plan.contacts));
    const double count =
        error_bars ? nested.patches.size() : tessellate(scene, plan.sides, plan.max_edge, plan.contacts).size();
    EXPECT_NEAR((count - least) / (least / 4), 1, 0.4) << error_bars;
  }
}

// With error bars large patches are cut in four and small faces stay whole. So the number of parents is neither all nor
// a quarter of the patches.
TEST(MakePlan, MeetsTheNumberOfPatchesOfNestedMeshesWithManySmallFaces) {
  const Scene scene = room_with_boxes(60);
  for (const std::size_t patches : {500U, 1500U, 4000U}) {
    Request request;
    request.mesh.patches = patches;
    request.mesh.sides = Sides::front;
    request.accuracy.error_bars = true;
    const Plan plan = make_plan(scene, request);
    const double count = nest(tessellate(scene, plan.sides, 2 * plan.max_edge, plan.contacts)).patches.size();
    EXPECT_NEAR(count / static_cast<double>(patches), 1, 0.25) << patches;
  }
}

TEST(MakePlan, TakesTheEdgeThatIsAskedFor) {
  Request request;
  request.mesh.max_edge = 0.123;
  EXPECT_EQ(make_plan(furnished_room(0.5), request).max_edge, 0.123);
}

// Specified values are kept, and all parts are filled.
TEST(MakePlan, TakesThePartsOfTheRequestOver) {
  Request request;
  request.assembly = {.samples = 16, .seed = 7, .lost_share_rays = 64};
  request.solver = {.solver = Solver::gmres, .max_iterations = 12, .restart = 5};
  request.accuracy.interest = {"floor"};
  request.resources = {.threads = 3, .memory = 1e9};
  const Plan plan = make_plan(furnished_room(0.5), request);
  EXPECT_EQ(plan.assembly.samples, 16);
  EXPECT_EQ(plan.assembly.seed, 7U);
  EXPECT_EQ(plan.assembly.lost_share_rays, 64);
  EXPECT_EQ(plan.solver.solver, Solver::gmres);
  EXPECT_EQ(plan.solver.max_iterations, 12);
  EXPECT_EQ(plan.solver.restart, 5);
  EXPECT_EQ(plan.accuracy.interest, request.accuracy.interest);
  EXPECT_EQ(plan.resources.threads, 3);
  EXPECT_EQ(plan.resources.memory, 1e9);
}

// The plan leaves no choice to a step of the run.
TEST(MakePlan, FillsWhatIsLeftOpen) {
  EXPECT_EQ(make_plan(furnished_room(0.5), {}).solver.relative_error, default_tolerance);
  Request request;
  request.accuracy.seconds = 1;
  const Plan plan = make_plan(furnished_room(0.5), request);
  EXPECT_TRUE(plan.accuracy.error_bars);
  EXPECT_TRUE(plan.assembly.keep_errors);
}

// Given form factors are a matrix, even if the rows of lamps suffice.
TEST(MakePlan, KeepsFormFactorsThatAreGiven) {
  EXPECT_EQ(make_plan(furnished_room(0), {}, {.form_factors = true}).assembly.storage, Storage::tiles);
}

// On a bent face, whose corners deviate from one plane by more than the contact tolerance, no lines are searched. The
// plan has a note. The other faces keep their lines.
TEST(Plan, LooksForNoLinesOfContactOnBentFaces) {
  Scene scene = furnished_room(0.5);
  scene = with_box(std::move(scene), Point(3, 0.5, 0), Point(3.5, 1, 0.5), false);
  const auto told = [](const Plan& plan) { return has(plan.notes, DiagnosticCode::contact_lines); };
  const Plan flat = make_plan(scene, Request());
  EXPECT_FALSE(told(flat));
  const auto on_floor = std::find_if(flat.contacts.on.begin(), flat.contacts.on.end(),
                                     [](const auto& lines) { return lines.size() >= 4; });
  ASSERT_NE(on_floor, flat.contacts.on.end());
  const auto floor = static_cast<std::size_t>(on_floor - flat.contacts.on.begin());
  // The ceiling has the lines of the lamp.
  const std::size_t elsewhere = number_of(flat.contacts) - on_floor->size();
  ASSERT_GT(elsewhere, 0U);

  scene.vertices[scene.polygons[floor].corners[0]].z() += 1e-4;
  const Plan bent = make_plan(scene, Request());
  EXPECT_TRUE(told(bent));
  EXPECT_TRUE(bent.contacts.on[floor].empty());
  // There are no lines on walls either, whose corners are rounded like those of the floor.
  const auto& corners = scene.polygons[floor].corners;
  for (std::size_t p = 0; p < scene.polygons.size(); ++p) {
    const auto& others = scene.polygons[p].corners;
    const bool touches =
        std::find_first_of(corners.begin(), corners.end(), others.begin(), others.end()) != corners.end();
    EXPECT_TRUE(!touches || bent.contacts.on[p].empty()) << p;
  }
  EXPECT_GT(number_of(bent.contacts), 0U);
}

// 80 x 80 small boxes on a floor have 51,200 lines there, each twice. A wall on it has two long ones.
Scene floor_with_many_boxes() {
  Scene scene = with_quad(empty_scene({grey(0.5), grey(0.5, 1)}),
                          {Point(0, 0, 0), Point(40, 0, 0), Point(40, 40, 0), Point(0, 40, 0)});
  scene = with_quad(std::move(scene), {Point(0, 0, 5), Point(0, 40, 5), Point(40, 40, 5), Point(40, 0, 5)}, 1);
  for (int i = 0; i < 80; ++i) {
    for (int j = 0; j < 80; ++j) {
      const Point low(0.2 + 0.49 * i, 0.2 + 0.49 * j, 0);
      scene = with_box(std::move(scene), low, low + Vector(0.1, 0.1, 0.1), false);
    }
  }
  scene = with_box(std::move(scene), Point(1, 39.6, 0), Point(39, 39.8, 2), false);
  return scene;
}

bool is_long(const ContactLine& line) { return (line.to - line.from).norm() > 30; }

// The long ones are followed.
TEST(Plan, FollowsTheLongestOfTooManyLines) {
  const Plan plan = make_plan(floor_with_many_boxes(), Request());
  EXPECT_TRUE(has(plan.notes, DiagnosticCode::contact_lines));
  EXPECT_GE(std::count_if(plan.contacts.on[0].begin(), plan.contacts.on[0].end(), is_long), 2);
  EXPECT_LE(number_of(plan.contacts), 10'000U);
}

// A form factor folder stores this number: any edge or number of patches then gives the same lines.
TEST(Plan, FollowsAsManyLinesAsItIsTold) {
  const Scene scene = floor_with_many_boxes();
  Request request;
  request.mesh.contact_line_count = 100;
  for (const double edge : {0.5, 20.0}) {
    request.mesh.max_edge = edge;
    const Plan plan = make_plan(scene, request);
    EXPECT_EQ(number_of(plan.contacts), 100U);
    EXPECT_GE(std::count_if(plan.contacts.on[0].begin(), plan.contacts.on[0].end(), is_long), 2);
  }
}

// Patches beyond any memory are not counted on the way.
TEST(Plan, DoesNotMeshWhatItRefuses) {
  Request request;
  request.mesh.max_edge = 1e-6;
  EXPECT_EQ(number_of(make_plan(furnished_room(0.5), request).contacts), 0U);
}

}  // namespace
}  // namespace patchlight::plan_test
