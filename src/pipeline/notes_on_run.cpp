#include "pipeline/notes_on_run.h"

#include "plan/close_lamps.h"

#include <utility>

namespace patchlight {

std::vector<std::string> notes_on_run(const Scene& scene, const Tracing& tracing, const Plan& plan) {
  std::vector<std::string> notes = plan.notes;
  for (const Problem& problem : problems_with_overlaps(scene, tracing.coverings())) notes.push_back(problem.what);
  if (refines(plan.accuracy)) return notes;
  for (std::string& note : notes_on_close_lamps(scene, tracing.between_patches(), plan.max_edge))
    notes.push_back(std::move(note));
  return notes;
}

}  // namespace patchlight
