#include "solve/southwell.h"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace patchlight {
namespace {

// Irradiance that the unshot radiosity would add everywhere if it and all its reflections spread evenly:
// sum_i A_i dB_i / sum_i A_i / (1 - mean rho). Cohen et al. 1988, section 3.2.
Field ambient_irradiance(const Field& unshot, const RadiosityProblem& problem) {
  const double total = problem.area.sum();
  const Field mean_unshot = (unshot.colwise() * problem.area.array()).colwise().sum() / total;
  const Field mean_reflectance = (problem.reflectance.colwise() * problem.area.array()).colwise().sum() / total;
  return (mean_reflectance < 1).select(mean_unshot / (1 - mean_reflectance), 0.0);
}

// The lamps' light where it arrives first, and the number of their patches.
struct Lamps {
  Field irradiance;
  Eigen::Index patches = 0;
};

Lamps lamps_shot(const RowTransport& transport, const Field& exitance) {
  Lamps lamps{Field::Zero(exitance.rows(), exitance.cols())};
  for (Eigen::Index i = 0; i < exitance.rows(); ++i) {
    if (!(exitance.row(i) > 0).any()) continue;
    const auto index = static_cast<PatchIndex>(i);
    lamps.irradiance += transport.shoot({index, index + 1}, exitance.row(i));
    ++lamps.patches;
  }
  return lamps;
}

// How much of what is unshot is shot, per band: where overshooting has taken care of the light that spreads evenly, the
// best factor of over-relaxation for the next eigenvalue of K (Young 1971). That of F is about 0.7 in rooms like boxes.
Field over_relaxation(const RadiosityProblem& problem) {
  constexpr double next_eigenvalue = 0.7;
  const Field mean_reflectance =
      (problem.reflectance.colwise() * problem.area.array()).colwise().sum() / problem.area.sum();
  return 2 / (1 + (1 - (next_eigenvalue * mean_reflectance).square()).sqrt());
}

// Flux that waits to be shot, summed over the bands, decides who shoots next. What is overshot is negative later, and
// must not hide behind what is missing in another band.
Eigen::Index brightest(const Field& waiting, const Eigen::VectorXd& area) {
  Eigen::Index patch = 0;
  (waiting.abs().rowwise().sum() * area.array()).maxCoeff(&patch);
  return patch;
}

}  // namespace

Solution progressive_refinement(Iterations iterations, const RowTransport& transport, Shot shot) {
  const RadiosityProblem& problem = iterations.problem();
  const Eigen::Index n = problem.exitance.rows();
  Lamps lamps = lamps_shot(transport, problem.exitance);
  iterations.count(static_cast<double>(lamps.patches) / static_cast<double>(n));
  Field H = lamps.irradiance;
  // With X the radiosity shot so far, B = E + K X: the residual of X, and what B lacks before one reflection, is
  // unshot.
  Field unshot = problem.reflectance * H;
  Field ambient = ambient_irradiance(unshot, problem);
  iterations.show(ambient);
  if (iterations.start(std::move(lamps.irradiance))) return iterations.finish();

  const std::int64_t most = static_cast<std::int64_t>(iterations.options().max_iterations) * n;
  std::int64_t next_record = 1;
  const Field factor = over_relaxation(problem);
  for (std::int64_t shots = 1; shots <= most && !iterations.good(); ++shots) {
    const Field waiting =
        shot == Shot::unshot ? unshot
                             : Field(unshot.rowwise() * factor.row(0) + problem.reflectance.rowwise() * ambient.row(0));
    const Eigen::Index source = brightest(waiting, problem.area);
    const Field flash = waiting.row(source);
    const auto index = static_cast<PatchIndex>(source);
    const Field arriving = transport.shoot({index, index + 1}, flash);
    unshot.row(source) -= flash;
    unshot += problem.reflectance * arriving;
    H += arriving;
    iterations.count(1.0 / static_cast<double>(n));
    const bool to_record = shots >= next_record || shots == most;
    if (shot == Shot::overshot || to_record) ambient = ambient_irradiance(unshot, problem);
    if (!to_record) continue;
    iterations.show(ambient);
    iterations.record({problem.exitance + problem.reflectance * H, H, unshot}, static_cast<int>(shots));
    // Ever longer pauses, up to an eighth of all patches.
    next_record = shots + std::clamp<std::int64_t>(shots / 10, 1, std::max<Eigen::Index>(1, n / 8));
  }
  return iterations.finish();
}

}  // namespace patchlight
