#include "study/reference.h"

#include "base/vectors.h"
#include "mesh/interpolate.h"
#include "solve/scattering.h"

#include <algorithm>
#include <cmath>

namespace patchlight {
namespace {

// What the reference holds within each patch of a mesh.
struct Means {
  Field radiosity;
  Field spread;  // variance about it
};

Means means_over(const Simulation& simulation, const Reference& reference) {
  const Field& own = simulation.solution.radiosity;
  if (reference.uniform) {
    return {reference.uniform->replicate(own.rows(), 1), Field::Zero(own.rows(), own.cols())};
  }
  // Over the exposed part of the patch: each patch of the reference counts by its own.
  const Eigen::Map<const Eigen::ArrayXd> area(reference.mesh.area.data(), reference.mesh.size());
  const Field share = reference.problem.area.array() / area;
  const Field seen = average_over(simulation.mesh, reference.mesh, share);
  const auto mean = [&](const Field& values) -> Field {
    const Field sum = average_over(simulation.mesh, reference.mesh, values.colwise() * share.col(0));
    return sum.colwise() / seen.col(0);
  };
  const Field radiosity = mean(reference.radiosity);
  const Field squares = mean(reference.radiosity.square());
  return {radiosity, (squares - radiosity.square()).max(0)};
}

}  // namespace

Reference reference_from(const Simulation& finer) {
  return {std::nullopt, finer.mesh, finer.problem, finer.solution.radiosity};
}

std::optional<Spectrum> furnace_radiosity(const RadiosityProblem& problem) {
  constexpr double tolerance = 1e-9;
  const Field absorbed = absorb(problem.scattering, Field::Ones(problem.exitance.rows(), problem.exitance.cols()));
  const Eigen::ArrayXd absorbed_sum = sum_over_patches(absorbed);
  const Eigen::ArrayXd exitance_sum = sum_over_patches(problem.exitance);
  Spectrum c = Spectrum::Zero(absorbed.cols());
  for (Eigen::Index band = 0; band < c.size(); ++band) {
    if (absorbed_sum[band] > 0) c[band] = exitance_sum[band] / absorbed_sum[band];
  }
  const Field expected = absorbed.rowwise() * c;
  const Field difference = (problem.exitance - expected).abs();
  const bool holds = ((difference.rowwise() - tolerance * c) <= 0).all();
  return holds && (c > 0).any() ? std::optional(c) : std::nullopt;
}

Discrepancy discrepancy(const Simulation& simulation, const Reference& reference) {
  const Eigen::VectorXd& area = simulation.problem.area;
  const Means means = means_over(simulation, reference);
  const double patches = simulation.mesh.size();
  const double hidden = reference.uniform ? 1 : std::max(0.1, 1 - patches / reference.mesh.size());

  Discrepancy result;
  result.of_means = relative_error(means.radiosity, simulation.solution.radiosity, simulation.problem);
  result.squares = Eigen::VectorXd::Zero(area.size());
  const Eigen::ArrayXd size = area_norm(means.radiosity - simulation.problem.exitance, area).square();
  const Field squares = (means.radiosity - simulation.solution.radiosity).square().colwise() * area.array();
  const Field spread = means.spread.colwise() * area.array();
  double worst = 0;
  for (Eigen::Index band = 0; band < size.size(); ++band) {
    if (!(size[band] > 0)) continue;
    const double of_means = squares.col(band).sum() / size[band];
    const double of_display = of_means + spread.col(band).sum() / hidden / size[band];
    result.of_display = std::max(result.of_display, std::sqrt(of_display));
    if (of_means < worst) continue;
    worst = of_means;
    result.squares = squares.col(band).matrix() / size[band];
  }
  return result;
}

}  // namespace patchlight
