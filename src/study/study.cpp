#include "patchlight/study/study.h"

#include "patchlight/base/error.h"
#include "patchlight/base/parallel.h"
#include "patchlight/mesh/mesher.h"
#include "patchlight/study/price.h"
#include "patchlight/study/reference.h"

#include "memory.h"
#include "problem_of.h"
#include "study/error_parts.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace patchlight {
namespace {

// Finer than the finest setting: half the edges, so four times the patches, and four times the samples.
constexpr double finer_edge = 0.5;
constexpr int finer_samples = 4;
// The solver's share in the error of a reference is so much smaller than that in the finest setting.
constexpr double finer_tolerance = 1e-2;
// Estimators are compared with an eighth of the patches; on so few pairs they differ as on many.
constexpr double estimator_edge = 2.83;
// The hemisphere's samples are rays of a patch, not of a pair.
constexpr int hemisphere_factor = 64;
// A size with nearly as many patches as the next finer one, as the faces take one each, tells nothing.
constexpr double too_many = 0.9;

// The scene, what is asked for, and who looks on.
struct Bench {
  const Scene& scene;
  Request request;  // with its longest edge
  Observer observer;

  Simulation run(const Request& asked) const { return simulate(scene, asked, observer); }
  Request with_edge(double max_edge) const;
  std::size_t patches(double max_edge) const;
};

Request Bench::with_edge(double max_edge) const {
  Request asked = request;
  asked.max_edge = max_edge;
  return asked;
}

std::size_t Bench::patches(double max_edge) const {
  return tessellate(scene, sides_for(scene, request), max_edge).size();
}

Bench bench_for(const Scene& scene, const Request& request, const Observer& observer) {
  Bench bench{scene, request, observer};
  bench.request.max_edge = make_plan(scene, request).max_edge;
  bench.request.patches.reset();
  return bench;
}

// Refuses before anything is solved what could not be judged: the reference is the largest run.
void require_memory_for_reference(const Bench& bench) {
  const double edge = *bench.request.max_edge;
  const KeptSides sides = sides_for(bench.scene, bench.request);
  const PatchMesh coarsest = tessellate(bench.scene, sides, bounds(bench.scene).diagonal().norm());
  const Eigen::VectorXd area = Eigen::Map<const Eigen::VectorXd>(coarsest.area.data(), coarsest.size());
  if (furnace_radiosity(problem_of(bench.scene, coarsest, area, sides.emit_from_back))) return;
  try {
    require_memory(bench.patches(finer_edge * edge), bench.request);
  } catch (const MemoryError& error) {
    throw MemoryError(std::string("the reference of a study has about four times the patches asked for: ") +
                      error.what());
  }
}

// The longest edges, from coarse to fine; the last one is that of the request.
std::vector<double> edges_for(const Bench& bench, int sizes) {
  std::vector<double> edges{*bench.request.max_edge};
  auto finer = static_cast<double>(bench.patches(edges.front()));
  for (int k = 1; k < sizes; ++k) {
    const double edge = *bench.request.max_edge * std::pow(2, 0.5 * k);
    const auto patches = static_cast<double>(bench.patches(edge));
    if (patches > too_many * finer) break;
    edges.insert(edges.begin(), edge);
    finer = patches;
  }
  return edges;
}

StudySetting setting_of(const Simulation& simulation) {
  const Plan& plan = simulation.plan;
  StudySetting setting;
  setting.patches = simulation.mesh.size();
  setting.estimator = plan.estimator;
  setting.samples = plan.samples;
  setting.tolerance = plan.solver.relative_error;
  setting.costs = simulation.costs;
  setting.matrix_bytes = static_cast<double>(ExchangeAreas::bytes(setting.patches));
  return setting;
}

StudySetting judged(const Simulation& simulation, const Reference& reference) {
  StudySetting setting = setting_of(simulation);
  const Discrepancy found = discrepancy(simulation, reference);
  setting.error = found.of_means;
  setting.display_error = found.of_display;
  setting.own_error = found.of_means;
  return setting;
}

// The same, with an error that is due to one quantity alone: against a solution on the same mesh.
StudySetting judged(const Simulation& simulation, const Reference& reference, const Field& own) {
  StudySetting setting = judged(simulation, reference);
  setting.own_error = relative_error(own, simulation.solution.radiosity, simulation.problem);
  return setting;
}

// The finest setting, solved to several tolerances on one matrix.
struct Tolerances {
  std::vector<Simulation> runs;  // from loose to tight; the last one is the finest setting
  Field exact;
};

// 0.1, 0.01, ... down to the one asked for.
std::vector<double> tolerances_for(double finest) {
  std::vector<double> tolerances;
  for (double tolerance = 0.1; tolerance > 2 * finest; tolerance *= 0.1) tolerances.push_back(tolerance);
  tolerances.push_back(finest);
  return tolerances;
}

Tolerances solve_to_tolerances(const Bench& bench) {
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
    for (const double tolerance : tolerances_for(usual.relative_error)) {
      options.relative_error = tolerance;
      const double wall = wall_seconds();
      const double cpu = cpu_seconds();
      Solution solution = solve(transport, problem, options, watch);
      runs.push_back({tolerance, std::move(solution), {Stage::solve, wall_seconds() - wall, cpu_seconds() - cpu}});
    }
    options.relative_error = std::max(1e-12, finer_tolerance * usual.relative_error);
    result.exact = solve(transport, problem, options, watch).radiosity;
    return runs.back().solution;
  };
  Simulation simulation = simulate(bench.scene, bench.request, bench.observer, {.solve = solve_all});
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

// What the study's settings are compared with, and what is told about it.
struct Judge {
  Reference reference;
  StudyReference facts;
};

Judge judge_for(const Bench& bench, const Simulation& finest) {
  Judge judge;
  judge.reference.uniform = furnace_radiosity(finest.problem);
  judge.facts.closed_form = judge.reference.uniform && finest.transport.lost.closed();
  if (judge.facts.closed_form) return judge;
  Request asked = bench.with_edge(finer_edge * *bench.request.max_edge);
  asked.samples *= finer_samples;
  asked.tolerance = std::max(1e-12, finer_tolerance * asked.tolerance);
  const Simulation finer = bench.run(asked);
  judge.reference = reference_from(finer);
  const StudySetting setting = setting_of(finer);
  judge.facts.patches = setting.patches;
  judge.facts.samples = setting.samples;
  judge.facts.cpu_seconds = cpu_seconds_of(setting);
  judge.facts.converged = finer.solution.converged;
  return judge;
}

// Sizes of patches with so many samples, up to the finest one, which is known already.
StudySweep sweep_sizes(const Bench& bench, const Reference& reference, const std::vector<double>& edges,
                       StudySetting finest) {
  StudySweep sweep{"patch size, " + std::to_string(finest.samples) + " samples", Swept::patch_size, {}};
  for (std::size_t k = 0; k + 1 < edges.size(); ++k) {
    Request asked = bench.with_edge(edges[k]);
    asked.samples = finest.samples;
    sweep.settings.push_back(judged(bench.run(asked), reference));
  }
  finest.own_error = finest.error;
  sweep.settings.push_back(std::move(finest));
  return sweep;
}

StudySweep sweep_tolerances(const Tolerances& tolerances, const Reference& reference) {
  StudySweep sweep{"tolerance", Swept::tolerance, {}};
  for (const Simulation& run : tolerances.runs) sweep.settings.push_back(judged(run, reference, tolerances.exact));
  return sweep;
}

// Half, once, twice and four times the samples asked for, against four times the largest of them.
StudySweep sweep_samples(const Bench& bench, const Reference& reference, const Simulation& finest) {
  const auto with_samples = [&](int samples) {
    Request asked = bench.request;
    asked.samples = samples;
    return asked;
  };
  const int usual = bench.request.samples;
  const Field own = bench.run(with_samples(4 * finer_samples * usual)).solution.radiosity;
  StudySweep sweep{"samples", Swept::samples, {}};
  for (const int samples : {std::max(1, usual / 2), usual, 2 * usual, 4 * usual}) {
    const Plan plan = make_plan(bench.scene, with_samples(samples));
    if (!sweep.settings.empty() && plan.samples == sweep.settings.back().samples) continue;
    const bool known = plan.samples == finest.plan.samples;
    sweep.settings.push_back(judged(known ? finest : bench.run(with_samples(samples)), reference, own));
  }
  return sweep;
}

std::vector<StudySweep> sweep_estimators(const Bench& bench, const Reference& reference) {
  Request asked = bench.with_edge(estimator_edge * *bench.request.max_edge);
  const int usual = asked.samples;
  asked.samples = 4 * 16 * usual;
  const Field own = bench.run(asked).solution.radiosity;
  std::vector<StudySweep> sweeps;
  for (const Estimator estimator :
       {Estimator::automatic, Estimator::area, Estimator::point_polygon, Estimator::hemisphere, Estimator::contour}) {
    StudySweep sweep{std::string("estimator ") + name_of(estimator), Swept::samples, {}, false};
    asked.estimator = estimator;
    for (const int factor : {1, 4, 16}) {
      asked.samples = factor * usual * (estimator == Estimator::hemisphere ? hemisphere_factor : 1);
      sweep.settings.push_back(judged(bench.run(asked), reference, own));
    }
    sweeps.push_back(std::move(sweep));
  }
  return sweeps;
}

// Those that compete. Sizes are swept with the usual samples, and with as many as the reference has: there the error of
// the mesh is seen to fall.
std::vector<StudySweep> sweep_each(const Bench& bench, const Reference& reference, const Tolerances& tolerances,
                                   int sizes) {
  const Simulation& finest = tolerances.runs.back();
  const std::vector<double> edges = edges_for(bench, sizes);
  StudySweep by_samples = sweep_samples(bench, reference, finest);
  StudySweep coarse = sweep_sizes(bench, reference, edges, judged(finest, reference));
  StudySweep fine = sweep_sizes(bench, reference, edges, by_samples.settings.back());
  return {std::move(coarse), std::move(fine), std::move(by_samples), sweep_tolerances(tolerances, reference)};
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

Study study(const Scene& scene, const Request& request, const StudyOptions& options, const Observer& observer) {
  const ThreadLimit threads(request.threads);
  // 1. The finest setting of the sweeps, and what it is judged by.
  const Bench bench = bench_for(scene, request, observer);
  require_memory_for_reference(bench);
  const Tolerances tolerances = solve_to_tolerances(bench);
  const Simulation& finest = tolerances.runs.back();
  Study result;
  result.plan = finest.plan;
  result.trapped = finest.solution.trapped;
  if (!result.trapped.empty()) return result;
  const Judge judge = judge_for(bench, finest);
  const Reference& reference = judge.reference;
  result.reference = judge.facts;

  // 2. One quantity at a time.
  result.sweeps = sweep_each(bench, reference, tolerances, options.sizes);
  if (options.estimators) {
    for (StudySweep& sweep : sweep_estimators(bench, reference)) result.sweeps.push_back(std::move(sweep));
  }

  // 3. Orders, the reference's own error, the Pareto front, and what limits the finest setting.
  const double patches = patches_of(judge.facts);
  for (StudySweep& sweep : result.sweeps) sweep = with_orders(std::move(sweep), patches);
  const StudySweep& by_size = result.sweeps[1];
  result.reference.bar = judge.facts.closed_form ? 0 : richardson_bar(by_size, patches);
  result.parts = error_parts(scene, finest, discrepancy(finest, reference), result.sweeps);
  return with_fronts(std::move(result));
}

}  // namespace patchlight
