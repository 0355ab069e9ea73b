#include "pipeline/planned.h"

#include "plan/close_lamps.h"

#include <cassert>
#include <utility>

namespace patchlight {

Plan planned(const Scene& scene, const Request& request, const Steps& with) {
  Plan plan = make_plan(scene, request);
  assert(!with.exchange || (keeps_entries(request.storage) && !plan.error_bars));
  assert(!with.mesh || !plan.error_bars);
  if (with.exchange) plan.storage = Storage::tiles;
  return plan;
}

Plan with_notes_on(const Scene& scene, const Tracing& tracing, const Request& request, Plan plan) {
  for (const Problem& problem : problems_with_overlaps(scene, tracing.coverings())) plan.notes.push_back(problem.what);
  if (refines(request)) return plan;
  for (std::string& note : notes_on_close_lamps(scene, tracing.between_patches(), plan.max_edge))
    plan.notes.push_back(std::move(note));
  return plan;
}

}  // namespace patchlight
