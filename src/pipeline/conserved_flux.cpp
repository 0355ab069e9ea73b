#include "pipeline/conserved_flux.h"

#include "base/disjoint_sets.h"
#include "base/vectors.h"

#include <cstddef>
#include <map>
#include <utility>

namespace patchlight {
namespace {

// The response is multiplied by the missing flux, which is some thousandths of the light.
constexpr double error_of_response = 0.01;  // by its residual
constexpr int most_iterations = 100;        // between white faces that trap light the flux stays uncorrected

// A space that loses more of its light is open. Patches that reach into solids lose some tenths of a percent at their
// backs, and rooms with a window some percent.
constexpr double max_loss_of_closed = 0.02;

void join_patches(DisjointSets& components, const RayRows& rows) {
  for (PatchIndex i = 0; i + 1 < rows.first_hit.size(); ++i) {
    for (std::uint64_t k = rows.first_hit[i]; k < rows.first_hit[i + 1]; ++k) components.join(i, rows.hits[k]);
    for (std::uint64_t k = rows.first_entry[i]; k < rows.first_entry[i + 1]; ++k)
      if (rows.entries[k].form_factor > 0) components.join(i, rows.entries[k].patch);
  }
}

// Sums over the patches of each closed space: a row for each space, a column for each band.
Field sum_by_space(const ClosedSpaces& spaces, const Field& values, const Eigen::VectorXd& weight) {
  Field sums = Field::Zero(spaces.count, values.cols());
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    const std::uint32_t space = spaces.space_of[static_cast<std::size_t>(i)];
    if (space != ClosedSpaces::open) sums.row(space) += weight[i] * values.row(i);
  }
  return sums;
}

// Each patch gets the value of its space, times its own.
Field times_of_space(const ClosedSpaces& spaces, Field values, const Field& of_spaces) {
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    const std::uint32_t space = spaces.space_of[static_cast<std::size_t>(i)];
    if (space == ClosedSpaces::open)
      values.row(i) = 0;
    else
      values.row(i) *= of_spaces.row(space);
  }
  return values;
}

// sum_j A_j s_j B_j - sum_i A_i (F B)_i, W per space and band.
Field missing(const ConservedFlux& flux, const Field& gathered, const Field& radiosity, const Eigen::VectorXd& area) {
  return sum_by_space(flux.spaces, radiosity, flux.seen_area) - sum_by_space(flux.spaces, gathered, area);
}

std::array<Field, 2> gathered_by_halves(const RaysWithPockets& transport, const Field& radiosity) {
  return {transport.rays().apply_half(0, radiosity), transport.rays().apply_half(1, radiosity)};
}

Field mean_of(const std::array<Field, 2>& halves) { return 0.5 * (halves[0] + halves[1]); }

}  // namespace

ClosedSpaces find_closed_spaces(const RayTransport& rays, const RadiosityProblem& problem,
                                const Eigen::VectorXd& row_sum) {
  const Eigen::VectorXd& area = problem.area;
  // 1. Connected components.
  const PatchIndex size = rays.size();
  DisjointSets components(size);
  for (const std::size_t half : {0U, 1U}) join_patches(components, rays.rows(half));
  const Scattering& scattering = problem.scattering;
  if (!scattering.is_diagonal())
    for (PatchIndex i = 0; i < size; ++i) components.join(i, scattering.other_side[i]);

  // 2. The area and the loss of each, by its root.
  Eigen::VectorXd all = Eigen::VectorXd::Zero(size);
  Eigen::VectorXd lost = Eigen::VectorXd::Zero(size);
  for (PatchIndex i = 0; i < size; ++i) {
    all[components.root(i)] += area[i];
    lost[components.root(i)] += area[i] * (1 - row_sum[i]);
  }

  // 3. Number those that are closed.
  ClosedSpaces found;
  std::map<PatchIndex, std::uint32_t> number;
  for (PatchIndex i = 0; i < size; ++i) {
    const PatchIndex root = components.root(i);
    const bool is_closed = all[root] > 0 && lost[root] <= max_loss_of_closed * all[root];
    found.space_of.push_back(is_closed
                                 ? number.try_emplace(root, static_cast<std::uint32_t>(number.size())).first->second
                                 : ClosedSpaces::open);
  }
  found.count = static_cast<Eigen::Index>(number.size());
  return found;
}

Field ConservedFlux::completed(Field gathered, const Field& radiosity, const Eigen::VectorXd& area) const {
  if (spaces.count == 0) return gathered;
  const Field watts = missing(*this, gathered, radiosity, area);
  gathered += times_of_space(spaces, shape, watts);
  return gathered;
}

ConservingSolution conserving_flux(const RaysWithPockets& transport, const RadiosityProblem& problem, Solution solution,
                                   const Eigen::VectorXd& row_sum, const Observer& observer) {
  // 1. The missing flux of each closed space, and its distribution.
  const Eigen::VectorXd& area = problem.area;
  std::array<Field, 2> halves = gathered_by_halves(transport, solution.radiosity);
  const Field gathered = mean_of(halves);
  ConservedFlux flux{find_closed_spaces(transport.rays(), problem, row_sum), area.cwiseProduct(row_sum), {}};
  const auto unchanged = [&] {
    flux.shape = Field::Zero(gathered.rows(), gathered.cols());
    return ConservingSolution{std::move(solution), std::move(flux), std::move(halves)};
  };
  if (flux.spaces.count == 0 || !solution.converged) return unchanged();
  const Field arriving = sum_by_space(flux.spaces, gathered, area);
  flux.shape = times_of_space(flux.spaces, gathered, (arriving > 0).select(arriving.inverse(), 0.0));
  const Field lacking = missing(flux, gathered, solution.radiosity, area);

  // 2. The response to a watt in each space, B' = R shape + R F B', which lacks some flux again. Closed spaces exchange
  //    no light, so that one solution has the responses of all.
  const RadiosityProblem of_a_watt{problem.scattering, problem.scattering.reflect(flux.shape), area};
  const SolverOptions loosely{.solver = Solver::gmres,
                              .relative_error = error_of_response,
                              .max_iterations = most_iterations,
                              .largest_row_sum = std::numeric_limits<double>::infinity(),
                              .patch_bounds = false};
  const Solution response = solve(transport, of_a_watt, loosely, observer);
  const std::array<Field, 2> by_a_watt = gathered_by_halves(transport, response.radiosity);
  const Field lacking_again = missing(flux, mean_of(by_a_watt), response.radiosity, area);
  constexpr double most_again = 0.5;
  if (!response.converged || (lacking_again > most_again).any()) return unchanged();

  // 3. The corrected solution.
  const Field watts = lacking / (1 - lacking_again);
  const Field added = times_of_space(flux.spaces, response.radiosity, watts);
  solution.radiosity += added;
  for (std::size_t half = 0; half < 2; ++half) halves[half] += times_of_space(flux.spaces, by_a_watt[half], watts);
  if (solution.error.size() > 0) solution.error += error_of_response * added.abs();
  return {std::move(solution), std::move(flux), std::move(halves)};
}

}  // namespace patchlight
