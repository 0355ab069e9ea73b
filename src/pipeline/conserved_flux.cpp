#include "pipeline/conserved_flux.h"

#include "base/vectors.h"

#include <utility>

namespace patchlight {
namespace {

// The second solution is multiplied by what is missing, some thousandths of the light.
constexpr double error_of_response = 0.01;

// sum_j A_j s_j B_j - sum_i A_i (F B)_i, W per band.
Eigen::ArrayXd missing(const ConservedFlux& flux, const Field& gathered, const Field& radiosity,
                       const Eigen::VectorXd& area) {
  return area_sum(radiosity, flux.seen_area) - area_sum(gathered, area);
}

}  // namespace

Field ConservedFlux::completed(Field gathered, const Field& radiosity, const Eigen::VectorXd& area) const {
  gathered += scaled(shape, missing(*this, gathered, radiosity, area));
  return gathered;
}

ConservingSolution conserving_flux(const TransportOperator& transport, const RadiosityProblem& problem,
                                   Solution solution, const Eigen::VectorXd& row_sum, const Observer& observer) {
  // 1. What is missing, and where it goes.
  const Eigen::VectorXd& area = problem.area;
  const Field gathered = transport.apply(solution.radiosity);
  const Eigen::ArrayXd arriving = area_sum(gathered, area);
  ConservedFlux flux{area.cwiseProduct(row_sum),
                     scaled(gathered, quotient(Eigen::ArrayXd::Ones(arriving.size()), arriving))};
  const Eigen::ArrayXd lacking = missing(flux, gathered, solution.radiosity, area);

  // 2. What a watt of it changes: B' = R shape + R F B', of which some is missing again.
  const RadiosityProblem of_a_watt{problem.scattering, problem.scattering.reflect(flux.shape), area};
  const Solution response =
      solve(transport, of_a_watt, {.solver = Solver::gmres, .relative_error = error_of_response, .patch_bounds = false},
            observer);
  const Eigen::ArrayXd lacking_again = missing(flux, transport.apply(response.radiosity), response.radiosity, area);

  constexpr double most_again = 0.5;
  if (!solution.converged || !response.converged || (lacking_again > most_again).any()) {
    flux.shape.setZero();
    return {std::move(solution), std::move(flux)};
  }

  // 3. All of it together.
  const Field added = scaled(response.radiosity, lacking / (1 - lacking_again));
  solution.radiosity += added;
  if (solution.error.size() > 0) solution.error += error_of_response * added.abs();
  return {std::move(solution), std::move(flux)};
}

}  // namespace patchlight
