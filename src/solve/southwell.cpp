#include "solve/southwell.h"

#include "base/vectors.h"
#include "solve/coarse_transport.h"
#include "solve/scattering.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

namespace patchlight {
namespace {

// The share of even irradiance that is reflected.
Eigen::ArrayXd mean_reflectance_of(const RadiosityProblem& problem) {
  const Field reflected = reflect_even(problem.scattering, Eigen::ArrayXd::Ones(problem.exitance.cols()));
  return area_sum(reflected, problem.area) / total(problem.area);
}

// Irradiance that the unshot radiosity would add everywhere if it and all its reflections spread evenly:
// sum_i A_i dB_i / sum_i A_i / (1 - mean rho). Cohen et al. 1988, section 3.2. What overshooting shoots beforehand.
Eigen::ArrayXd even_irradiance(const Field& unshot, const Eigen::VectorXd& area,
                               const Eigen::ArrayXd& mean_reflectance) {
  const Eigen::ArrayXd mean_unshot = area_sum(unshot, area) / total(area);
  return (mean_reflectance < 1).select(mean_unshot / (1 - mean_reflectance), 0.0);
}

// The lamps' light where it arrives first, the number of their patches, and what their rows tell.
struct Lamps {
  Field irradiance;
  Eigen::Index patches = 0;
  CoarseTransport coarse;
};

// `iterations` is told of each row.
Lamps lamps_shot(Iterations& iterations, const RowTransport& transport) {
  const RadiosityProblem& problem = iterations.problem();
  const Field& exitance = problem.exitance;
  Lamps lamps{Field::Zero(exitance.rows(), exitance.cols()), 0, CoarseTransport(problem)};
  for (Eigen::Index i = 0; i < exitance.rows(); ++i) {
    if (!(exitance.row(i) > 0).any()) continue;
    const auto index = static_cast<PatchIndex>(i);
    const Field arriving = transport.shoot({index, index + 1}, exitance.row(i));
    lamps.coarse.learn(i, exitance.row(i), arriving);
    lamps.irradiance += arriving;
    ++lamps.patches;
    iterations.count(1.0 / static_cast<double>(exitance.rows()));
    iterations.keep_observer();
  }
  return lamps;
}

// How much of what is unshot is shot, per band: where overshooting has taken care of the light that spreads evenly, the
// best factor of over-relaxation for the next eigenvalue of K (Young 1971). That of F is about 0.7 in rooms like boxes.
Eigen::ArrayXd over_relaxation(const Eigen::ArrayXd& mean_reflectance) {
  constexpr double next_eigenvalue = 0.7;
  return 2 / (1 + (1 - (next_eigenvalue * mean_reflectance).square()).sqrt());
}

// What is shot of what is unshot and of what is expected to come.
Field with_expected(const Field& unshot, const RadiosityProblem& problem, const Eigen::ArrayXd& mean_reflectance) {
  Field waiting = reflect_even(problem.scattering, even_irradiance(unshot, problem.area, mean_reflectance));
  waiting += unshot.rowwise() * over_relaxation(mean_reflectance).transpose();
  return waiting;
}

// The patch with the most flux to shoot, summed over the bands.
Eigen::Index brightest_patch(const Field& waiting, const Eigen::VectorXd& area) {
  Eigen::Index source = 0;
  (waiting.abs().rowwise().sum() * area.array()).maxCoeff(&source);
  return source;
}

// How many shots there may be after the lamps'.
std::int64_t most_shots(const SolverOptions& options, Eigen::Index patches, Eigen::Index lamps) {
  const std::int64_t most = std::min<std::int64_t>(static_cast<std::int64_t>(options.max_iterations) * patches,
                                                   std::numeric_limits<int>::max());
  if (!options.max_rows) return most;
  const double rows = std::min(*options.max_rows, 1.0 * options.max_iterations + 1) * static_cast<double>(patches);
  return std::clamp<std::int64_t>(static_cast<std::int64_t>(rows) - lamps, 0, most);
}

}  // namespace

Solution progressive_refinement(Iterations iterations, const RowTransport& transport, Shot shot) {
  const RadiosityProblem& problem = iterations.problem();
  const Eigen::Index n = problem.exitance.rows();
  Lamps lamps = lamps_shot(iterations, transport);
  CoarseTransport coarse = std::move(lamps.coarse);
  Field H = lamps.irradiance;
  // With X the radiosity shot so far, B = E + K X: the residual of X, and what B lacks before one reflection, is
  // unshot.
  Field unshot = problem.scattering.reflect(H);
  iterations.show(coarse.ambient(unshot));
  if (iterations.start(std::move(lamps.irradiance))) return iterations.finish();

  const std::int64_t most = most_shots(iterations.options(), n, lamps.patches);
  std::int64_t next_record = 1;
  const Eigen::ArrayXd mean_reflectance = mean_reflectance_of(problem);
  for (std::int64_t shots = 1; shots <= most && !iterations.ended(); ++shots) {
    const Field overshot = shot == Shot::overshot ? with_expected(unshot, problem, mean_reflectance) : Field();
    const Field& waiting = shot == Shot::overshot ? overshot : unshot;
    // A first picture needs to know where the light of each group of patches goes.
    const bool explores = iterations.options().max_rows.has_value();
    const Eigen::Index source = explores ? coarse.next_source(waiting) : brightest_patch(waiting, problem.area);
    const Field shot_radiosity = waiting.row(source);
    // Nothing is left to shoot: what there is is the solution.
    const bool is_done = (shot_radiosity == 0).all();
    if (is_done) next_record = shots;
    const auto index = static_cast<PatchIndex>(source);
    const Field arriving =
        is_done ? Field::Zero(n, shot_radiosity.cols()) : transport.shoot({index, index + 1}, shot_radiosity);
    unshot.row(source) -= shot_radiosity;
    unshot = plus_reflected(std::move(unshot), problem.scattering, arriving);
    H += arriving;
    coarse.learn(source, shot_radiosity, arriving);
    iterations.count(1.0 / static_cast<double>(n));
    iterations.keep_observer();
    if (shots < next_record && shots < most && !iterations.ended()) continue;
    iterations.show(coarse.ambient(unshot));
    iterations.record({radiosity_from(problem, H), H, unshot}, static_cast<int>(shots));
    // Ever longer pauses, up to an eighth of all patches.
    next_record = shots + std::clamp<std::int64_t>(shots / 10, 1, std::max<Eigen::Index>(1, n / 8));
  }
  return iterations.finish();
}

}  // namespace patchlight
