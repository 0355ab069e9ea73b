#include "annual/adjoint_light.h"

#include "solve/scattering.h"

#include <limits>

namespace patchlight {
AdjointLight::AdjointLight(const SolvedTransport& solved) : solved_(solved), adjoint_(solved.light) {
  if (adjoint_ != nullptr && !adjoint_->is_reciprocal()) adjoint_ = adjoint_->adjoint(solved.area);
}

AdjointWeights AdjointLight::weights(const Field& seen, const std::vector<Eigen::Index>& bands,
                                     double tolerance) const {
  if (adjoint_ == nullptr) return {Field::Zero(seen.rows(), seen.cols())};
  const Eigen::ArrayXd area = solved_.area.array();
  const Scattering scattering = of_bands(solved_.scattering, bands);
  const Eigen::ArrayXd per_area = (area > 0).select(area.inverse(), 0.0);
  const RadiosityProblem problem{scattering, scattering.adjoint(seen.colwise() * per_area), solved_.area};
  const SolverOptions options{.solver = usual_solver(*adjoint_, problem),
                              .relative_error = tolerance,
                              .max_iterations = 200,
                              .restart = 12,
                              .largest_row_sum = std::numeric_limits<double>::infinity(),
                              .patch_bounds = false};
  const Solution found = solve(*adjoint_, problem, options);
  return {found.radiosity.colwise() * area, found.converged};
}

}  // namespace patchlight
