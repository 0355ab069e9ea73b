#include "patchlight/solve/relaxation.h"

#include "solve/stopping.h"

#include <algorithm>

namespace patchlight {
namespace {

// Patches relaxed between two gathers: with newer values inside a slab, too, this is Gauss-Seidel patch by patch.
constexpr PatchIndex slab = 64;

// One Gauss-Seidel sweep: B_i <- E_i + rho_i sum_j F_ij B_j with the newest B_j.
Field swept(const RowTransport& transport, const RadiosityProblem& problem, Field B) {
  for (PatchIndex begin = 0; begin < transport.size(); begin += slab) {
    const PatchRange range{begin, std::min(transport.size(), begin + slab)};
    const Field H = transport.gather(range, B);
    const Eigen::MatrixXd F = transport.form_factors(range, range);
    Field change = Field::Zero(H.rows(), B.cols());
    for (Eigen::Index r = 0; r < H.rows(); ++r) {
      const Eigen::Index i = begin + r;
      // The gather used the old values of this slab: add what its earlier patches have changed since.
      const auto newer = (F.row(r).head(r) * change.matrix().topRows(r)).array();
      const Field B_new = problem.exitance.row(i) + problem.reflectance.row(i) * (H.row(r) + newer);
      change.row(r) = B_new - B.row(i);
      B.row(i) = B_new;
    }
  }
  return B;
}

}  // namespace

Solution jacobi(const TransportOperator& transport, const RadiosityProblem& problem, const SolverOptions& options,
                const Observer& observer) {
  Stopping stopping(transport, problem, options);
  Solution solution{problem.exitance, {}, {}, {}, false};
  for (int k = 0; k <= options.max_iterations && !solution.converged; ++k) {
    // H = F B;  r = E + rho o H - B;  B <- B + r
    solution.irradiance = transport.apply(solution.radiosity);
    const Field next = problem.exitance + problem.reflectance * solution.irradiance;
    solution.history.push_back(
        stopping.measure(next - solution.radiosity, solution.radiosity - problem.exitance, 2.0 + k, observer));
    solution.converged = stopping.reached(solution.history.back());
    solution.radiosity = next;
  }
  return solution;
}

Solution gauss_seidel(const RowTransport& transport, const RadiosityProblem& problem, const SolverOptions& options,
                      const Observer& observer) {
  Stopping stopping(transport, problem, options);
  Solution solution{problem.exitance, {}, {}, {}, false};
  for (int k = 0; k <= options.max_iterations && !solution.converged; ++k) {
    if (k > 0) solution.radiosity = swept(transport, problem, std::move(solution.radiosity));
    // The true residual, from one more application; its Jacobi step is kept.
    solution.irradiance = transport.apply(solution.radiosity);
    const Field next = problem.exitance + problem.reflectance * solution.irradiance;
    solution.history.push_back(
        stopping.measure(next - solution.radiosity, solution.radiosity - problem.exitance, 2.0 + 2 * k, observer));
    solution.converged = stopping.reached(solution.history.back());
    solution.radiosity = next;
  }
  return solution;
}

}  // namespace patchlight
