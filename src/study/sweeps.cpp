#include "study/sweeps.h"

#include "patchlight/base/error.h"

#include "base/parallel.h"
#include "plan/memory.h"

#include <algorithm>
#include <string>
#include <utility>

namespace patchlight {
namespace {

// Estimators are compared so many sizes below the finest, with about a sixteenth of the patches; on so few pairs they
// differ as on many.
constexpr std::size_t coarser_sizes = 2;
// The hemisphere's samples are rays of a patch, not of a pair.
constexpr int hemisphere_factor = 64;
// What all of a sweep's samples are compared with has so many times more than the largest number of them.
constexpr int finer_samples = 4;

std::vector<double> tolerances_for(double finest) {
  std::vector<double> tolerances;
  for (double tolerance = 0.1; tolerance > 2 * finest; tolerance *= 0.1) tolerances.push_back(tolerance);
  tolerances.push_back(finest);
  return tolerances;
}

// Sizes of patches with as many samples as the finest one has, which is known already.
StudySweep sweep_sizes(const Experiment& experiment, const Reference& reference, StudySetting finest) {
  StudySweep sweep{"patch size at " + std::to_string(finest.samples) + " samples", Swept::patch_size, {}};
  Request asked = experiment.request;
  asked.assembly.samples = finest.samples;
  const std::vector<SizedMesh>& sizes = experiment.meshes.sizes;
  for (std::size_t k = 0; k + 1 < sizes.size(); ++k) {
    sweep.settings.push_back(judged(experiment.run(sizes[k], asked), reference));
  }
  finest.own_error = finest.error;
  sweep.settings.push_back(std::move(finest));
  return sweep;
}

// Half, once, twice and four times the samples asked for.
StudySweep sweep_samples(const Experiment& experiment, const Reference& reference, const Simulation& finest) {
  Request asked = experiment.request;
  const int usual = asked.assembly.samples;
  asked.assembly.samples = 4 * finer_samples * usual;
  const Field own = experiment.run(experiment.finest(), asked).solution.radiosity;
  StudySweep sweep{"samples", Swept::samples, {}};
  for (const int samples : {std::max(1, usual / 2), usual, 2 * usual, 4 * usual}) {
    asked.assembly.samples = samples;
    const int used = make_plan(experiment.scene, asked).assembly.samples;
    if (!sweep.settings.empty() && used == sweep.settings.back().samples) continue;
    const bool known = used == finest.plan.assembly.samples;
    sweep.settings.push_back(judged(known ? finest : experiment.run(experiment.finest(), asked), reference, own));
  }
  return sweep;
}

StudySweep sweep_tolerances(const Tolerances& tolerances, const Reference& reference) {
  StudySweep sweep{"tolerance", Swept::tolerance, {}};
  for (const Simulation& run : tolerances.runs) sweep.settings.push_back(judged(run, reference, tolerances.exact));
  return sweep;
}

}  // namespace

Tolerances solve_to_tolerances(const Experiment& experiment) {
  struct Run {
    double tolerance;
    Solution solution;
    StageCost cost;
  };
  std::vector<Run> runs;
  Tolerances result;
  const SolveWith solve_all = [&](const RowTransport& transport, const RadiosityProblem& problem,
                                  const SolverOptions& usual, const Observer& watch) {
    SolverOptions options = usual;
    for (const double tolerance : tolerances_for(tolerance_of(usual))) {
      options.relative_error = tolerance;
      const double wall = wall_seconds();
      const double cpu = cpu_seconds();
      Solution solution = solve(transport, problem, options, watch);
      runs.push_back({tolerance, std::move(solution), {Stage::solve, wall_seconds() - wall, cpu_seconds() - cpu}});
    }
    options.relative_error = std::max(1e-12, 0.01 * tolerance_of(usual));
    result.exact = solve(transport, problem, options, watch).radiosity;
    return runs.back().solution;
  };
  Simulation simulation = experiment.run(experiment.finest(), experiment.request, solve_all);
  for (Run& run : runs) {
    simulation.plan.solver.relative_error = run.tolerance;
    simulation.solution = std::move(run.solution);
    for (StageCost& cost : simulation.costs) {
      if (cost.stage == Stage::solve) cost = run.cost;
    }
    result.runs.push_back(simulation);
  }
  return result;
}

std::vector<StudySweep> competing_sweeps(const Experiment& experiment, const Reference& reference,
                                         const Tolerances& tolerances) {
  const Simulation& finest = tolerances.runs.back();
  StudySweep by_samples = sweep_samples(experiment, reference, finest);
  StudySweep usual = sweep_sizes(experiment, reference, judged(finest, reference));
  StudySweep more = sweep_sizes(experiment, reference, by_samples.settings.back());
  return {std::move(usual), std::move(more), std::move(by_samples), sweep_tolerances(tolerances, reference)};
}

std::vector<Simulation> solve_to_accuracies(const Experiment& experiment) {
  std::vector<Simulation> solved;
  Request asked = experiment.request;
  asked.mesh.patches.reset();
  asked.mesh.max_edge = experiment.meshes.coarsest_edge / 2;
  asked.accuracy.error_bars = true;
  const std::size_t most = experiment.finest().mesh.size();
  for (const double accuracy : {0.1, 0.03, 0.01, 0.003}) {
    asked.accuracy.relative_error = accuracy;
    asked.resources.memory =
        std::min(usable_memory(experiment.request.resources), memory_needed(most, asked.assembly, asked.accuracy));
    try {
      Simulation simulation = simulate(experiment.scene, asked, experiment.observer);
      const bool new_one = solved.empty() || simulation.mesh.size() != solved.back().mesh.size() ||
                           simulation.plan.assembly.samples != solved.back().plan.assembly.samples;
      if (new_one) solved.push_back(std::move(simulation));
    } catch (const MemoryError&) {
      break;  // the reference of more than that would be too large
    }
  }
  return solved;
}

StudySweep adaptive_sweep(const std::vector<Simulation>& solved, const Reference& reference) {
  StudySweep sweep{"adaptive", Swept::patch_size, {}};
  for (const Simulation& simulation : solved) sweep.settings.push_back(judged(simulation, reference));
  return sweep;
}

std::vector<StudySweep> estimator_sweeps(const Experiment& experiment, const Reference& reference) {
  const std::vector<SizedMesh>& sizes = experiment.meshes.sizes;
  const SizedMesh& mesh = sizes[sizes.size() - 1 - std::min(coarser_sizes, sizes.size() - 1)];
  Request asked = experiment.request;
  const int usual = asked.assembly.samples;
  asked.assembly.samples = finer_samples * 16 * usual;
  const Field own = experiment.run(mesh, asked).solution.radiosity;
  std::vector<StudySweep> sweeps;
  for (const Estimator estimator :
       {Estimator::automatic, Estimator::area, Estimator::point_polygon, Estimator::hemisphere, Estimator::contour}) {
    StudySweep sweep{std::string("estimator ") + name_of(estimator), Swept::samples, {}, false};
    asked.assembly.estimator = estimator;
    for (const int factor : {1, 4, 16}) {
      asked.assembly.samples = factor * usual * (estimator == Estimator::hemisphere ? hemisphere_factor : 1);
      sweep.settings.push_back(judged(experiment.run(mesh, asked), reference, own));
    }
    sweeps.push_back(std::move(sweep));
  }
  return sweeps;
}

}  // namespace patchlight
