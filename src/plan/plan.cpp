#include "patchlight/plan/plan.h"

#include "patchlight/base/error.h"

#include "mesh/mesher.h"
#include "plan/decide.h"
#include "plan/effect_facts.h"
#include "plan/fine_outlines.h"
#include "plan/left_out_sides.h"
#include "plan/luminaires_behind.h"
#include "plan/survey.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <sstream>
#include <utility>

namespace patchlight {
namespace {

void require_lamp(const Scene& scene) {
  if (!has_lamp(scene)) throw InputError(scene.file, "found no lamp: " + advice_without_lamp(scene));
}

// A run without any light is not meant.
void require_light(const Scene& scene, const EffectFacts& facts, const Plan& plan) {
  if (facts.lamps > 0) return;
  std::string skipped;
  for (const Decision& decision : plan.decisions) {
    const bool is_light =
        decision.effect == Effect::luminaires || decision.effect == Effect::sun || decision.effect == Effect::sky;
    if (is_light && decision.simulate) return;
    if (is_light && decision.forced) skipped += std::string(skipped.empty() ? "" : ", ") + name_of(decision.effect);
  }
  if (skipped.empty()) return;
  throw InputError(scene.file, "found no light left when these are skipped: " + skipped + "; expected one at least");
}

// With light that is not reflected again the rows of the lamps are enough, and no matrix is needed.
bool takes_lamps_alone(const Plan& plan) {
  return !simulates(plan, Effect::interreflection) && !plan.close && !plan.standard_errors &&
         plan.estimator == Estimator::automatic;
}

// A sun below the horizon gives no light.
std::vector<std::string> notes_on_sun(const Scene& scene) {
  if (!scene.sun || scene.sun->direction.dot(scene.up) > 0) return {};
  const double altitude = std::asin(std::max(-1.0, scene.sun->direction.dot(scene.up))) * 180 / std::numbers::pi;
  std::ostringstream text;
  text.precision(3);
  text << "the sun is " << -altitude << " degrees below the horizon: it gives no light";
  return {text.str()};
}

// Every kept side takes a patch at least. Of a model with many small faces the large ones have to be cut as well, as
// the light varies over them: a quarter more patches than the least goes to these.
std::size_t enough_patches(std::size_t asked, std::size_t least) {
  constexpr std::size_t few = 1000;  // for so few a quarter is not worth a word
  return least > few ? std::max(asked, least + least / 4) : asked;
}

std::string note_on_patches(const Scene& scene, std::size_t asked, std::size_t wanted) {
  return "the model's " + std::to_string(scene.polygons.size()) + " faces take " + std::to_string(wanted) +
         " patches, not " + std::to_string(asked) +
         ", for its large ones to be cut as well; a simpler model takes fewer";
}

}  // namespace

Plan make_plan(const Scene& scene, const Request& request) {
  require_lamp(scene);
  Plan plan = plan_form_factors(scene, request);
  const EffectFacts facts = survey_effects(scene, plan.sides);
  plan.decisions = decide(facts, request);
  for (std::string& note : notes_on_overruling(facts, request)) plan.notes.push_back(std::move(note));
  require_light(scene, facts, plan);
  plan.close = simulates(plan, Effect::closure);
  if (takes_lamps_alone(plan)) plan.storage = Storage::on_demand;
  // By force every pair takes its rays, also those between which nothing is found to stand.
  if (simulates(plan, Effect::occlusion) && facts.inside_hull == 0) plan.short_cuts.free = false;
  if (!simulates(plan, Effect::colour) && facts.grey && facts.lamp_colour) plan.lamp_colour = *facts.lamp_colour;
  plan.solver.every_band = simulates(plan, Effect::colour) && facts.grey && facts.lamp_colour;
  for (std::string& note : notes_on_sun(scene)) plan.notes.push_back(std::move(note));
  for (std::string& note : notes_on_luminaires_behind(scene)) plan.notes.push_back(std::move(note));
  if (request.kept_sides) {
    for (std::string& note : notes_on_left_out_sides(scene, *request.kept_sides, request.sides))
      plan.notes.push_back(std::move(note));
  }
  return plan;
}

bool refines(const Request& request) { return request.accuracy || request.seconds; }

KeptSides sides_for(const Scene& scene, const Request& request) {
  assert(!request.kept_sides || request.kept_sides->front.size() == scene.polygons.size());
  if (request.kept_sides) return *request.kept_sides;
  return kept_sides(
      scene, request.sides,
      {.unreached = contains(request.force, Effect::reach), .turned_away = contains(request.force, Effect::backs)});
}

Plan plan_form_factors(const Scene& scene, const Request& request) {
  assert(!request.max_edge || *request.max_edge > 0);
  const bool nested = request.error_bars || refines(request);
  Plan plan;
  plan.sides = sides_for(scene, request);
  for (Problem& problem : problems_with_size(scene)) plan.notes.push_back(std::move(problem.what));
  std::size_t asked = 0;
  if (request.max_edge) {
    plan.max_edge = *request.max_edge;
  } else {
    asked = request.patches.value_or(refines(request) ? first_patches : default_patches);
    const std::size_t least = least_patches(scene, plan.sides);
    const std::size_t wanted = nested ? std::max(asked, 4 * least) : enough_patches(asked, least);
    if (wanted > asked && !nested) plan.notes.push_back(note_on_patches(scene, asked, wanted));
    // A nested mesh is made from parents with edges twice as long.
    const double edge = max_edge_for(scene, plan.sides, nested ? wanted / 4 : wanted);
    plan.max_edge = nested ? edge / 2 : edge;
  }
  const double outline_edge = nested ? 2 * plan.max_edge : plan.max_edge;
  for (std::string& note : notes_on_fine_outlines(scene, plan.sides, asked, outline_edge))
    plan.notes.push_back(std::move(note));
  plan.samples = request.samples;
  plan.seed = request.seed;
  plan.estimator = request.estimator;
  plan.short_cuts = request.short_cuts;
  plan.error_bars = nested;
  plan.standard_errors = request.standard_errors || nested;
  plan.accuracy = request.accuracy;
  plan.seconds = request.seconds;
  plan.interest = request.interest;
  plan.storage = request.storage;
  plan.close = request.close && keeps_entries(request.storage);
  plan.solver = {.solver = request.solver,
                 .relative_error = request.tolerance.value_or(default_tolerance),
                 .max_iterations = request.max_iterations,
                 .max_rows = request.max_rows,
                 .relaxation = request.relaxation};
  return plan;
}

bool simulates(const Plan& plan, Effect effect) {
  return std::none_of(plan.decisions.begin(), plan.decisions.end(),
                      [effect](const Decision& decision) { return decision.effect == effect && !decision.simulate; });
}

AssemblyOptions assembly_options(const Plan& plan) {
  return {plan.samples, plan.seed, plan.standard_errors, plan.estimator, plan.short_cuts};
}

}  // namespace patchlight
