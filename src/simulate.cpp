#include "patchlight/simulate.h"

#include "patchlight/mesh/mesher.h"

#include "base/parallel.h"
#include "check_request.h"
#include "effects.h"
#include "memory.h"
#include "plan/close_lamps.h"
#include "problem_of.h"
#include "relative_errors.h"
#include "solve_mesh.h"
#include "stage_clock.h"
#include "to_accuracy.h"
#include "visibility/tracing.h"

#include <cassert>
#include <memory>
#include <utility>

namespace patchlight {

Simulation simulate(const Scene& scene, const Request& request, const Observer& observer, const Steps& with) {
  const ThreadLimit threads(request.threads);
  StageClock clock;

  // 1. Survey the scene; decide which effects are simulated, which sides take part, how finely they are subdivided, and
  //    how form factors and radiosities are found.
  check(request, scene);
  Plan plan = make_plan(scene, request);
  assert(!with.exchange || (keeps_entries(request.storage) && !plan.error_bars));
  assert(!with.mesh || !plan.error_bars);
  if (with.exchange) plan.storage = Storage::tiles;
  const Request planned = as_planned(request, plan);
  require_memory(scene, planned);
  const Scene lit = scene_as_planned(scene, plan);
  clock.finish(Stage::plan);

  // 2. What stands between patches, and what lies on them.
  const auto tracing = std::make_shared<const Tracing>(scene, find_coverings(scene, plan.sides), blockers_of(plan));
  for (const Problem& problem : problems_with_overlaps(scene, tracing->coverings())) plan.notes.push_back(problem.what);
  // Where patches are refined, error bars see a lamp that is close.
  if (!refines(request)) {
    for (std::string& note : notes_on_close_lamps(scene, tracing->between_patches(), plan.max_edge))
      plan.notes.push_back(std::move(note));
  }

  // 3. Subdivide the kept sides of the polygons into patches, find their form factors and solve
  //    B = E + rho o (F B + H_direct); until an accuracy is reached where one is asked for.
  const Setting setting{lit, tracing, with, observer};
  Simulation result = refines(request) ? solve_to_accuracy(setting, planned, plan, clock).simulation
                                       : solve_mesh(setting, planned, plan, clock).simulation;
  result.spaces = errors_by_space(lit, result);
  result.costs = clock.costs();
  return of_whole_patches(std::move(result), lit);
}

}  // namespace patchlight
