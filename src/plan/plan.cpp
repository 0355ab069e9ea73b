#include "patchlight/plan/plan.h"

#include "patchlight/base/error.h"

#include "mesh/mesher.h"
#include "plan/check_request.h"
#include "plan/choose_storage.h"
#include "plan/decide.h"
#include "plan/goal.h"
#include "plan/notes.h"
#include "plan/planned_lines.h"
#include "plan/survey.h"
#include "scene/coverings.h"
#include "scene/solids.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace patchlight {
namespace {

// A run without any light is not meant.
void require_light(const Scene& scene, const EffectFacts& facts, const std::vector<Decision>& decisions) {
  if (facts.lamps > 0) return;
  std::string skipped;
  for (const Decision& decision : decisions) {
    const bool is_light =
        decision.effect == Effect::luminaires || decision.effect == Effect::sun || decision.effect == Effect::sky;
    if (is_light && decision.simulate) return;
    if (is_light && decision.forced) skipped += std::string(skipped.empty() ? "" : ", ") + name_of(decision.effect);
  }
  if (skipped.empty()) return;
  throw InputError(scene.file, "no light source is left\nhint: keep one of those that are disabled: " + skipped);
}

bool simulates(const std::vector<Decision>& decisions, Effect effect) {
  return std::none_of(decisions.begin(), decisions.end(),
                      [effect](const Decision& decision) { return decision.effect == effect && !decision.simulate; });
}

// How finely the kept sides are cut.
struct PatchSize {
  double max_edge = 0;      // meters
  std::size_t patches = 0;  // approximate number, or the smallest one that the edge allows
  std::size_t around = 0;   // of these, the patches in the surroundings of the goal
  Diagnostics notes;
};

// The kept sides with their lines, and the known facts about the number of patches.
struct Outlined {
  const Scene& scene;
  const KeptSides& sides;  // those of the goal
  const ContactLines& contacts;
  EdgeSearch& search;
  const Goal* goal = nullptr;
};

// The longest edge of parents that have about `wanted` parts in total. Large parents are split in four; small ones stay
// whole. With many small faces the number of parents lies anywhere between a quarter of `wanted` and all of it.
double parents_edge_for(EdgeSearch& search, std::size_t wanted) {
  // A mesh that no memory holds is refused later, without being made for it.
  if (wanted > 5'000'000) return 2 * search.edge_for(wanted);
  const double edge = search.edge_for(wanted / 4);
  // Where nearly every patch is a whole face, the count hardly depends on whether the large faces are split.
  const auto least = static_cast<double>(search.least_patches());
  const auto beyond_faces = [least](double patches) { return std::max(0.0, patches - least); };
  if (beyond_faces(search.nested_patches_with(edge)) >= 0.8 * beyond_faces(static_cast<double>(wanted))) return edge;
  return search.nested_edge_for(wanted);
}

// Pairs that are refined begin with the least that they have to. Every kept side takes a patch at least. In a model
// with more than 1,000 faces a quarter more patches than the least cut the large ones, as the light varies over them.
std::size_t patches_wanted(std::size_t asked, std::size_t least, const Request& request) {
  if (refines(request.accuracy) && request.assembly.storage != Storage::rays) return std::max(asked, least);
  return least > 1000 ? std::max(asked, least + least / 4) : asked;
}

// The approximate number of patches, or the smallest one that the requested edge allows.
std::size_t expected_patches(const Outlined& of, const Request& request) {
  if (request.mesh.max_edge) return least_patches_with(of.scene, of.sides, *request.mesh.max_edge, of.contacts);
  return patches_wanted(patches_asked(request), of.search.least_patches(), request);
}

// The largest edge for the requested number of patches.
PatchSize patch_size_for(std::size_t asked, const Outlined& of, const Request& request) {
  const std::size_t least = of.search.least_patches();
  const double share = of.goal != nullptr ? of.goal->share_of_surroundings : 0;
  const auto around = static_cast<std::size_t>(std::lround(share * static_cast<double>(asked)));
  const std::size_t wanted = patches_wanted(asked - around, least, request);
  // A nested mesh is made from parents with edges twice as long.
  PatchSize size{
      has_error_bars(request.accuracy) ? parents_edge_for(of.search, wanted) / 2 : of.search.edge_for(wanted),
      wanted + around,
      around,
      {}};
  if (wanted > asked && !refines(request.accuracy))
    size.notes.push_back({DiagnosticCode::more_patches, "the model's " + std::to_string(of.scene.polygons.size()) +
                                                            " faces take " + std::to_string(wanted) + " patches, not " +
                                                            std::to_string(asked) +
                                                            ", so that large faces are divided as well"});
  return size;
}

PatchSize patch_size(const Outlined& of, const Request& request) {
  assert(!request.mesh.max_edge || *request.mesh.max_edge > 0);
  const std::size_t asked = request.mesh.max_edge ? 0 : patches_asked(request);
  PatchSize size = request.mesh.max_edge ? PatchSize{*request.mesh.max_edge, expected_patches(of, request), 0, {}}
                                         : patch_size_for(asked, of, request);
  const double outline_edge = has_error_bars(request.accuracy) ? 2 * size.max_edge : size.max_edge;
  size.notes = merged({problems_with_size(of.scene), std::move(size.notes),
                       notes_on_fine_outlines(of.scene, of.sides, asked, outline_edge)});
  return size;
}

// Error bars follow from the errors of the entries.
AssemblyOptions decided(AssemblyOptions assembly, const Request& request, bool close) {
  assembly.close = close;
  const bool of_pairs = assembly.storage != Storage::rays && has_error_bars(request.accuracy);
  assembly.keep_errors = assembly.keep_errors || of_pairs;
  return assembly;
}

// Follows the decisions about effects. If light is not reflected again, the rows of the lamps are enough and no matrix
// is needed. Forced occlusion traces rays for every pair, including pairs with nothing between them.
AssemblyOptions decided(const Request& request, const EffectFacts& facts, const std::vector<Decision>& decisions,
                        const Given& given) {
  AssemblyOptions assembly = decided(request.assembly, request, simulates(decisions, Effect::closure));
  const bool lamps_alone = !simulates(decisions, Effect::interreflection) && !assembly.close && !assembly.keep_errors &&
                           assembly.estimator == Estimator::automatic;
  if (lamps_alone && !given.form_factors && assembly.storage == Storage::tiles) assembly.storage = Storage::on_demand;
  if (simulates(decisions, Effect::occlusion) && facts.inside_hull == 0) assembly.short_cuts.free = false;
  return assembly;
}

// With sheets R is not diagonal, and may have negative eigenvalues.
SolverOptions decided(SolverOptions solver, bool every_band, const AssemblyOptions& assembly,
                      const EffectFacts& facts) {
  if (facts.sheets > 0 && solver.solver == Solver::cg) solver.solver = Solver::gmres;
  if (assembly.storage == Storage::rays && !solver.relative_error)
    solver.relative_error = default_ray_tolerance(assembly.rays);
  solver.every_band = solver.every_band || every_band;
  return solver;
}

Plan with_nothing_open(Plan plan) {
  plan.solver.relative_error = tolerance_of(plan.solver);
  plan.accuracy.error_bars = has_error_bars(plan.accuracy);
  return plan;
}

}  // namespace

