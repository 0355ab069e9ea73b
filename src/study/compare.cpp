#include "study/compare.h"

#include "patchlight/base/error.h"

#include "base/parallel.h"
#include "base/vectors.h"
#include "plan/check_request.h"
#include "solve/bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace patchlight {
namespace {

// Keeps the first ten iterates, then those whose number is a fifth higher, and the last.
class Frames {
 public:
  void keep(const Progress& progress) {
    last_ = {*progress.iteration, progress.irradiance().cast<float>()};
    if (frames_.size() >= 10 && last_.iteration.number < next_) return;
    frames_.push_back(last_);
    next_ = std::max(last_.iteration.number + 1, static_cast<int>(1.2 * last_.iteration.number));
  }
  std::vector<Frame> take() {
    if (!frames_.empty() && frames_.back().iteration.number < last_.iteration.number) frames_.push_back(last_);
    return std::move(frames_);
  }

 private:
  std::vector<Frame> frames_;
  Frame last_;
  int next_ = 0;
};

// (e_last / e_middle)^(1 / iterations in between), over the last third of the fall of the error in powers of ten.
double late_rate(const SolverRun& run, PatchIndex patches) {
  const std::vector<Iteration>& history = run.solution.history;
  const Iteration& last = history.back();
  const double middle = std::pow(last.true_error, 2.0 / 3);  // iteration 0 has the error 1
  const auto begin = std::find_if(history.begin(), history.end(),
                                  [&](const Iteration& iteration) { return iteration.true_error <= middle; });
  const int unit = is_shooting(run.contestant.solver) ? static_cast<int>(patches) : 1;
  if (begin == history.end() || last.number - begin->number < 3 * unit || !(last.true_error > 0)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const double iterations = static_cast<double>(last.number - begin->number) / unit;
  return std::pow(last.true_error / begin->true_error, 1 / iterations);
}

// One solver against the reference.
struct ConvergenceTest {
  const CompareOptions& options;
  const Field& reference;

  SolverRun run(const Contestant& contestant, const RowTransport& transport, const RadiosityProblem& problem,
                const SolverOptions& usual, const Observer& observer) const;
};

SolverRun ConvergenceTest::run(const Contestant& contestant, const RowTransport& transport,
                               const RadiosityProblem& problem, const SolverOptions& usual,
                               const Observer& observer) const {
  SolverOptions of_run = usual;
  of_run.solver = contestant.solver;
  of_run.relative_error = options.relative_error;
  of_run.max_iterations = keeps_entries(contestant.storage) ? options.max_iterations : 1;
  of_run.relaxation = options.relaxation;
  of_run.reference = reference;

  SolverRun result;
  result.contestant = contestant;
  Frames frames;
  const Observer watch = [&](const Progress& progress) {
    if (options.keep_iterates && progress.irradiance) frames.keep(progress);
    return !observer || observer(progress);
  };
  const double begin = wall_seconds();
  const double cpu_begin = cpu_seconds();
  result.solution = solve(transport, problem, of_run, watch);
  result.seconds = wall_seconds() - begin;
  result.cpu_seconds = cpu_seconds() - cpu_begin;
  result.rate = late_rate(result, transport.size());
  result.frames = frames.take();
  return result;
}

double assembly_seconds(const Simulation& simulation) {
  double seconds = 0;
  for (const StageCost& cost : simulation.costs) {
    if (cost.stage == Stage::form_factors || cost.stage == Stage::closure) seconds += cost.seconds;
  }
  return seconds;
}

SolverRun run_on_demand(const Scene& scene, const Request& request, const Contestant& contestant,
                        const ConvergenceTest& test, const Observer& observer) {
  Request asked = request;
  asked.assembly.storage = contestant.storage;
  asked.assembly.close = true;  // where it can be
  std::erase(asked.effects.force, Effect::closure);
  asked.solver.solver = contestant.solver;
  SolverRun run;
  const SolveWith solve_it = [&](const RowTransport& transport, const RadiosityProblem& problem,
                                 const SolverOptions& usual, const Observer& watch) {
    run = test.run(contestant, transport, problem, usual, watch);
    return run.solution;
  };
  run.assembly_seconds = assembly_seconds(simulate(scene, asked, observer, {.solve = solve_it}));
  return run;
}

}  // namespace

std::string name_of(const Contestant& contestant) {
  return std::string(name_of(contestant.solver)) + (keeps_entries(contestant.storage) ? "" : "-on-demand");
}

std::vector<Contestant> all_contestants() {
  std::vector<Contestant> all;
  for (const Solver solver : all_solvers()) all.push_back({solver});
  all.push_back({Solver::progressive, Storage::on_demand});
  return all;
}

void check(const Request& request, const CompareOptions& options) {
  check(request);
  const std::vector<Contestant>& all = options.contestants;
  const auto is_sor = [](const Contestant& contestant) { return contestant.solver == Solver::sor; };
  if (options.relaxation && std::none_of(all.begin(), all.end(), is_sor))
    throw InputError("compare.relaxation", "found without sor among compare.contestants; it needs sor");
  const auto on_demand = [](const Contestant& contestant) { return !keeps_entries(contestant.storage); };
  const auto rows = std::find_if(all.begin(), all.end(), on_demand);
  if (rows == all.end() || request.assembly.estimator == Estimator::automatic) return;
  throw InputError(std::string("assembly.estimator=") + name_of(request.assembly.estimator),
                   "found with " + name_of(*rows) +
                       " among compare.contestants; rows on demand are found by the automatic one only. Leave one of "
                       "them out");
}

Comparison compare(const Scene& scene, const Request& request, const CompareOptions& options,
                   const Observer& observer) {
  const ThreadLimit threads(request.resources.threads);
  check(request, options);
  Request with_matrix = request;  // even where no light is reflected
  with_matrix.effects.force.push_back(Effect::interreflection);
  Comparison comparison;
  // 1. Assemble once; while the matrix is there, find the reference and let the solvers run that use it.
  const SolveWith solve_all = [&](const RowTransport& transport, const RadiosityProblem& problem,
                                  const SolverOptions& usual, const Observer& watch) {
    SolverOptions exact = usual;
    exact.solver = usual_solver(transport, problem);
    exact.relative_error = std::max(1e-13, 1e-4 * options.relative_error);
    Solution reference = solve(transport, problem, exact, watch);
    comparison.reference_residual = reference.history.back().relative_residual;
    if (!reference.trapped.empty()) return reference;
    const Eigen::ArrayXd strongest_source = source_radiosity(problem).colwise().maxCoeff();
    const SpectralRadius radius = spectral_radius_with_error(transport, problem, 60);
    comparison.spectral_radius = largest((strongest_source > 0).select(radius.value, 0.0));
    comparison.spectral_radius_error = largest((strongest_source > 0).select(radius.error, 0.0));
    const ConvergenceTest test{options, reference.radiosity};
    for (const Contestant& contestant : options.contestants) {
      if (keeps_entries(contestant.storage))
        comparison.runs.push_back(test.run(contestant, transport, problem, usual, watch));
    }
    return reference;
  };
  comparison.simulation = simulate(scene, with_matrix, observer, {.solve = solve_all});
  const double assembly = assembly_seconds(comparison.simulation);
  for (SolverRun& run : comparison.runs) run.assembly_seconds = assembly;
  if (!comparison.simulation.solution.trapped.empty()) return comparison;

  // 2. Those that compute their rows.
  const ConvergenceTest test{options, comparison.simulation.solution.radiosity};
  for (const Contestant& contestant : options.contestants) {
    if (!keeps_entries(contestant.storage)) {
      comparison.runs.push_back(run_on_demand(scene, with_matrix, contestant, test, observer));
    }
  }
  return comparison;
}

}  // namespace patchlight
