#include "pipeline/ray_light.h"

#include "accuracy/errors.h"
#include "accuracy/refinement.h"
#include "base/vectors.h"
#include "mesh/means_around.h"
#include "pipeline/conserved_flux.h"
#include "pipeline/lamps_apart.h"
#include "pipeline/problem_of.h"
#include "solve/scattering.h"
#include "transport/bright_patches.h"
#include "transport/row_blocks.h"
#include "transport/smoothing.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <string>
#include <utility>

namespace patchlight {
namespace {

// Half as many towards bright patches as over the hemisphere, in packets of both halves.
RayOptions rays_as_planned(const AssemblyOptions& assembly) {
  constexpr int packets = 32;
  return {.rays = assembly.rays,
          .toward_bright = std::max(1, assembly.rays / (2 * packets)) * packets,
          .lost_share_rays = assembly.lost_share_rays,
          .seed = assembly.seed};
}

// H = F_lamps E_lamps for factors of one value per patch and lamp.
Field irradiance_by(const LampValues& factors, const Field& exitance) {
  return (factors.cast<double>().matrix() * exitance.matrix()).array();
}

Field emitted_in_rows(const RayLight& light) {
  Field exitance = light.lit.problem.exitance;
  for (Eigen::Index i = 0; i < exitance.rows(); ++i)
    if (light.is_apart[static_cast<std::size_t>(i)] != 0) exitance.row(i) = 0;
  return exitance;
}

// Light that comes from no patch of the rows.
Field direct_of(const RayLight& light) {
  Field direct = 0.5 * (light.by_lamps[0] + light.by_lamps[1]);
  for (const Field* more : {&light.lit.problem.direct_irradiance, &light.in_mirrors.irradiance})
    if (more->size() > 0) direct += *more;
  return direct;
}

// The light of the lamps apart, as means over whole patches.
RayLight light_of(const RayExchange& exchange, LitProblem lit, PatchIndex patches) {
  RayLight light{.lit = std::move(lit),
                 .is_apart = {},
                 .by_lamps = {},
                 .lamp_standard_error = {},
                 .in_mirrors = {},
                 .distance = {},
                 .is_missed = {}};
  const RadiosityProblem& problem = light.lit.problem;
  light.is_apart.assign(patches, 0);
  Field exitance(static_cast<Eigen::Index>(exchange.lamps.size()), problem.exitance.cols());
  for (std::size_t k = 0; k < exchange.lamps.size(); ++k) {
    const auto [begin, end] = exchange.lamps[k];
    exitance.row(static_cast<Eigen::Index>(k)) = problem.exitance.row(begin);
    std::fill(light.is_apart.begin() + begin, light.is_apart.begin() + end, 1);
  }
  const LampFactors& factors = exchange.lamp_factors;
  for (std::size_t half = 0; half < 2; ++half) light.by_lamps[half] = irradiance_by(factors.halves[half], exitance);
  light.lamp_standard_error = irradiance_by(factors.standard_error.square(), exitance.square()).sqrt();
  return light;
}

// What the light makes bright.
BrightPatches bright_patches_of(const Run& run, const PatchMesh& mesh, const RayLight& light) {
  const Field expected = emitted_in_rows(light) + light.lit.problem.scattering.reflect(direct_of(light));
  return {mesh, summed_over_bands(expected), bright, run.tracing->between_patches()};
}

// Rows, with rays towards that.
TracedRows traced_rows(const Run& run, const Plan& plan, const PatchMesh& mesh, const RayLight& light) {
  const Occluder& occluder = run.tracing->between_patches();
  const BrightPatches bright_patches = bright_patches_of(run, mesh, light);
  const RayOptions options = rays_as_planned(plan.assembly);
  if (!run.with.row_blocks) return trace_rows(mesh, occluder, bright_patches, options, run.observer);
  const RowBlocks blocks = run.with.row_blocks(mesh, options, bright_patches.densities());
  return trace_rows(mesh, occluder, bright_patches, options, run.observer, &blocks);
}

// The share of what each patch holds back that is exposed.
Eigen::ArrayXd exposed_shares(const Run& run, const PatchMesh& mesh, const Eigen::VectorXd& exposed_area) {
  const Occluder& occluder = run.tracing->between_patches();
  Eigen::ArrayXd exposed = exposed_area.array();
  for (PatchIndex i = 0; i < mesh.size(); ++i)
    exposed[i] /= mesh.area[i] * occluder.held_share(mesh.polygon[i], mesh.side[i]);
  return exposed;
}

struct ExchangeAndLight {
  RayExchange exchange;
  RayLight light;  // means over whole patches
};

ExchangeAndLight exchange_and_light(const Run& run, const Plan& plan, const PatchMesh& mesh) {
  const Eigen::Map<const Eigen::VectorXd> area(mesh.area.data(), static_cast<Eigen::Index>(mesh.size()));
  LitProblem lit = lit_problem(run, plan, mesh, area);
  const bool is_known = static_cast<bool>(run.with.ray_exchange);
  RayExchange exchange = is_known ? with_lamps(run.with.ray_exchange(mesh), run, plan, mesh, lit.problem)
                                  : traced_lamps(run, plan, mesh, lit.problem);
  RayLight light = light_of(exchange, std::move(lit), mesh.size());
  light.in_mirrors = lamps_in_mirrors(run, plan, mesh, exchange.lamps);
  if (!is_known) {
    exchange.rows = traced_rows(run, plan, mesh, light);
    return {std::move(exchange), std::move(light)};
  }
  // Not stored, as it is of the materials.
  exchange.rows.lost.clear = clear_shares(mesh, run.tracing->between_patches());
  const BrightPatches now = bright_patches_of(run, mesh, light);
  for (PatchIndex i = 0; i < mesh.size(); ++i)
    light.is_missed.push_back(now.density(i) > 0 && exchange.rows.directed[i] == 0 ? 1 : 0);
  light.rays_per_patch = static_cast<double>(exchange.rows.rays) / mesh.size();
  return {std::move(exchange), std::move(light)};
}

}  // namespace

RayExchange trace_ray_exchange(const Run& run, const Plan& plan, const PatchMesh& mesh) {
  return exchange_and_light(run, plan, mesh).exchange;
}

RayTransportAndLight ray_light(const Run& run, const Plan& plan, const PatchMesh& mesh) {
  // 1. Rows, and light where it first arrives.
  auto [exchange, light] = exchange_and_light(run, plan, mesh);
  light.distance = std::move(exchange.rows.distance);

  // 2. Means over the exposed part of each patch, which is known but for its own error.
  const LostShare& lost = exchange.rows.lost;
  RadiosityProblem& problem = light.lit.problem;
  problem.area = exchange.rows.area;
  problem.scattering = with_sheets(std::move(problem.scattering), run.scene, mesh, problem.area);
  light.lit = over_exposed_part(std::move(light.lit), mesh, lost);
  const Eigen::ArrayXd exposed = exposed_shares(run, mesh, exchange.rows.area);
  for (Field* field : {&light.by_lamps[0], &light.by_lamps[1], &light.lamp_standard_error}) field->colwise() /= exposed;
  const Eigen::ArrayXd relative = exposure_errors(lost);
  const Field by_exposure = (0.5 * (light.by_lamps[0] + light.by_lamps[1])).colwise() * relative;
  light.lamp_standard_error = (light.lamp_standard_error.square() + by_exposure.square()).sqrt();
  Field& of_direct = light.lit.direct_standard_error;
  if (of_direct.size() > 0) {
    const Field off = light.lit.problem.direct_irradiance.colwise() * relative;
    of_direct = (of_direct.square() + off.square()).sqrt();
  }
  if (light.in_mirrors.irradiance.size() > 0) {
    auto& [irradiance, error] = light.in_mirrors;
    const Eigen::ArrayXd factor = over_exposed_part(mesh, lost, exchange.rows.area);
    irradiance.colwise() *= factor;
    error = ((error.colwise() * factor).square() + (irradiance.colwise() * relative).square()).sqrt();
  }
  return {std::move(exchange.rows), std::move(light)};
}

namespace {

// B = E + rho o H of light that is not reflected twice, H by lamps and what the rows carry of the rest.
Solution reflected_once(const RayTransport& transport, const RadiosityProblem& problem) {
  Solution solution;
  solution.irradiance = transport.apply(problem.exitance) + problem.direct_irradiance;
  solution.direct_irradiance = solution.irradiance;
  solution.radiosity = radiosity_from(problem, solution.irradiance);
  solution.error = Field::Zero(solution.radiosity.rows(), solution.radiosity.cols());
  solution.patch_bound = 0;
  solution.converged = true;
  solution.history = {{.work = 1}};
  return solution;
}

// The square of what smoothing has wrong over the variance that it leaves, of all patches together, per band: (S - H)
// of one half times that of the other has the square of the bias as its mean, as the halves are independent.
Eigen::ArrayXd bias_over_variance(const SmoothedHalves& smooth, const std::array<Field, 2>& raw,
                                  const RadiosityProblem& problem) {
  const auto weighted = [&](const Field& irradiance_squared) {
    return area_sum(reflected_variance(problem.scattering, irradiance_squared), problem.area);
  };
  const Eigen::ArrayXd bias = weighted((smooth.halves[0] - raw[0]) * (smooth.halves[1] - raw[1])).max(0.0);
  return quotient(bias, weighted(smooth.variance));
}

// Errors of single patches' irradiances that do not depend on each other.
struct SingleVariances {
  Field of_rows;    // of which all that gets lost is shared out again
  Field of_lights;  // of lamps and lights that are no patches
};

// The variance of the flux that all patches reflect of light from other patches, relative to its square, per band. What
// a patch sends is reflected by others psi - 1 times as much as by itself, psi = 1 + F R psi. In a bright room that is
// more than its own error; but for rows only how far it is from the mean counts, as no flux gets lost.
Eigen::ArrayXd variance_of_level(const RayTransport& transport, const SolvedProblem& solved, const ConservedFlux& flux,
                                 const SingleVariances& variances) {
  const RadiosityProblem& problem = solved.problem;
  const Eigen::VectorXd& area = problem.area;
  const Eigen::VectorXd psi = importance(transport, problem, Eigen::VectorXd::Ones(area.size()));
  const Field again = (psi.array() - 1).replicate(1, problem.exitance.cols());
  const Field gain = problem.scattering.reflect(again);
  const Field beyond_mean = gain.rowwise() - area_sum(flux.shape * gain, area).transpose();
  const Field variance = beyond_mean.square() * variances.of_rows + gain.square() * variances.of_lights;
  const Field from_patches = solved.solution.irradiance - problem.direct_irradiance;
  const Eigen::ArrayXd reflected = area_sum(problem.scattering.reflect(from_patches), area);
  return quotient(area_sum(variance.colwise() * area.array(), area), reflected.square());
}

// The variance of the irradiance by bright patches that no ray was sent towards, of n rays over the hemisphere: its
// mean over all patches is sum_j A_j s_j B_j^2 / (n A), which rays that all miss them do not tell. One value per band.
Eigen::ArrayXd variance_of_missed(const RayLight& light, const Field& sources, const Eigen::VectorXd& row_sum) {
  const Eigen::VectorXd& area = light.lit.problem.area;
  Field squares = sources.square();
  for (Eigen::Index i = 0; i < squares.rows(); ++i)
    if (light.is_missed[static_cast<std::size_t>(i)] == 0) squares.row(i) = 0;
  return area_sum(squares, area.cwiseProduct(row_sum)) / (light.rays_per_patch * total(area));
}

// The last gather by each half of the rays.
std::array<Field, 2> gathered(const RayTransport& transport, const Field& sources, const ConservedFlux* flux,
                              const Eigen::VectorXd& area) {
  std::array<Field, 2> halves;
  for (std::size_t half = 0; half < 2; ++half) {
    halves[half] = transport.apply_half(half, sources);
    if (flux != nullptr) halves[half] = flux->completed(std::move(halves[half]), sources, area);
  }
  return halves;
}

// Not of the solution that is looked for.
Observer without_iterates(const Observer& observer) {
  if (!observer) return {};
  return [&observer](const Progress& progress) {
    return observer({.stage = progress.stage, .fraction = progress.fraction});
  };
}

}  // namespace

RaySolution solve_with_rays(const Run& run, const PatchMesh& mesh, const RayTransport& transport, const RayLight& light,
                            const Eigen::VectorXd& row_sum, const SolverOptions& options) {
  const RadiosityProblem& all = light.lit.problem;
  const RadiosityProblem problem{all.scattering, emitted_in_rows(light), all.area, direct_of(light)};

  // 1. Solve for what the rows carry, without losing any of it.
  const bool reflects_twice = simulates(run.plan, Effect::interreflection);
  auto [solution, flux] = reflects_twice
                              ? conserving_flux(transport, problem, solve(transport, problem, options, run.observer),
                                                row_sum, without_iterates(run.observer))
                              : ConservingSolution{reflected_once(transport, problem), {}};

  // 2. Gather once more, by each half, and smooth.
  const Field& sources = reflects_twice ? solution.radiosity : problem.exitance;
  const std::array<Field, 2> raw = gathered(transport, sources, reflects_twice ? &flux : nullptr, all.area);
  SmoothedHalves smooth = smoothed(mesh, light.distance, raw);

  // 3. What that scatters, and how far it is off where irradiance is not linear.
  const Eigen::ArrayXd bias = bias_over_variance(smooth, raw, problem);
  Field variance = scaled(smooth.variance, 1 + bias) + light.lamp_standard_error.square();
  // Two halves may agree by chance, or both miss a bright gap that rays of patches around meet.
  variance = variance.max(mean_around(mesh, all.area, variance)).eval();
  if (!light.is_missed.empty()) variance.rowwise() += variance_of_missed(light, sources, row_sum).transpose();
  SingleVariances single{(0.5 * (raw[0] - raw[1])).square(), light.lamp_standard_error.square()};
  for (const Field* error : {&light.lit.direct_standard_error, &light.in_mirrors.standard_error}) {
    if (error->size() == 0) continue;
    variance += error->square();
    single.of_lights += error->square();
  }

  // 4. B = E + rho o H with all that is emitted.
  solution.irradiance = (0.5 * (smooth.halves[0] + smooth.halves[1])).max(0.0) + problem.direct_irradiance;
  solution.radiosity = radiosity_from(all, solution.irradiance);

  // 5. What single rows err is in the light of all bounces, the mean of which is reflected as often as it is.
  if (reflects_twice) {
    const Eigen::ArrayXd level = variance_of_level(transport, {problem, solution}, flux, single);
    variance += scaled((solution.irradiance - problem.direct_irradiance).square(), level);
  }
  return {std::move(solution), variance.sqrt()};
}

}  // namespace patchlight