Plan make_plan(const Scene& scene, const Request& asked, const Given& given) {
  if (!has_lamp(scene)) throw InputError(scene.file, "no light source: " + first_light(scene).advice);
  KeptSides sides = sides_for(scene, asked);
  const auto coverings = std::make_shared<const Coverings>(find_coverings(scene, sides));
  // Form factors that are given belong to a mesh that knows of no light.
  const bool knows_lights = !given.form_factors && !given.ray_rows && !given.mesh;
  // A requested edge applies to all patches.
  const bool has_goal = knows_lights && !asked.mesh.max_edge;
  const std::shared_ptr<const Goal> goal =
      has_goal ? find_goal(scene, sides, *coverings, asked.accuracy.interest, asked.assembly.seed) : nullptr;
  const KeptSides of_goal = sides_of_goal(sides, goal.get());
  auto [contacts, notes_on_contacts] = planned_lines(scene, asked, sides, *coverings, knows_lights);
  const EffectFacts facts = survey_effects(scene, sides);
  const bool reflects = simulates(decide(facts, asked), Effect::interreflection);
  const bool mirrors =
      (has_reflections(facts) && !contains(asked.effects.skip, Effect::mirrors)) || facts.coloured_specular > 0;
  EdgeSearch search(scene, of_goal, contacts);
  const Outlined outlined{scene, of_goal, contacts, search, goal.get()};
  const auto [request, notes_on_storage] =
      choose_storage(asked, given,
                     {.patches = expected_patches(outlined, asked) + kept_side_count(sides) - kept_side_count(of_goal),
                      .sides = kept_side_count(sides),
                      .is_reflected = reflects,
                      .is_mirrored = mirrors,
                      .has_goal = goal != nullptr,
                      .has_sensors = !scene.sensors.empty()});
  require_rays_for_colours(facts.coloured_specular, request, asked, given);
  PatchSize size = patch_size(outlined, request);
  std::vector<Decision> decisions = decide(facts, request);
  require_light(scene, facts, decisions);

  // One band stands for all where nothing changes the color of light.
  const bool one_colour = facts.grey && facts.lamp_colour.has_value();
  const bool in_colour = simulates(decisions, Effect::colour);
  const auto left_out = [&] { return notes_on_left_out_sides(scene, *asked.mesh.kept_sides, asked.mesh.sides); };
  return with_nothing_open(
      {.sides = std::move(sides),
       .coverings = coverings,
       .contacts = std::move(contacts),
       .graded_edges = asked.mesh.graded_edges,
       .max_edge = size.max_edge,
       .goal = goal,
       .patches_around = size.around,
       .assembly = decided(request, facts, decisions, given),
       .solver = decided(request.solver, in_colour && one_colour, request.assembly, facts),
       .accuracy = request.accuracy,
       .resources = request.resources,
       .decisions = std::move(decisions),
       .lamp_colour = !in_colour && one_colour ? *facts.lamp_colour : Spectrum(),
       .notes = merged({std::move(size.notes), notes_on_storage, std::move(notes_on_contacts),
                        notes_on_overruling(facts, request), notes_on_sun(facts), notes_on_sheets(facts),
                        notes_on_luminaires_behind(scene), request.mesh.kept_sides ? left_out() : Diagnostics()})});
}

