#include "pipeline/conserved_flux.h"

#include "base/vectors.h"

#include <limits>
#include <utility>

namespace patchlight {
namespace {

// The second solution is multiplied by what is missing, some thousandths of the light.
constexpr double error_of_response = 0.01;  // as its residual tells
constexpr int most_iterations = 100;        // where light is caught between white faces, its flux is left as it is

// sum_j A_j s_j B_j - sum_i A_i (F B)_i, W per band.
Eigen::ArrayXd missing(const ConservedFlux& flux, const Field& gathered, const Field& radiosity,
                       const Eigen::VectorXd& area) {
  return area_sum(radiosity, flux.seen_area) - area_sum(gathered, area);
}

std::array<Field, 2> gathered_by_halves(const RaysWithPockets& transport, const Field& radiosity) {
  return {transport.rays().apply_half(0, radiosity), transport.rays().apply_half(1, radiosity)};
}

Field mean_of(const std::array<Field, 2>& halves) { return 0.5 * (halves[0] + halves[1]); }

}  // namespace

Field ConservedFlux::completed(Field gathered, const Field& radiosity, const Eigen::VectorXd& area) const {
  gathered += scaled(shape, missing(*this, gathered, radiosity, area));
  return gathered;
}

ConservingSolution conserving_flux(const RaysWithPockets& transport, const RadiosityProblem& problem, Solution solution,
                                   const Eigen::VectorXd& row_sum, const Observer& observer) {
  // 1. What is missing, and where it goes.
  const Eigen::VectorXd& area = problem.area;
  std::array<Field, 2> halves = gathered_by_halves(transport, solution.radiosity);
  const Field gathered = mean_of(halves);
  const Eigen::ArrayXd arriving = area_sum(gathered, area);
  ConservedFlux flux{area.cwiseProduct(row_sum),
                     scaled(gathered, quotient(Eigen::ArrayXd::Ones(arriving.size()), arriving))};
  const Eigen::ArrayXd lacking = missing(flux, gathered, solution.radiosity, area);

  const auto as_it_was = [&] {
    flux.shape.setZero();
    return ConservingSolution{std::move(solution), std::move(flux), std::move(halves)};
  };
  if (!solution.converged) return as_it_was();

  // 2. What a watt of it changes: B' = R shape + R F B', of which some is missing again.
  const RadiosityProblem of_a_watt{problem.scattering, problem.scattering.reflect(flux.shape), area};
  const SolverOptions loosely{.solver = Solver::gmres,
                              .relative_error = error_of_response,
                              .max_iterations = most_iterations,
                              .largest_row_sum = std::numeric_limits<double>::infinity(),
                              .patch_bounds = false};
  const Solution response = solve(transport, of_a_watt, loosely, observer);
  const std::array<Field, 2> by_a_watt = gathered_by_halves(transport, response.radiosity);
  const Eigen::ArrayXd lacking_again = missing(flux, mean_of(by_a_watt), response.radiosity, area);
  constexpr double most_again = 0.5;
  if (!response.converged || (lacking_again > most_again).any()) return as_it_was();

  // 3. All of it together.
  const Eigen::ArrayXd watts = lacking / (1 - lacking_again);
  const Field added = scaled(response.radiosity, watts);
  solution.radiosity += added;
  for (std::size_t half = 0; half < 2; ++half) halves[half] += scaled(by_a_watt[half], watts);
  if (solution.error.size() > 0) solution.error += error_of_response * added.abs();
  return {std::move(solution), std::move(flux), std::move(halves)};
}

}  // namespace patchlight
