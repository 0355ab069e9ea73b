#include "study/study.h"

#include "patchlight/base/error.h"

#include "base/parallel.h"
#include "base/vectors.h"
#include "plan/check_request.h"
#include "plan/choose_storage.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace patchlight {
namespace {

// The inputs that all settings of a study share.
struct Experiment {
  const Scene& scene;
  Request request;  // of the finest setting
  NestedSizes meshes;
  Observer observer;

  const SizedMesh& finest() const { return meshes.sizes.back(); }
  // Solves on one of the meshes.
  Simulation run(const SizedMesh& on, const Request& asked, const SolveWith& solve = patchlight::solve) const;
};

Simulation Experiment::run(const SizedMesh& on, const Request& asked, const SolveWith& solve) const {
  Request of_mesh = asked;
  of_mesh.effects.force.push_back(Effect::interreflection);  // a matrix and a solver, even where no light is reflected
  of_mesh.mesh.patches.reset();
  of_mesh.mesh.max_edge = on.max_edge;
  return simulate(scene, of_mesh, observer, {.solve = solve, .mesh = [&on] { return on.mesh; }});
}

// Throws MemoryError when the reference would not fit.
Experiment experiment_for(const Scene& scene, const Request& request, int sizes, const Observer& observer) {
  return {scene, request, nested_sizes(scene, request, sizes), observer};
}

// The cost of a solution; its errors are not set.
StudySetting setting_of(const Simulation& simulation) {
  const Plan& plan = simulation.plan;
  StudySetting setting;
  setting.patches = simulation.mesh.size();
  setting.estimator = plan.assembly.estimator;
  setting.samples = plan.assembly.samples;
  setting.tolerance = tolerance_of(plan.solver);
  setting.costs = simulation.costs;
  setting.matrix_bytes = static_cast<double>(ExchangeAreas::bytes(setting.patches));
  return setting;
}

// The finest setting, solved to several tolerances on one matrix.
struct StudyTolerances {
  std::vector<Simulation> runs;  // from loose to tight; the last one is the finest setting
  Field exact;                   // radiosity, to a hundredth of the last tolerance
};

// The run that a sweep of samples is compared with has so many times more than the largest number of them.
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

StudySweep sweep_tolerances(const StudyTolerances& tolerances, const Reference& reference) {
  StudySweep sweep{"tolerance", Swept::tolerance, {}};
  for (const Simulation& run : tolerances.runs) sweep.settings.push_back(judged(run, reference, tolerances.exact));
  return sweep;
}

// Solves to 0.1, 0.01, ... down to the tolerance of the request.
StudyTolerances solve_to_tolerances(const Experiment& experiment) {
  struct Run {
    double tolerance;
    Solution solution;
    StageCost cost;
  };
  std::vector<Run> runs;
  StudyTolerances result;
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

// One quantity at a time. Sizes are swept with the usual samples, and with four times as many: there the error of the
// mesh is seen to fall; that is the second sweep.
std::vector<StudySweep> competing_sweeps(const Experiment& experiment, const Reference& reference,
                                         const StudyTolerances& tolerances) {
  const Simulation& finest = tolerances.runs.back();
  StudySweep by_samples = sweep_samples(experiment, reference, finest);
  StudySweep usual = sweep_sizes(experiment, reference, judged(finest, reference));
  StudySweep more = sweep_sizes(experiment, reference, by_samples.settings.back());
  return {std::move(usual), std::move(more), std::move(by_samples), sweep_tolerances(tolerances, reference)};
}

// As `solve --accuracy` does it: patches and samples are refined from the coarsest mesh on until an accuracy is met,
// as long as that takes no more than the patches of the finest size. Their meshes are cut from that of the
// experiment's coarsest size.
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

// The solutions to accuracies as a sweep.
StudySweep adaptive_sweep(const std::vector<Simulation>& solved, const Reference& reference) {
  StudySweep sweep{"adaptive", Swept::patch_size, {}};
  for (const Simulation& simulation : solved) sweep.settings.push_back(judged(simulation, reference));
  return sweep;
}

// The estimators of form factors on a small mesh, which do not compete: two sizes below the finest, with about a
// sixteenth of the patches, they differ as on many.
std::vector<StudySweep> estimator_sweeps(const Experiment& experiment, const Reference& reference) {
  const std::vector<SizedMesh>& sizes = experiment.meshes.sizes;
  const SizedMesh& mesh = sizes[sizes.size() - 1 - std::min<std::size_t>(2, sizes.size() - 1)];
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
      // The hemisphere's samples are rays of a patch, not of a pair.
      asked.assembly.samples = factor * usual * (estimator == Estimator::hemisphere ? 64 : 1);
      sweep.settings.push_back(judged(experiment.run(mesh, asked), reference, own));
    }
    sweeps.push_back(std::move(sweep));
  }
  return sweeps;
}

