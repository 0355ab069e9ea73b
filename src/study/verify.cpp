#include "patchlight/study/verify.h"

#include "patchlight/base/parallel.h"
#include "patchlight/base/sampling.h"

#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

namespace patchlight {
namespace {

// Without replacement, in proportion to the exposed area: those with the largest log(u) / area, u uniform in (0, 1)
// (Efraimidis and Spirakis 2006).
std::vector<PatchIndex> choose_by_area(const Eigen::VectorXd& area, std::size_t count, std::uint64_t seed) {
  std::vector<std::pair<double, PatchIndex>> keys;
  for (PatchIndex i = 0; i < static_cast<PatchIndex>(area.size()); ++i) {
    const double u = (hash({seed, 0x63686f6f7365, i}) + 0.5) * 0x1p-32;
    keys.emplace_back(-std::log(u) / area[i], i);
  }
  std::sort(keys.begin(), keys.end());
  std::vector<PatchIndex> chosen;
  for (std::size_t k = 0; k < std::min(count, keys.size()); ++k) chosen.push_back(keys[k].second);
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

std::vector<PathReceiver> receivers_of(const PatchMesh& mesh, const std::vector<PatchIndex>& patches) {
  std::vector<PathReceiver> receivers;
  for (const PatchIndex i : patches) receivers.push_back({mesh.corner_points(i).points, mesh.polygon[i], mesh.side[i]});
  return receivers;
}

Field rows_of(const FieldView& field, const std::vector<PatchIndex>& patches) {
  Field rows(static_cast<Eigen::Index>(patches.size()), field.cols());
  for (std::size_t k = 0; k < patches.size(); ++k) rows.row(static_cast<Eigen::Index>(k)) = field.row(patches[k]);
  return rows;
}

// The probability that a chi-square of so many degrees of freedom is this or larger.
double upper_tail(double chi_square, std::size_t degrees) {
  if (degrees == 0) return 1;
  if (!std::isfinite(chi_square)) return 0;
  return boost::math::gamma_q(static_cast<double>(degrees) / 2, chi_square / 2);
}

}  // namespace

Field irradiance_bar(const Simulation& simulation, double relative) {
  const Solution& solution = simulation.solution;
  const Eigen::ArrayXd& area = simulation.problem.area.array();
  const Spectrum mean = (solution.irradiance.colwise() * area).colwise().sum() / area.sum();
  Field bar = relative * solution.irradiance.max(mean.replicate(solution.irradiance.rows(), 1));
  if (solution.error.size() == 0) return bar;
  // B = E + rho o H: |dB_i| = rho_i |dH_i|.
  const Field& rho = simulation.problem.reflectance;
  const Field of_solver = (rho > 0).select(solution.error / rho, 0.0);
  const Spectrum largest = of_solver.colwise().maxCoeff();
  return bar + (rho > 0).select(of_solver, largest.replicate(rho.rows(), 1));
}

Field deviations(const Verification& verification) {
  constexpr double degrees = path_batches - 1;
  const Field noise = verification.paths.standard_error.square() * (degrees / (degrees - 2));
  const Field difference = verification.irradiance - verification.paths.irradiance;
  const Field none = Field::Zero(difference.rows(), difference.cols());
  return (difference == 0).select(none, difference / (noise + verification.bar.square()).sqrt());
}

Field deviations_by_noise(const Verification& verification) {
  const Field& noise = verification.paths.standard_error;
  const Field unknown = Field::Constant(noise.rows(), noise.cols(), std::numeric_limits<double>::quiet_NaN());
  return (noise > 0).select((verification.irradiance - verification.paths.irradiance) / noise, unknown);
}

Verification verify(const Scene& scene, const Simulation& simulation, const FieldView& bar,
                    const VerifyOptions& options, const Observer& observer) {
  assert(bar.rows() == simulation.mesh.size());
  Verification result;
  result.patches = choose_by_area(simulation.problem.area, options.checked, options.seed);
  result.irradiance = rows_of(simulation.solution.irradiance, result.patches);
  result.bar = rows_of(bar, result.patches);
  result.paths = trace_irradiance(scene, simulation.plan.sides, receivers_of(simulation.mesh, result.patches),
                                  {.paths = options.paths, .seed = options.seed}, observer);

  // Bands go together, so that they are not added up: the worst one decides, among so many (Bonferroni).
  result.chi_square = deviations(result).square().colwise().sum().transpose();
  const double bands = static_cast<double>(result.chi_square.size());
  result.probability = std::min(1.0, bands * upper_tail(result.chi_square.maxCoeff(), result.patches.size()));
  result.agrees = result.probability >= least_probability;
  return result;
}

}  // namespace patchlight
