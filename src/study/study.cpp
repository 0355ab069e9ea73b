#include "study/study.h"

#include "patchlight/base/error.h"

#include "base/parallel.h"
#include "plan/check_request.h"
#include "plan/memory.h"
#include "study/error_parts.h"
#include "study/experiment.h"
#include "study/price.h"
#include "study/reference.h"
#include "study/sweeps.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

// What the settings are compared with, and what is told about it.
struct ReferenceSolution {
  Reference reference;
  StudyReference facts;
};

// A quarter of the patches' area of the finest size and of every adaptive mesh, so that means over the patches of all
// can be taken of it. Adaptive meshes for which it would not fit into memory are given up, the finest first.
SizedMesh mesh_of_reference(const Experiment& experiment, std::vector<Simulation>& adaptive) {
  SizedMesh reference = experiment.meshes.finer;
  for (std::size_t k = 0; k < adaptive.size(); ++k) {
    PatchMesh finer = finer_than(reference.mesh, adaptive[k].mesh);
    if (memory_needed(finer.size(), experiment.request.assembly, experiment.request.accuracy) >
        usable_memory(experiment.request.resources)) {
      adaptive.resize(k);
      break;
    }
    reference.mesh = std::move(finer);
  }
  return reference;
}

ReferenceSolution reference_solution(const Experiment& experiment, const Simulation& finest,
                                     std::vector<Simulation>& adaptive) {
  ReferenceSolution found;
  found.reference.uniform = furnace_radiosity(finest.problem);
  found.facts.closed_form = found.reference.uniform && finest.transport.lost.closed();
  if (found.facts.closed_form) return found;
  Request asked = experiment.request;
  asked.assembly.samples *= 4;
  asked.solver.relative_error = std::max(1e-12, 0.01 * tolerance_of(asked.solver));
  const Simulation finer = experiment.run(mesh_of_reference(experiment, adaptive), asked);
  found.reference = reference_from(finer);
  const StudySetting setting = setting_of(finer);
  found.facts.patches = setting.patches;
  found.facts.uniform_patches = experiment.meshes.finer.mesh.size();
  found.facts.samples = setting.samples;
  found.facts.cpu_seconds = cpu_seconds_of(setting);
  found.facts.converged = finer.solution.converged;
  return found;
}

}  // namespace

double seconds_of(const StudySetting& setting) {
  double sum = 0;
  for (const StageCost& cost : setting.costs) sum += cost.seconds;
  return sum;
}

double cpu_seconds_of(const StudySetting& setting) {
  double sum = 0;
  for (const StageCost& cost : setting.costs) sum += cost.cpu_seconds;
  return sum;
}

void check_for_study(const Request& request) {
  check(request);
  const Estimator estimator = request.assembly.estimator;
  if (estimator == Estimator::automatic) return;
  throw InputError("assembly.estimator",
                   std::string("found ") + name_of(estimator) + "; a study compares all of them: leave it out");
}

Study study(const Scene& scene, const Request& request, const StudyOptions& options, const Observer& observer) {
  const ThreadLimit threads(request.resources.threads);
  check_for_study(request);
  // 1. The finest setting of the sweeps, and what all are judged by.
  const Experiment experiment = experiment_for(scene, request, options.sizes, observer);
  const Tolerances tolerances = solve_to_tolerances(experiment);
  const Simulation& finest = tolerances.runs.back();
  Study result;
  result.plan = finest.plan;
  result.notes = finest.notes;
  result.trapped = finest.solution.trapped;
  if (!result.trapped.empty()) return result;
  std::vector<Simulation> adaptive;
  if (options.adaptive) adaptive = solve_to_accuracies(experiment);
  const ReferenceSolution solution = reference_solution(experiment, finest, adaptive);
  const Reference& reference = solution.reference;
  result.reference = solution.facts;

  // 2. One quantity at a time, all together, and the estimators.
  result.sweeps = competing_sweeps(experiment, reference, tolerances);
  if (options.adaptive) result.sweeps.push_back(adaptive_sweep(adaptive, reference));
  if (options.estimators) {
    for (StudySweep& sweep : estimator_sweeps(experiment, reference)) result.sweeps.push_back(std::move(sweep));
  }

  // 3. Orders, the reference's own error, the Pareto front, and what limits the finest setting.
  const double patches = patches_of(solution.facts);
  for (StudySweep& sweep : result.sweeps) sweep = with_orders(std::move(sweep), patches);
  const StudySweep& by_size = result.sweeps[1];
  result.reference.bar = solution.facts.closed_form ? 0 : richardson_bar(by_size, patches);
  result.parts = error_parts(scene, finest, discrepancy(finest, reference), result.sweeps);
  return with_fronts(std::move(result));
}

}  // namespace patchlight
