#include "solve/stopping.h"

#include "patchlight/base/error.h"
#include "patchlight/base/parallel.h"

#include <algorithm>
#include <limits>

namespace patchlight {
namespace {

// Row sums are known to about 1e-9: with ||K||_A above this nothing is known about the error.
constexpr double largest_contraction = 1 - 1e-8;

}  // namespace

Stopping::Stopping(const TransportOperator& transport, const RadiosityProblem& problem, const SolverOptions& options)
    : problem_(problem), options_(options), start_(wall_seconds()) {
  // ||K||_A <= rho_max max_i sum_j F_ij, as A^(1/2) F A^(-1/2) is symmetric and similar to F. docs/theory.md section 7.
  const double row_sum = transport.apply(Field::Ones(transport.size(), 1)).maxCoeff();
  contraction_ = problem.reflectance.colwise().maxCoeff().transpose() * row_sum;
}

Iteration Stopping::measure(const Solution& iterate, const FieldView& residual, double work, const Observer& observer) {
  const Eigen::ArrayXd norm = area_norm(residual, problem_.area);
  const Eigen::ArrayXd reflected_norm = area_norm(iterate.radiosity - problem_.exitance, problem_.area);
  if (number_ == 0) first_residual_ = norm;

  Iteration iteration{number_++, 0, 0, wall_seconds() - start_, work};
  for (Eigen::Index band = 0; band < norm.size(); ++band) {
    if (norm[band] == 0) continue;
    // ||B* - B||_A <= ||r||_A / (1 - ||K||_A)
    const double bound = contraction_[band] < largest_contraction ? norm[band] / (1 - contraction_[band])
                                                                  : std::numeric_limits<double>::infinity();
    iteration.relative_residual = std::max(iteration.relative_residual, norm[band] / first_residual_[band]);
    iteration.error_bound = std::max(iteration.error_bound, bound / reflected_norm[band]);
  }
  if (observer) {
    // Residuals fall by a constant factor: their logarithm tells the share of the work that is done.
    const double wanted = std::log(options_.relative_error);
    const double measured = std::log(std::clamp(iteration.relative_residual, options_.relative_error, 1.0));
    const Progress progress{Stage::solve, measured / wanted, &iteration, &iterate.irradiance};
    if (!observer(progress)) throw Cancelled();
  }
  return iteration;
}

bool Stopping::reached(const Iteration& iteration) const {
  if ((contraction_ >= largest_contraction).any()) return iteration.relative_residual <= options_.relative_error;
  return iteration.error_bound <= options_.relative_error;
}

}  // namespace patchlight
