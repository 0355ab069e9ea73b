#include "plan/choose_storage.h"

#include "plan/memory.h"

namespace patchlight {
namespace {

// What rows of rays do not give: errors of the mesh, given matrices, rows that are not closed, other estimators, and
// solvers that take columns or symmetry.
bool takes_pairs(const Request& request, const Given& given) {
  const AssemblyOptions& assembly = request.assembly;
  const bool of_effects = contains(request.effects.force, Effect::closure) ||
                          contains(request.effects.skip, Effect::closure) ||
                          contains(request.effects.skip, Effect::interreflection);
  const Solver solver = request.solver.solver;
  const bool of_solver = solver != Solver::cg && (takes_rows(solver) || takes_reciprocity(solver));
  return has_error_bars(request.accuracy) || given.form_factors || given.mesh || of_effects || !assembly.close ||
         assembly.keep_errors || assembly.estimator != Estimator::automatic || of_solver ||
         request.solver.max_rows.has_value();
}

}  // namespace

ChosenStorage choose_storage(const Request& request, const Given& given, const StoredLight& light) {
  ChosenStorage chosen{request, {}};
  if (request.assembly.storage != Storage::automatic) return chosen;
  chosen.request.assembly.storage = Storage::tiles;
  const double bytes = memory_needed(light.patches, chosen.request.assembly, request.accuracy);
  const bool too_many = light.patches > most_patches_in_pairs || bytes > usable_memory(request.resources);
  if (!too_many || !light.is_reflected || takes_pairs(request, given)) return chosen;
  chosen.request.assembly.storage = Storage::rays;
  if (request.solver.solver == Solver::cg) chosen.request.solver.solver = Solver::gmres;
  chosen.note = "form factors as rows of rays (assembly.storage=rays), as the pairs of " +
                std::to_string(light.patches) + " patches would take " + gigabytes(bytes) +
                " and far more time; what the size of the patches errs is not known then";
  return chosen;
}

}  // namespace patchlight
