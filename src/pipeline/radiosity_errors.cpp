#include "pipeline/radiosity_errors.h"

#include "patchlight/accuracy/error_bars.h"
#include "patchlight/transport/lost_share.h"

#include "accuracy/errors.h"
#include "accuracy/spaces.h"
#include "base/vectors.h"
#include "solve/scattering.h"

namespace patchlight {
namespace {

// Mesh error bars for sums over many patches. Each band is reduced by the noise in the squares, which cancels in their
// sum except for its standard error. mean_around() shares each patch's value with its neighbors. So the squares of its
// parts add up to 1/7.1 for quadrilaterals and 1/10.8 for triangles.
Field mesh_bars_of_many(const Simulation& simulation, const Eigen::VectorXd& weight) {
  const ErrorBars& bars = *simulation.error_bars;
  if (bars.mesh_noise.size() == 0) return bars.mesh;
  const Scattering& scattering = simulation.problem.scattering;
  const Eigen::VectorXd area = simulation.problem.area.cwiseProduct(weight);
  const Field squares = reflected_variance(scattering, bars.mesh.square());
  const Field known = squares - reflected_variance(scattering, bars.mesh_noise.square());
  const Eigen::ArrayXd all = area_sum(squares, area);
  const Eigen::ArrayXd standard_error = (11 * area_sum(known.square(), area.cwiseAbs2())).sqrt();
  const Eigen::ArrayXd part = area_sum(known, area).max(0.0) + standard_error;
  return scaled(bars.mesh, (part < all).select(part / all, 1.0).sqrt());
}

}  // namespace

AccuracyStep errors_of(const Simulation& simulation, const Eigen::VectorXd& weight) {
  ErrorBars bars = *simulation.error_bars;
  bars.mesh = mesh_bars_of_many(simulation, weight);
  const auto relative = [&](const Field& bar) {
    return relative_bar(bar, simulation.problem, simulation.solution, weight);
  };
  const auto patches = static_cast<PatchIndex>((weight.array() > 0).count());
  return {.patches = patches,
          .new_patches = patches,
          .samples = samples_of(simulation.plan.assembly),
          .mesh = relative(bars.mesh),
          .form_factor = relative(bars.form_factor),
          .solver = relative(bars.solver),
          .total = relative(bars.total()),
          .display = relative(bars.display)};
}

Eigen::VectorXd interest_in(const Scene& scene, const Simulation& simulation) {
  const std::vector<std::string>& names = simulation.plan.accuracy.interest;
  const Eigen::VectorXd& enclosed = simulation.enclosed;
  if (names.empty() && enclosed.size() > 0 && simulation.solution.radiosity.rows() == enclosed.size()) {
    const Field reflected = simulation.solution.radiosity - simulation.problem.exitance;
    if (!(reflected.colwise() * enclosed.array() > 0).any()) return Eigen::VectorXd::Ones(enclosed.size());
  }
  return interest_of(scene, simulation.plan.sides, simulation.mesh, names, enclosed);
}

std::vector<SpaceErrors> errors_by_space(const Scene& scene, const Simulation& simulation) {
  if (!simulation.error_bars) return {};
  const PatchMesh& mesh = simulation.mesh;
  const bool all = simulation.plan.accuracy.interest.empty();
  const Eigen::VectorXd interest = all ? Eigen::VectorXd::Ones(mesh.size()) : interest_in(scene, simulation);
  const Eigen::VectorXd inside =
      interest.cwiseProduct(inside_patches(scene, simulation.plan.sides, mesh, simulation.enclosed));
  const Eigen::VectorXd outside = interest - inside;
  if (total(inside) == 0 || total(outside) == 0) return {};
  return {{"inside", errors_of(simulation, inside)}, {"outside", errors_of(simulation, outside)}};
}

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
