#include "plan/choose_storage.h"

#include "plan/decide.h"
#include "plan/memory.h"

#include <utility>

namespace patchlight {

bool takes_pairs(const Request& request, const Given& given) {
  const AssemblyOptions& assembly = request.assembly;
  const AssemblyOptions usual;
  const bool of_sampling = assembly.estimator != usual.estimator || assembly.samples != usual.samples ||
                           assembly.keep_errors || !assembly.close || !assembly.short_cuts.hidden ||
                           !assembly.short_cuts.free || !assembly.short_cuts.far;
  const auto asked = [&](Effect effect) {
    return contains(request.effects.force, effect) || contains(request.effects.skip, effect);
  };
  const bool of_effects =
      asked(Effect::closure) || asked(Effect::occlusion) || contains(request.effects.skip, Effect::interreflection);
  const Solver solver = request.solver.solver;
  const bool of_solver = solver != Solver::cg && (takes_rows(solver) || takes_reciprocity(solver));
  return given.form_factors || given.ray_rows || given.mesh || given.solver || of_effects || of_sampling || of_solver ||
         request.solver.max_rows.has_value();
}

namespace {

// Requests and plans have these parts in common.
template <typename Parts>
Parts stored_as_rays(Parts parts) {
  parts.assembly.storage = Storage::rays;
  if (parts.solver.solver == Solver::cg) parts.solver.solver = Solver::gmres;
  return parts;
}

}  // namespace

Request by_rays(Request request) { return stored_as_rays(std::move(request)); }

Plan by_rays(Plan plan) {
  plan = stored_as_rays(std::move(plan));
  plan.assembly.keep_errors = false;
  for (Decision& decision : plan.decisions)
    if (decision.effect == Effect::closure) decision = closed_by_rays();
  return plan;
}

ChosenStorage choose_storage(const Request& request, const Given& given, const StoredLight& light) {
  ChosenStorage chosen{request, {}};
  const bool asks_for_rays = request.assembly.storage == Storage::rays;
  if (asks_for_rays && light.is_reflected && !given.mesh && !given.ray_rows) chosen.request.accuracy.error_bars = true;
  const bool lacks_bars = asks_for_rays && !light.is_reflected && has_error_bars(request.accuracy);
  if (request.assembly.storage != Storage::automatic && !lacks_bars) return chosen;
  chosen.request.assembly.storage = Storage::tiles;
  const double bytes = memory_needed(light.patches, chosen.request.assembly, request.accuracy);
  const bool fits = bytes <= usable_memory(request.resources);
  const bool too_many = light.patches > most_patches_in_pairs || !fits;
  if (!too_many || !light.is_reflected || takes_pairs(request, given)) return chosen;
  chosen.request = by_rays(std::move(chosen.request));
  chosen.request.accuracy.error_bars = true;
  chosen.note = "form factors are rows of rays (assembly.storage=rays), as all pairs of " +
                std::to_string(light.patches) + " patches would take " + gigabytes(bytes) +
                (fits ? " and much longer" : ", and " + gigabytes(usable_memory(request.resources)) + " may be taken") +
                "; assembly.storage=tiles takes pairs";
  return chosen;
}

}  // namespace patchlight
