#include "pipeline/solved.h"

#include "accuracy/enclosed.h"
#include "base/vectors.h"
#include "pipeline/light_of_lamps.h"
#include "pipeline/notes_on_run.h"
#include "pipeline/solve_for_interest.h"
#include "solve/energy.h"

#include <limits>
#include <utility>

namespace patchlight {
namespace {

// No light is negative. Iterations leave patches slightly below 0 where hardly any light arrives: that is their error.
Solution without_negative_light(Solution solution, const RadiosityProblem& problem) {
  if ((solution.irradiance >= 0).all() && (solution.radiosity >= 0).all()) return solution;
  solution.irradiance = solution.irradiance.max(0.0);
  solution.radiosity = radiosity_from(problem, solution.irradiance);
  return solution;
}

Simulation solved_by_rays(const Run& run, Simulation simulation, const MeshTransport& transport) {
  const TransportFacts& facts = simulation.transport;
  SolverOptions options = simulation.plan.solver;
  options.largest_row_sum = largest(facts.row_sum);
  // Several solutions stand behind one by rays: none of them is one without the others.
  options.keeps_unfinished = false;
  RaySolution found;
  const Solve once = [&](const SolverOptions& by) {
    found = solve_with_rays(run, simulation.mesh, *transport.rays, *transport.light, facts, by);
    return std::move(found.solution);
  };
  SolvedWith best = solve_for_interest(run, simulation, options, once);
  simulation.plan.solver.relative_error = best.relative_error;
  simulation.solution = without_negative_light(std::move(best.solution), simulation.problem);
  simulation.ray_standard_error = std::move(found.standard_error);
  simulation.correlated_errors = std::move(found.correlated_errors);
  simulation.balance = energy_balance(simulation.problem, simulation.solution, facts.row_sum, facts.lost);
  return simulation;
}

// Every iterate is kept.
Observer telling_what_is_kept(const Run& run) {
  return [&run](const Progress& progress) {
    if (progress.iteration != nullptr) run.with.keeps_unfinished();
    return !run.observer || run.observer(progress);
  };
}

}  // namespace

Simulation solved(const Run& run, const MeshToSolve& meshed, const MeshTransport& transport, LitProblem problem) {
  Simulation simulation;
  simulation.plan = meshed.plan;
  simulation.notes = run.notes;
  simulation.mesh = meshed.mesh.patches;
  simulation.transport = transport.facts;
  simulation.problem = std::move(problem.problem);
  simulation.direct_standard_error = std::move(problem.direct_standard_error);
  simulation.tracing = run.tracing;
  if (run.scene.sky || run.scene.sun)
    simulation.enclosed = enclosed_patches(run.scene, run.tracing->all_faces(run.scene), simulation.mesh);
  if (run.with.exchange || run.with.ray_exchange) {
    for (std::string& note : notes_on_hidden_lamps(run.scene, simulation)) simulation.notes.push_back(std::move(note));
  }

  if (transport.rays) return solved_by_rays(run, std::move(simulation), transport);

  const bool keeps = keeps_entries(meshed.plan.assembly.storage);
  const TransportFacts& facts = simulation.transport;
  SolverOptions options = meshed.plan.solver;
  options.largest_row_sum = keeps ? largest(facts.row_sum) : std::numeric_limits<double>::infinity();
  const SolveWith solve = solver_as_planned(run.with.solve, meshed.plan);
  const Observer observer = options.keeps_unfinished ? telling_what_is_kept(run) : run.observer;
  const Solve once = [&](const SolverOptions& by) { return solve(*transport.rows, simulation.problem, by, observer); };
  SolvedWith found = solve_for_interest(run, simulation, options, once);
  simulation.plan.solver.relative_error = found.relative_error;
  simulation.solution = without_negative_light(std::move(found.solution), simulation.problem);
  simulation.balance = energy_balance(simulation.problem, simulation.solution,
                                      keeps ? facts.row_sum : expected_row_sum(facts.lost), facts.lost);
  return simulation;
}

}  // namespace patchlight
