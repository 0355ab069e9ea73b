#include "pipeline/radiosity_errors.h"

#include "patchlight/transport/lost_share.h"

namespace patchlight {

RadiosityErrors radiosity_errors(const Simulation& simulation) {
  if (!simulates(simulation.plan, Effect::interreflection)) return {};
  const RadiosityProblem& problem = simulation.problem;
  const Solution& solution = simulation.solution;
  RadiosityErrors errors;
  errors.reflected = solution.radiosity - problem.exitance;
  errors.solver = solution.error;
  if (simulation.error_bars) {
    // The error of each patch alone is the rest of its variance.
    Field single = simulation.error_bars->form_factor.square();
    const auto draws = static_cast<double>(simulation.correlated_errors.size());
    for (const Field& draw : simulation.correlated_errors) {
      single -= draw.square() / draws;
      errors.correlated.push_back(problem.scattering.reflect(draw));
    }
    errors.sampling = problem.scattering.reflect(single.max(0.0).sqrt());
    errors.mesh = problem.scattering.reflect(simulation.error_bars->mesh);
    errors.display = problem.scattering.reflect(simulation.error_bars->display);
    return errors;
  }
  Field squares = Field::Zero(problem.exitance.rows(), problem.exitance.cols());
  if (simulation.direct_standard_error.size() > 0) squares += simulation.direct_standard_error.square();
  if (simulation.transport.raw_row_sum.size() > 0) {
    const Eigen::ArrayXd expected = expected_row_sum(simulation.transport.lost).array();
    const Eigen::ArrayXd defect = simulation.transport.raw_row_sum.array() - expected;
    const Eigen::ArrayXd relative = (expected > 0).select(defect / expected, 0.0);
    squares += (solution.irradiance.colwise() * relative).square();
  }
  errors.sampling = problem.scattering.reflect(squares.sqrt());
  return errors;
}

}  // namespace patchlight
