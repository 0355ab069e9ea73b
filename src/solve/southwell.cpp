#include "solve/southwell.h"

#include "solve/coarse_transport.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

namespace patchlight {
namespace {

// Irradiance that the unshot radiosity would add everywhere if it and all its reflections spread evenly:
// sum_i A_i dB_i / sum_i A_i / (1 - mean rho). Cohen et al. 1988, section 3.2. What overshooting shoots beforehand.
Field even_irradiance(const Field& unshot, const RadiosityProblem& problem) {
  const double total = problem.area.sum();
  const Field mean_unshot = (unshot.colwise() * problem.area.array()).colwise().sum() / total;
  const Field mean_reflectance = (problem.reflectance.colwise() * problem.area.array()).colwise().sum() / total;
  return (mean_reflectance < 1).select(mean_unshot / (1 - mean_reflectance), 0.0);
}

// The lamps' light where it arrives first, and what their rows tell.
struct Lamps {
  Field irradiance;
  CoarseTransport coarse;
};

// `iterations` is told of each row.
Lamps lamps_shot(Iterations& iterations, const RowTransport& transport) {
  const RadiosityProblem& problem = iterations.problem();
  const Field& exitance = problem.exitance;
  Lamps lamps{Field::Zero(exitance.rows(), exitance.cols()), CoarseTransport(problem)};
  for (Eigen::Index i = 0; i < exitance.rows(); ++i) {
    if (!(exitance.row(i) > 0).any()) continue;
    const auto index = static_cast<PatchIndex>(i);
    const Field arriving = transport.shoot({index, index + 1}, exitance.row(i));
    lamps.coarse.learn(i, exitance.row(i), arriving);
    lamps.irradiance += arriving;
    iterations.count(1.0 / static_cast<double>(exitance.rows()));
    iterations.keep_observer();
  }
  return lamps;
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
  Field unshot = problem.reflectance * H;
  iterations.show(coarse.ambient(unshot));
  if (iterations.start(std::move(lamps.irradiance))) return iterations.finish();

  const std::int64_t most = std::min<std::int64_t>(static_cast<std::int64_t>(iterations.options().max_iterations) * n,
                                                   std::numeric_limits<int>::max());
  std::int64_t next_record = 1;
  for (std::int64_t shots = 1; shots <= most && !iterations.ended(); ++shots) {
    const Field waiting = shot == Shot::unshot
                              ? unshot
                              : Field(unshot + problem.reflectance.rowwise() * even_irradiance(unshot, problem).row(0));
    const Eigen::Index source = coarse.next_source(waiting);
    const Field shot_radiosity = waiting.row(source);
    const auto index = static_cast<PatchIndex>(source);
    const Field arriving = transport.shoot({index, index + 1}, shot_radiosity);
    unshot.row(source) -= shot_radiosity;
    unshot += problem.reflectance * arriving;
    H += arriving;
    coarse.learn(source, shot_radiosity, arriving);
    iterations.count(1.0 / static_cast<double>(n));
    iterations.keep_observer();
    if (shots < next_record && shots < most) continue;
    iterations.show(coarse.ambient(unshot));
    iterations.record({problem.exitance + problem.reflectance * H, H, unshot}, static_cast<int>(shots));
    // Ever longer pauses, up to an eighth of all patches.
    next_record = shots + std::clamp<std::int64_t>(shots / 10, 1, std::max<Eigen::Index>(1, n / 8));
  }
  return iterations.finish();
}

}  // namespace patchlight
