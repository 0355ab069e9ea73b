#include "patchlight/solve/relaxation.h"

#include "solve/stopping.h"

#include <algorithm>
#include <utility>

namespace patchlight {
namespace {

// Patches relaxed between two gathers: with newer values inside a slab, too, this is Gauss-Seidel patch by patch.
constexpr PatchIndex slab = 64;

// Iteration 0: the light of the lamps has arrived nowhere yet.
Solution lamps_alone(const RadiosityProblem& problem) {
  const Field dark = Field::Zero(problem.exitance.rows(), problem.exitance.cols());
  return {.radiosity = problem.exitance, .irradiance = dark, .direct_irradiance = {}, .ambient = {}, .history = {}};
}

// One Gauss-Seidel sweep: H_i <- sum_j F_ij B_j with the newest B_j, B_i <- E_i + rho_i H_i.
Solution swept(const RowTransport& transport, const RadiosityProblem& problem, Solution solution) {
  Field& B = solution.radiosity;
  for (PatchIndex begin = 0; begin < transport.size(); begin += slab) {
    const PatchRange range{begin, std::min(transport.size(), begin + slab)};
    Field H = transport.gather(range, B);
    const Eigen::MatrixXd F = transport.form_factors(range, range);
    Field change = Field::Zero(H.rows(), B.cols());
    for (Eigen::Index r = 0; r < H.rows(); ++r) {
      const Eigen::Index i = begin + r;
      // The gather used the old values of this slab: add what its earlier patches have changed since.
      H.row(r) += (F.row(r).head(r) * change.matrix().topRows(r)).array();
      const Field B_new = problem.exitance.row(i) + problem.reflectance.row(i) * H.row(r);
      change.row(r) = B_new - B.row(i);
      B.row(i) = B_new;
    }
    solution.irradiance.middleRows(begin, H.rows()) = H;
  }
  return solution;
}

}  // namespace

Solution jacobi(const TransportOperator& transport, const RadiosityProblem& problem, const SolverOptions& options,
                const Observer& observer) {
  Stopping stopping(transport, problem, options);
  Solution solution = lamps_alone(problem);
  for (int k = 0; k <= options.max_iterations && !solution.converged; ++k) {
    // H = F B;  r = E + rho o H - B;  B <- B + r
    Field H = transport.apply(solution.radiosity);
    if (k == 0) solution.direct_irradiance = H;
    Field next = problem.exitance + problem.reflectance * H;
    solution.history.push_back(stopping.measure(solution, next - solution.radiosity, 2.0 + k, observer));
    solution.converged = stopping.reached(solution.history.back());
    solution.irradiance = std::move(H);
    solution.radiosity = std::move(next);
  }
  return solution;
}

Solution gauss_seidel(const RowTransport& transport, const RadiosityProblem& problem, const SolverOptions& options,
                      const Observer& observer) {
  Stopping stopping(transport, problem, options);
  Solution solution = lamps_alone(problem);
  for (int k = 0; k <= options.max_iterations && !solution.converged; ++k) {
    if (k > 0) solution = swept(transport, problem, std::move(solution));
    // The true residual, from one more application; its Jacobi step is kept.
    Field H = transport.apply(solution.radiosity);
    if (k == 0) solution.direct_irradiance = H;
    Field next = problem.exitance + problem.reflectance * H;
    solution.history.push_back(stopping.measure(solution, next - solution.radiosity, 2.0 + 2 * k, observer));
    solution.converged = stopping.reached(solution.history.back());
    solution.irradiance = std::move(H);
    solution.radiosity = std::move(next);
  }
  return solution;
}

}  // namespace patchlight
