#include "patchlight/plan/plan.h"

#include "patchlight/base/error.h"
#include "patchlight/mesh/mesher.h"
#include "patchlight/plan/left_out_sides.h"
#include "patchlight/plan/survey.h"
#include "patchlight/visibility/convex_hull.h"

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

Decision decide_occlusion(const Scene& scene) {
  const auto on_hull = on_convex_hull(scene);
  const auto inner = std::count(on_hull.begin(), on_hull.end(), std::uint8_t{0});
  if (inner == 0)
    return {"occlusion", false, "all faces lie on one convex hull: nothing can stand between two patches"};
  return {"occlusion", true,
          std::to_string(inner) + " of " + std::to_string(scene.polygons.size()) +
              " faces lie inside the convex hull and can stand between two patches"};
}

Decision decide_interreflection(const Scene& scene) {
  double highest = 0;
  for (const Material& material : scene.materials) highest = std::max(highest, material.reflectance.maxCoeff());
  if (highest == 0)
    return {"interreflection", false, "all reflectances are 0: light is absorbed where it first arrives"};
  return {"interreflection", true, "the highest reflectance is " + std::to_string(highest)};
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
  plan.decisions = {decide_occlusion(scene), decide_interreflection(scene)};
  for (std::string& note : notes_on_sun(scene)) plan.notes.push_back(std::move(note));
  if (request.kept_sides) {
    for (std::string& note : notes_on_left_out_sides(scene, *request.kept_sides, request.sides))
      plan.notes.push_back(std::move(note));
  }
  return plan;
}

bool refines(const Request& request) { return request.accuracy || request.seconds; }

KeptSides sides_for(const Scene& scene, const Request& request) {
  assert(!request.kept_sides || request.kept_sides->front.size() == scene.polygons.size());
  return request.kept_sides ? *request.kept_sides : kept_sides(scene, request.sides);
}

Plan plan_form_factors(const Scene& scene, const Request& request) {
  assert(!request.max_edge || *request.max_edge > 0);
  const bool nested = request.error_bars || refines(request);
  Plan plan;
  plan.sides = sides_for(scene, request);
  if (request.max_edge) {
    plan.max_edge = *request.max_edge;
  } else {
    const std::size_t asked = request.patches.value_or(refines(request) ? first_patches : default_patches);
    const std::size_t least = least_patches(scene, plan.sides);
    const std::size_t wanted = nested ? std::max(asked, 4 * least) : enough_patches(asked, least);
    if (wanted > asked && !nested) plan.notes.push_back(note_on_patches(scene, asked, wanted));
    // A nested mesh is made from parents with edges twice as long.
    plan.max_edge = nested ? max_edge_for(scene, plan.sides, wanted / 4) / 2 : max_edge_for(scene, plan.sides, wanted);
  }
  // What unanimous probes miss would soon outweigh the error of the partly hidden pairs: both grow together.
  plan.probes = std::max(plan.probes, request.samples / 2);
  plan.samples = std::max(request.samples, plan.probes);
  plan.seed = request.seed;
  plan.estimator = request.estimator;
  plan.short_cuts = request.short_cuts;
  plan.error_bars = nested;
  plan.standard_errors = request.standard_errors || nested;
  plan.accuracy = request.accuracy;
  plan.seconds = request.seconds;
  plan.interest = request.interest;
  plan.on_demand = request.on_demand;
  plan.close = request.close && !request.on_demand;
  plan.solver = {.solver = request.solver,
                 .relative_error = request.tolerance,
                 .max_iterations = request.max_iterations,
                 .max_rows = request.max_rows,
                 .relaxation = request.relaxation};
  return plan;
}

AssemblyOptions assembly_options(const Plan& plan) {
  return {plan.probes, plan.samples, plan.seed, plan.standard_errors, plan.estimator, plan.short_cuts};
}

}  // namespace patchlight
