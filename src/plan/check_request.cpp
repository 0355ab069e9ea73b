#include "plan/check_request.h"

#include "patchlight/base/error.h"

#include "accuracy/spaces.h"

#include <initializer_list>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

// A part of a request as messages name it, and whether the request sets it.
struct Asked {
  std::string part;
  bool is_asked = true;
};

Asked forced(const Request& request, Effect effect) {
  return {std::string("effects.force=") + name_of(effect), contains(request.effects.force, effect)};
}

Asked skipped(const Request& request, Effect effect) {
  return {std::string("effects.skip=") + name_of(effect), contains(request.effects.skip, effect)};
}

Asked on_demand(const Request& request) {
  return {"assembly.storage=on_demand", request.assembly.storage == Storage::on_demand};
}

Asked tiles(const Request& request) { return {"assembly.storage=tiles", request.assembly.storage == Storage::tiles}; }

Asked rows_of_rays(const Request& request) {
  return {"assembly.storage=rays", request.assembly.storage == Storage::rays};
}

Asked not_closed(const Request& request) { return {"assembly.close=false", !request.assembly.close}; }

Asked form_factors(const Given& given) { return {"given.form_factors", given.form_factors}; }

Asked ray_rows(const Given& given) { return {"given.ray_rows", given.ray_rows}; }

Asked mesh_of(const Given& given) { return {"given.mesh", given.mesh}; }

Asked other_estimator(const Request& request) {
  const Estimator estimator = request.assembly.estimator;
  return {std::string("assembly.estimator=") + name_of(estimator), estimator != Estimator::automatic};
}

Asked short_cuts(const Request& request) {
  const ShortCuts& taken = request.assembly.short_cuts;
  return {"assembly.short_cuts", !taken.hidden || !taken.free || !taken.far};
}

Asked samples(const Request& request) {
  return {"assembly.samples", request.assembly.samples != AssemblyOptions().samples};
}

Asked kept_errors(const Request& request) { return {"assembly.keep_errors", request.assembly.keep_errors}; }

Asked max_rows(const Request& request) { return {"solver.max_rows", request.solver.max_rows.has_value()}; }

// The option that requests error bars.
Asked error_bars(const AccuracyOptions& accuracy) {
  if (accuracy.relative_error) return {"accuracy.relative_error"};
  if (accuracy.seconds) return {"accuracy.seconds"};
  return {"accuracy.error_bars", accuracy.error_bars};
}

Asked rays(const Request& request) { return {"assembly.rays", request.assembly.rays != AssemblyOptions().rays}; }

// Refuses those of `others` that the request sets together with `one`.
void require_alone(const Asked& one, std::initializer_list<Asked> others, const std::string& why) {
  if (!one.is_asked) return;
  for (const Asked& other : others) {
    if (!other.is_asked) continue;
    throw InputError(one.part, "cannot be used with " + other.part + ": " + why);
  }
}

void require_consistent_effects(const Request& request, const Given& given) {
  for (const Effect effect : request.effects.force)
    require_alone(skipped(request, effect), {forced(request, effect)}, "an effect is either simulated or left out");
  const auto decides = [&](Effect effect, const Asked& other, const std::string& why) {
    for (const Asked& asked : {forced(request, effect), skipped(request, effect)}) require_alone(asked, {other}, why);
  };
  const MeshOptions& mesh = request.mesh;
  for (const Effect effect : {Effect::reach, Effect::backs}) {
    decides(effect, {std::string("mesh.sides=") + name_of(mesh.sides), mesh.sides != Sides::automatic},
            "that option already chooses the sides");
    decides(effect, {"mesh.kept_sides", mesh.kept_sides.has_value()}, "only the stored sides are simulated");
  }
  for (const Asked& known : {form_factors(given), ray_rows(given)})
    decides(Effect::occlusion, known, "stored form factors decide it");
  require_alone(forced(request, Effect::closure), {not_closed(request)}, "one closes the rows and the other does not");
  require_alone(forced(request, Effect::closure), {on_demand(request)}, "form factors on demand cannot be closed");
  require_alone(forced(request, Effect::closure), {rows_of_rays(request)}, "the ray method closes each row by itself");
  require_alone(forced(request, Effect::mirrors), {tiles(request), on_demand(request)},
                "the pair method does not follow light over mirrors");
}

void require_solver_for(const Request& request) {
  require_alone(rows_of_rays(request), {max_rows(request)}, "the ray method does not compute single rows");
  const Solver solver = request.solver.solver;
  const std::string found =
      std::string("cannot be used with solver.solver=") + name_of(solver) + "\nhint: solver.solver=";
  if (request.solver.relaxation && solver != Solver::sor)
    throw InputError("solver.relaxation", found + name_of(Solver::sor));
  for (const Asked& asked : {max_rows(request), on_demand(request)}) {
    if (!asked.is_asked || is_shooting(solver)) continue;
    throw InputError(asked.part, found + name_of(Solver::progressive) + " or " + name_of(Solver::overshooting));
  }
  // Rows of rays are neither reciprocal nor had from the side of their sources.
  if (rows_of_rays(request).is_asked && (takes_rows(solver) || takes_reciprocity(solver)))
    throw InputError(rows_of_rays(request).part, found + "gmres, bicgstab, jacobi or chebyshev");
  if (request.solver.reference)
    throw InputError("solver.reference", "must be empty: a reference needs the mesh of the run");
}

