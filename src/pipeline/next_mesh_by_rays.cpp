#include "pipeline/next_mesh_by_rays.h"

#include "pipeline/error_goals.h"
#include "pipeline/local_cuts.h"
#include "pipeline/out_of_reach.h"
#include "plan/memory.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace patchlight {
namespace {

// The plan of a mesh with so many rays of a patch in the mean, for its memory.
Plan with_rays_of(const LocalCuts& cuts, Plan plan) {
  plan.assembly.rays = static_cast<int>(std::ceil(times_the_rays(cuts) * plan.assembly.rays));
  return plan;
}

bool fits(const LocalCuts& cuts, const Plan& plan) {
  return memory_needed(cuts.light_place.size(), with_rays_of(cuts, plan)) <= usable_memory(plan.resources);
}

// A mesh grows no further at once, as it is told from the one before where; and no further than time and memory reach.
std::optional<LocalCuts> cuts_that_fit(const SolvedMesh& solved, const AccuracyStep& step, const RayGoal& goal) {
  constexpr double most_growth = 3;
  constexpr double most_more_rays = 2;
  constexpr double least_growth = 0.1;
  // Both patches and rays make a mesh dearer.
  double growth = std::min(most_growth, std::sqrt(std::max(0.0, goal.times)) - 1);
  for (; growth > least_growth; growth /= 2) {
    const double more_rays = std::min(most_more_rays, growth);
    LocalCuts cuts = local_cuts(solved, step, {goal.error / error_margin, growth, more_rays, more_rays, true});
    if (!cuts.changes || fits(cuts, solved.simulation.plan)) return cuts;
  }
  return std::nullopt;
}

}  // namespace

std::optional<MeshToSolve> next_mesh_by_rays(SolvedMesh& solved, std::span<const AccuracyStep> steps,
                                             const RayGoal& goal) {
  const AccuracyStep& step = steps.back();
  // What is left where more rays gain nothing they do not mend.
  constexpr double hardly = 0.95;
  if (step.new_patches == 0 && step.total > hardly * steps[steps.size() - 2].total) return std::nullopt;
  std::optional<LocalCuts> cuts = cuts_that_fit(solved, step, goal);
  if (!cuts) {
    const Plan& plan = solved.simulation.plan;
    if (plan.accuracy.seconds) return std::nullopt;
    constexpr double any = std::numeric_limits<double>::infinity();
    const LocalCuts wanted = local_cuts(solved, step, {goal.error / error_margin, any, any, any, true});
    refuse(with_rays_of(wanted, plan), {static_cast<double>(wanted.light_place.size()), step.total});
  }
  if (!cuts->changes) return std::nullopt;
  return mesh_with(std::move(*cuts), solved);
}

}  // namespace patchlight
