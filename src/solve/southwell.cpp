#include "patchlight/solve/southwell.h"

#include "solve/stopping.h"

#include <algorithm>

namespace patchlight {
namespace {

// Flux that still waits to be shot, summed over the bands, decides who shoots next.
Eigen::Index brightest(const Field& unshot, const Eigen::VectorXd& area) {
  Eigen::Index patch = 0;
  (unshot.rowwise().sum() * area.array()).maxCoeff(&patch);
  return patch;
}

// Irradiance that the unshot radiosity would add everywhere if it and all its reflections spread evenly:
// sum_i A_i dB_i / sum_i A_i / (1 - mean rho). Cohen et al. 1988, section 3.2.
Field ambient_irradiance(const Field& unshot, const RadiosityProblem& problem) {
  const double total = problem.area.sum();
  const Field mean_unshot = (unshot.colwise() * problem.area.array()).colwise().sum() / total;
  const Field mean_reflectance = (problem.reflectance.colwise() * problem.area.array()).colwise().sum() / total;
  return (mean_reflectance < 1).select(mean_unshot / (1 - mean_reflectance), 0.0);
}

}  // namespace

Solution progressive_refinement(const RowTransport& transport, const RadiosityProblem& problem,
                                const SolverOptions& options, const Observer& observer) {
  Stopping stopping(transport, problem, options);
  const Eigen::Index n = problem.exitance.rows();
  Field unshot = problem.exitance;
  Solution solution{.radiosity = problem.exitance,
                    .irradiance = Field::Zero(n, unshot.cols()),
                    .direct_irradiance = transport.apply(problem.exitance),
                    .ambient = {},
                    .history = {}};

  // With X = B - unshot, the radiosity shot so far, B = E + K X: the residual of X is what is unshot. Iteration 0 is X
  // = E.
  solution.history.push_back(stopping.measure(solution, problem.reflectance * solution.direct_irradiance, 2, observer));
  solution.converged = stopping.reached(solution.history.back());
  for (int k = 1; k <= options.max_iterations && !solution.converged; ++k) {
    for (Eigen::Index shot = 0; shot < n; ++shot) {
      const Eigen::Index source = brightest(unshot, problem.area);
      const Field flash = unshot.row(source);
      if (!(flash > 0).any()) break;
      const auto index = static_cast<PatchIndex>(source);
      const Field H = transport.shoot({index, index + 1}, flash);
      unshot.row(source) = 0;
      unshot += problem.reflectance * H;
      solution.irradiance += H;
    }
    solution.radiosity = problem.exitance + problem.reflectance * solution.irradiance;
    solution.history.push_back(stopping.measure(solution, unshot, 2.0 + k, observer));
    solution.converged = stopping.reached(solution.history.back());
  }
  if (solution.history.size() == 1) solution.irradiance = solution.direct_irradiance;
  solution.radiosity = problem.exitance + problem.reflectance * solution.irradiance;
  solution.ambient = ambient_irradiance(unshot, problem);
  return solution;
}

}  // namespace patchlight