// Conjugate gradients are the default; the plan replaces them by gmres.
void require_solver_for_sheets(const Request& request, const Scene& scene) {
  const Solver solver = request.solver.solver;
  if (solver == Solver::cg || !takes_diagonal(solver)) return;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (!is_sheet(scene, p)) continue;
    throw InputError(std::string("solver.solver=") + name_of(solver),
                     "cannot solve a translucent sheet, of material '" +
                         scene.materials[scene.polygons[p].material].name +
                         "'\nhint: solver.solver=gmres, bicgstab or jacobi");
  }
}

// Rows on demand are found by the automatic estimator, and cannot be closed, as that takes all; rows of rays take the
// place of any estimator.
void require_rows_possible(const Request& request, const Given& given) {
  const Asked rows = on_demand(request);
  require_alone(not_closed(request), {rows}, "form factors on demand are never closed");
  require_alone(other_estimator(request), {rows}, "form factors on demand need the automatic estimator");
  require_alone(form_factors(given), {rows, rows_of_rays(request)}, "stored form factors are not computed again");
  require_alone(rows_of_rays(request), {not_closed(request), skipped(request, Effect::closure)},
                "the ray method closes each row by itself");
  require_alone(rows_of_rays(request),
                {other_estimator(request), short_cuts(request), kept_errors(request), samples(request)},
                "these belong to the pair method");
  if (rays(request).is_asked && !rows_of_rays(request).is_asked)
    throw InputError("assembly.rays", std::string("cannot be used with assembly.storage=") +
                                          name_of(request.assembly.storage) + "\nhint: assembly.storage=rays");
}

// The options that rule out error bars, with reasons. Error bars need the closed matrix of the automatic estimator,
// computed in the run, and a solution that is exact up to the solver's error.
std::vector<std::pair<Asked, const char*>> obstacles_to_error_bars(const Request& request, const Given& given) {
  const char* const found_in_the_run = "error bars need form factors that are computed in this run";
  const char* const closed = "error bars need closure";
  return {{on_demand(request), found_in_the_run},
          {form_factors(given), found_in_the_run},
          {ray_rows(given), "error bars need further rays, which stored form factors do not allow"},
          {mesh_of(given), "error bars need a nested mesh"},
          {not_closed(request), closed},
          {skipped(request, Effect::closure), closed},
          {skipped(request, Effect::interreflection), "error bars need interreflection"},
          {other_estimator(request), "error bars need the automatic estimator"},
          {max_rows(request), "error bars need a converged solution"}};
}

void require_error_bars_possible(const Request& request, const Given& given) {
  const Asked bars = error_bars(request.accuracy);
  if (!bars.is_asked && !request.accuracy.interest.empty()) {
    throw InputError(
        "accuracy.interest",
        "needs an error to minimize\nhint: accuracy.relative_error, accuracy.seconds or accuracy.error_bars");
  }
  for (const auto& [asked, why] : obstacles_to_error_bars(request, given)) require_alone(bars, {asked}, why);
}

}  // namespace

void check(const Request& request, const Given& given) {
  require_alone({"mesh.max_edge", request.mesh.max_edge.has_value()},
                {{"mesh.patches", request.mesh.patches.has_value()}}, "both set the size of the patches");
  require_solver_for(request);
  require_rows_possible(request, given);
  require_alone(short_cuts(request), {other_estimator(request)}, "only the automatic estimator has shortcuts");
  require_alone(kept_errors(request), {other_estimator(request)}, "only the automatic estimator knows these errors");
  require_consistent_effects(request, given);
  require_error_bars_possible(request, given);
}

std::optional<std::string> part_that_takes_pairs(const Request& request, const Given& given) {
  const Solver solver = request.solver.solver;
  const bool takes_entries = solver != Solver::cg && (takes_rows(solver) || takes_reciprocity(solver));
  for (const Asked& asked :
       {tiles(request), on_demand(request), form_factors(given), ray_rows(given), mesh_of(given),
        Asked{"given.solver", given.solver}, other_estimator(request), samples(request), short_cuts(request),
        kept_errors(request), not_closed(request), forced(request, Effect::closure), skipped(request, Effect::closure),
        forced(request, Effect::occlusion), skipped(request, Effect::occlusion),
        skipped(request, Effect::interreflection), max_rows(request),
        Asked{std::string("solver.solver=") + name_of(solver), takes_entries}}) {
    if (asked.is_asked) return asked.part;
  }
  return std::nullopt;
}

void require_rays_for_colours(std::size_t coloured, const Request& chosen, const Request& asked, const Given& given) {
  if (coloured == 0 || chosen.assembly.storage == Storage::rays || given.ray_rows) return;
  // Without such a part pairs are taken for error bars of light that nothing reflects, and for form factors alone.
  const Asked bars = error_bars(asked.accuracy);
  const std::string part = part_that_takes_pairs(asked, given).value_or(bars.is_asked ? bars.part : "assembly.storage");
  throw InputError(part, "cannot be used with colored glazing or mirrors, here " + std::to_string(coloured) +
                             (coloured == 1 ? " material" : " materials") +
                             ": the pair method has one value for all bands\nhint: assembly.storage=rays");
}

std::optional<std::string> part_without_error_bars(const Request& request, const Given& given) {
  for (const auto& [asked, why] : obstacles_to_error_bars(request, given)) {
    if (asked.is_asked) return asked.part;
  }
  return std::nullopt;
}

void check(const Request& request, const Scene& scene, const Given& given) {
  check(request, given);
  require_solver_for_sheets(request, scene);
  require_names(scene, request.accuracy.interest);
}

}  // namespace patchlight