Plan plan_form_factors(const Scene& scene, const Request& request) {
  KeptSides sides = sides_for(scene, request);
  const auto coverings = std::make_shared<const Coverings>(find_coverings(scene, sides));
  require_rays_for_colours(coloured_specular(scene, sides), request, request);
  auto [contacts, notes_on_contacts] = planned_lines(scene, request, sides, *coverings, false);
  EdgeSearch search(scene, sides, contacts);
  PatchSize size = patch_size({scene, sides, contacts, search}, request);
  const bool close = request.assembly.close && keeps_entries(request.assembly.storage) &&
                     !contains(request.effects.skip, Effect::closure);
  return with_nothing_open(
      {.sides = std::move(sides),
       .coverings = coverings,
       .contacts = std::move(contacts),
       .graded_edges = request.mesh.graded_edges,
       .max_edge = size.max_edge,
       .assembly = decided(request.assembly, request, close),
       .solver = request.solver,
       .accuracy = request.accuracy,
       .resources = request.resources,
       .decisions = {},
       .notes = merged({std::move(size.notes), notes_on_pairs(scene, request), std::move(notes_on_contacts)})});
}

bool refines(const AccuracyOptions& accuracy) { return accuracy.relative_error || accuracy.seconds; }

bool has_error_bars(const AccuracyOptions& accuracy) { return accuracy.error_bars || refines(accuracy); }

std::size_t patches_asked(const Request& request) {
  return request.mesh.patches.value_or(refines(request.accuracy) ? first_patches : default_patches);
}

KeptSides sides_for(const Scene& scene, const Request& request) {
  if (!request.mesh.kept_sides) {
    return kept_sides(scene, request.mesh.sides,
                      {.unreached = contains(request.effects.force, Effect::reach),
                       .turned_away = contains(request.effects.force, Effect::backs)});
  }
  KeptSides sides = *request.mesh.kept_sides;
  assert(sides.front.size() == scene.polygons.size());
  // The given sides may stem from a scene with other materials.
  sides.geometry = std::make_shared<const SceneGeometry>(compute_geometry(scene));
  return sides;
}

bool simulates(const Plan& plan, Effect effect) { return simulates(plan.decisions, effect); }

}  // namespace patchlight