// The own error of the setting with these samples and this tolerance in the sweep of one of them.
double own_error(const std::vector<StudySweep>& sweeps, Swept swept, const Plan& plan) {
  for (const StudySweep& sweep : sweeps) {
    if (!sweep.competes || sweep.swept != swept) continue;
    for (const StudySetting& setting : sweep.settings) {
      if (setting.samples == plan.assembly.samples && setting.tolerance == tolerance_of(plan.solver))
        return setting.own_error;
    }
  }
  return 0;
}

// Squares summed by what each patch belongs to: the largest sum and where it is.
template <typename BelongsTo>
std::pair<double, std::size_t> largest_sum(const Eigen::VectorXd& squares, std::size_t places, BelongsTo belongs_to) {
  std::vector<double> sums(places);
  for (Eigen::Index i = 0; i < squares.size(); ++i) sums[belongs_to(static_cast<std::size_t>(i))] += squares[i];
  const auto largest = std::max_element(sums.begin(), sums.end());
  return {*largest, static_cast<std::size_t>(largest - sums.begin())};
}

// The parts of the finest setting's error. The sweeps of samples and of tolerances give those of form factors and
// solver; the mesh has the remaining error.
ErrorParts error_parts(const Scene& scene, const Simulation& finest, const Discrepancy& discrepancy,
                       const std::vector<StudySweep>& sweeps) {
  ErrorParts parts;
  parts.form_factors = own_error(sweeps, Swept::samples, finest.plan);
  parts.solver = own_error(sweeps, Swept::tolerance, finest.plan);
  const double others = parts.form_factors * parts.form_factors + parts.solver * parts.solver;
  parts.mesh = std::sqrt(std::max(0.0, discrepancy.of_means * discrepancy.of_means - others));

  const PatchMesh& mesh = finest.mesh;
  const double all = total(discrepancy.squares);
  if (!(all > 0)) return parts;
  if (scene.groups.size() > 1) {
    const auto [sum, group] = largest_sum(discrepancy.squares, scene.groups.size(),
                                          [&](std::size_t i) { return scene.polygons[mesh.polygon[i]].group; });
    parts.worst_place = group_name(scene, static_cast<std::uint32_t>(group));
    parts.worst_share = sum / all;
  } else {
    const auto [sum, material] =
        largest_sum(discrepancy.squares, scene.materials.size(), [&](std::size_t i) { return mesh.material[i]; });
    parts.worst_place = scene.materials[material].name;
    parts.worst_share = sum / all;
  }
  return parts;
}

// The reference of all settings, and its facts for the report.
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

StudySetting judged(const Simulation& simulation, const Reference& reference) {
  StudySetting setting = setting_of(simulation);
  const Discrepancy found = discrepancy(simulation, reference);
  setting.error = found.of_means;
  setting.display_error = found.of_display;
  setting.own_error = found.of_means;
  return setting;
}

StudySetting judged(const Simulation& simulation, const Reference& reference, const FieldView& own) {
  StudySetting setting = judged(simulation, reference);
  setting.own_error = relative_error(own, simulation.solution.radiosity, simulation.problem);
  return setting;
}

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
  const StudyTolerances tolerances = solve_to_tolerances(experiment);
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

  // 3. Orders, the reference's own error, the Pareto front, and the limit of the finest setting.
  const double patches = patches_of(solution.facts);
  for (StudySweep& sweep : result.sweeps) sweep = with_orders(std::move(sweep), patches);
  const StudySweep& by_size = result.sweeps[1];
  result.reference.bar = solution.facts.closed_form ? 0 : richardson_bar(by_size, patches);
  result.parts = error_parts(scene, finest, discrepancy(finest, reference), result.sweeps);
  return with_fronts(std::move(result));
}

}  // namespace patchlight
