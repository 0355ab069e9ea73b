#include "pipeline/mesh_transport.h"

#include "accuracy/errors.h"
#include "base/sampling.h"
#include "base/vectors.h"
#include "form_factor/patch_shape.h"
#include "mesh/interpolate.h"
#include "mesh/nested_mesh.h"
#include "pipeline/conserved_flux.h"
#include "pipeline/needed_light.h"
#include "pipeline/problem_of.h"
#include "pipeline/second_mesh.h"
#include "solve/scattering.h"
#include "transport/closure.h"
#include "transport/pair_sampler.h"
#include "transport/ray_rows.h"
#include "transport/smoothing.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

// B = E + rho o H of light that is not reflected twice, H by lamps and what the rows carry of the rest.
ConservingSolution reflected_once(const RaysWithPockets& transport, const RadiosityProblem& problem) {
  ConservingSolution once;
  once.gathered = {transport.rays().apply_half(0, problem.exitance), transport.rays().apply_half(1, problem.exitance)};
  Solution& solution = once.solution;
  solution.irradiance = 0.5 * (once.gathered[0] + once.gathered[1]) + problem.direct_irradiance;
  solution.direct_irradiance = solution.irradiance;
  solution.radiosity = radiosity_from(problem, solution.irradiance);
  solution.error = Field::Zero(solution.radiosity.rows(), solution.radiosity.cols());
  solution.patch_bound = 0;
  solution.converged = true;
  solution.history = {{.work = 1}};
  return once;
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

// The parts of a last gather.
struct Gather {
  const PatchMesh& mesh;
  const RaysWithPockets& transport;
  const RayLight& light;
  const NeededLight& needed;
  const TransportFacts& facts;
};

// Independent errors of single patches' irradiances, W/m^2.
struct SingleErrors {
  Field of_rows;    // half of the difference of the two halves
  Field of_lights;  // standard errors of lamps and of lights that are no patches
};

// A mean square over n draws has a relative standard error of sqrt(2 / n). Of many patches each draw costs more.
std::uint64_t number_of_draws(PatchIndex patches) {
  constexpr PatchIndex very_many_patches = 100'000;
  return patches > very_many_patches ? 4 : patches > many_patches ? 8 : 16;
}

// Equally likely errors by reflection: each draw gives the error n_i of every patch a random sign, and follows it,
// e = n + F R e. The part F R e is common to all patches that see the same light, so that it does not average out over
// a room. Closed spaces have shared out the flux that n adds. Signs are common to all bands.
std::vector<Field> draw_reflected_errors(const Gather& by, const ConservedFlux& flux, const SingleErrors& single) {
  enum Purpose : std::uint64_t { of_rows = 0x64726177, of_lights };
  const RadiosityProblem& problem = by.needed.problem;
  const std::vector<std::uint32_t> keys = patch_keys(by.mesh);
  const auto with_signs = [&](Field error, std::uint64_t draw, Purpose purpose) {
    for (PatchIndex i = 0; i < by.mesh.size(); ++i)
      if ((hash({keys[i], draw, purpose}) & 1U) != 0) error.row(i) *= -1;
    return error;
  };
  const Field none = Field::Zero(single.of_rows.rows(), single.of_rows.cols());
  std::vector<Field> draws;
  for (std::uint64_t draw = 0; draw < number_of_draws(by.mesh.size()); ++draw) {
    const Field error = flux.completed(with_signs(single.of_rows, draw, of_rows), none, problem.area) +
                        with_signs(single.of_lights, draw, of_lights);
    draws.push_back(followed(by.transport, problem, error) - error);
  }
  return draws;
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

// The variance of what each row sums up to, over its square. A share s that n independent rays tell has a variance of
// s (1 - s) / n, and s n of them meet patches. Shadow rays towards bright patches are counted as well, though they do
// not tell the sum: rays over the hemisphere are stratified, so that by their own number alone bars are too wide
// (tests/property/rays_test.cpp). Where sides without patches are seen it is that of the rays which have looked for
// these.
Eigen::ArrayXd variance_of_row_sums(const RaysWithPockets& transport, const PatchMesh& mesh,
                                    const Eigen::VectorXd& row_sum, const LostShare& lost) {
  const double small = small_area(mesh);
  const Eigen::ArrayXd rays = rays_of_patches(lost, mesh.size());
  Eigen::ArrayXd variance = Eigen::ArrayXd::Zero(row_sum.size());
  for (Eigen::Index i = 0; i < row_sum.size(); ++i) {
    const double s = row_sum[i];
    const auto row = static_cast<std::size_t>(i);
    double met = 0;
    for (const RayRows* half : {&transport.rays().rows(0), &transport.rays().rows(1)})
      met += static_cast<double>(half->first_hit[row + 1] - half->first_hit[row] + half->first_entry[row + 1] -
                                 half->first_entry[row]);
    if (!(s > 0 && met > 0)) continue;
    const bool sees_backs = lost.rays_per_patch > 0 && (lost.at_backs[i] > 0 || lost.covered[i] > 0);
    const double to_backs = mesh.area[row] < small ? rays[i] / 4 : rays[i];
    variance[i] = std::max(0.0, 1 - s) / (sees_backs ? std::min(met, s * to_backs) : met);
  }
  return variance;
}

// Both halves are scaled to the same row sums, so that their difference does not tell what these err: it is added to
// one half of each patch, by a hash of its key, and taken from the other.
constexpr std::uint32_t of_row_sums = 0x726f77;
std::array<Field, 2> with_errors_of_row_sums(std::array<Field, 2> halves, const PatchMesh& mesh,
                                             const Eigen::ArrayXd& variance) {
  const std::vector<std::uint32_t> keys = patch_keys(mesh);
  Eigen::ArrayXd drawn = variance.sqrt();
  for (PatchIndex i = 0; i < mesh.size(); ++i)
    if ((hash({keys[i], of_row_sums}) & 1U) != 0) drawn[i] = -drawn[i];
  const Field error = (0.5 * (halves[0] + halves[1])).colwise() * drawn;
  halves[0] += error;
  halves[1] -= error;
  return halves;
}

// Not of the solution that is looked for.
Observer without_iterates(const Observer& observer) {
  if (!observer) return {};
  return [&observer](const Progress& progress) {
    return observer({.stage = progress.stage, .fraction = progress.fraction});
  };
}

// The irradiance from other patches in the bands that need it, its variance with that of all lights, and the part of
// its error that patches have in common, as equally likely draws.
struct GatheredLight {
  Field irradiance;
  Field variance;
  std::vector<Field> correlated_errors;
};

// A solution in the needed bands; flux is null where no light is reflected twice.
struct SolvedInBands {
  const Solution& solution;
  const ConservedFlux* flux;
};

// The last gather, by each half, smoothed, and how far that may be off.
GatheredLight gathered_light(const Gather& by, const SolvedInBands& solved, std::array<Field, 2> gathered) {
  const RadiosityProblem& problem = by.needed.problem;
  const Eigen::VectorXd& row_sum = by.facts.row_sum;

  // 1. The halves, smoothed.
  const Field& sources = solved.flux ? solved.solution.radiosity : problem.exitance;
  if (solved.flux)
    for (Field& half : gathered) half = solved.flux->completed(std::move(half), sources, problem.area);
  const std::array<Field, 2> raw = with_errors_of_row_sums(
      std::move(gathered), by.mesh, variance_of_row_sums(by.transport, by.mesh, row_sum, by.facts.lost));
  SmoothedHalves smooth = smoothed(by.mesh, by.light.distance, raw);

  // 2. What that scatters, and how far it is off where irradiance is not linear.
  const Eigen::ArrayXd bias = bias_over_variance(smooth, raw, problem);
  GatheredLight found{(0.5 * (smooth.halves[0] + smooth.halves[1])).max(0.0), scaled(smooth.variance, 1 + bias), {}};
  // Two halves may agree by chance, or both miss a bright gap that rays of patches around meet. Variances are compared
  // by as many rays; those to lamps are as many for all.
  const Field& of_lamps = by.needed.of_lamps;
  const Eigen::ArrayXd times = multiples(by.facts.lost.doublings, by.mesh.size());
  const Field around = mean_around(by.mesh, problem.area, found.variance.colwise() * times);
  found.variance =
      found.variance.max(around.colwise() / times) + of_lamps.max(mean_around(by.mesh, problem.area, of_lamps));
  if (!by.light.is_missed.empty())
    found.variance.rowwise() += variance_of_missed(by.light, sources, row_sum).transpose();
  Field of_lights = by.needed.of_lamps;
  if (by.needed.of_others.size() > 0) {
    found.variance += by.needed.of_others;
    of_lights += by.needed.of_others;
  }
  if (!solved.flux || !solved.solution.trapped.empty()) return found;

  // 3. Errors of single patches are in the light of all bounces.
  found.correlated_errors = draw_reflected_errors(by, *solved.flux, {0.5 * (raw[0] - raw[1]), of_lights.sqrt()});
  found.variance += mean_square(found.correlated_errors);
  return found;
}

// Exchange areas before closure with the errors of their entries; what is known from the mesh before is taken over.
Assembly assembly_of(const Run& run, const Plan& plan, const PatchMesh& mesh, const Known& known) {
  const Occluder& occluder = run.world->between_patches();
  if (!known.exchange) return assemble_exchange_areas(mesh, occluder, plan.assembly, run.observer);
  return assemble_exchange_areas(mesh, occluder, plan.assembly, {*known.exchange, known.place}, run.observer);
}

LostShare lost_share_of(const Run& run, const Plan& plan, const PatchMesh& mesh, const Known& known) {
  const Occluder& occluder = run.world->between_patches();
  if (!known.lost)
    return measure_lost_share(mesh, occluder, plan.assembly.lost_share_rays, plan.assembly.seed, run.observer);
  return measure_lost_share(mesh, occluder, KnownShares{*known.lost, known.place}, plan.assembly.seed, run.observer);
}

// Exchange areas by computation, unless they are known or computed on demand.
Exchange exchange_on(const Run& run, const Plan& plan, const PatchMesh& mesh) {
  if (run.with.exchange) {
    Exchange exchange = run.with.exchange(mesh);
    exchange.lost.clear = clear_shares(mesh, run.world->between_patches());  // not stored: it is of the materials
    return exchange;
  }
  const auto find = keeps_entries(plan.assembly.storage) ? trace_exchange : exchange_on_demand;
  return find(mesh, run.world->between_patches(), plan.assembly, run.observer);
}

TransportFacts facts_of(const Exchange& exchange) {
  return {.raw_row_sum = exchange.raw_row_sum,
          .row_sum = {},
          .lost = exchange.lost,
          .counts = exchange.counts,
          .error = exchange.error,
          .closure = exchange.closure};
}

// Rows of rays are closed one by one as they are made.
MeshTransport transport_by_rays(RayTransportAndLight found, TransportFacts facts) {
  // Between translucent sheets no pockets are followed.
  const Scattering& scattering = found.light.lit.problem.scattering;
  Eigen::VectorXd highest = Eigen::VectorXd::Zero(scattering.reflectance.rows());
  if (scattering.is_diagonal()) highest = scattering.reflectance.rowwise().maxCoeff();
  MeshTransport transport{
      .rows = {},
      .area = found.rows.area,
      .facts = std::move(facts),
      .assembly = {},
      .of_parents = {},
      .rays = std::make_unique<RaysWithPockets>(RayTransport(std::move(found.rows.halves)), highest),
      .light = std::move(found.light)};
  transport.facts.row_sum = transport.rays->rays().row_sums();
  return transport;
}

ClosedExchangeAreas closed(Exchange exchange, const Plan& plan, const Observer& observer) {
  return plan.assembly.close ? close_exchange(std::move(exchange), observer)
                             : keep_exchange_areas(std::move(exchange.exchange_areas), "not wanted");
}

}  // namespace

RayTransportAndLight ray_light(const Run& run, const PatchMesh& mesh, ExchangeAndLight found) {
  // 1. Rows in the colour of this run.
  RayExchange& exchange = found.exchange;
  RayLight& light = found.light;
  exchange.rows = weighed_rows(std::move(exchange.rows), mesh, run.world->between_patches());
  light.distance = std::move(exchange.rows.distance);

  // 2. Means over the exposed part of each patch, which is known but for its own error.
  const LostShare& lost = exchange.rows.lost;
  RadiosityProblem& problem = light.lit.problem;
  if (cuts_locally(run, mesh.size()) && !run.is_part && light.lit.direct_standard_error.size() > 0)
    light.as_found = {problem.direct_irradiance, light.lit.direct_standard_error};
  problem.area = exchange.rows.area;
  problem.scattering = with_sheets(std::move(problem.scattering), run.scene, mesh, problem.area);
  light.lit = over_exposed_part(std::move(light.lit), mesh, lost);
  const auto is_exposed = lost.covered.array() < 1;
  const Eigen::ArrayXd exposed = is_exposed.select(1 - lost.covered.array(), 1.0);
  for (Field* field : {&light.by_lamps[0], &light.by_lamps[1], &light.lamp_standard_error}) field->colwise() /= exposed;
  const Eigen::ArrayXd relative = exposure_errors(lost);
  const Field by_exposure = (0.5 * (light.by_lamps[0] + light.by_lamps[1])).colwise() * relative;
  light.lamp_standard_error = (light.lamp_standard_error.square() + by_exposure.square()).sqrt();
  Field& of_direct = light.lit.direct_standard_error;
  if (of_direct.size() > 0) {
    const Field off = light.lit.problem.direct_irradiance.colwise() * relative;
    of_direct = (of_direct.square() + off.square()).sqrt();
  }
  light.in_mirrors = over_exposed_part(std::move(light.in_mirrors), mesh, lost, problem.area);
  if (light.in_mirrors.irradiance.size() > 0) {
    auto& [irradiance, error] = light.in_mirrors;
    error = (error.square() + (irradiance.colwise() * relative).square()).sqrt();
  }
  return {std::move(exchange.rows), std::move(light)};
}

RaySolution solve_with_rays(const Run& run, const PatchMesh& mesh, const RaysWithPockets& transport,
                            const RayLight& light, const TransportFacts& facts, const SolverOptions& options) {
  // 1. Solve for what the rows carry, without losing any of it, in the bands that need it.
  const NeededLight needed = needed_light(light, options);
  const RadiosityProblem& problem = needed.problem;
  const bool reflects_twice = simulates(run.plan, Effect::interreflection);
  const Observer observer = telling_all_bands(run.observer, needed.bands);
  auto [solution, flux, halves] =
      reflects_twice ? conserving_flux(transport, problem, solve(transport, problem, options, observer), facts.row_sum,
                                       without_iterates(run.observer))
                     : reflected_once(transport, problem);

  // 2. Gather once more.
  const GatheredLight gathered = gathered_light({mesh, transport, light, needed, facts},
                                                {solution, reflects_twice ? &flux : nullptr}, std::move(halves));

  // 3. B = E + R H in all bands, with all that is emitted.
  const RadiosityProblem& all = light.lit.problem;
  for (Field* field : {&solution.direct_irradiance, &solution.ambient, &solution.error})
    *field = expanded(*field, needed.bands);
  solution.irradiance = expanded(gathered.irradiance + problem.direct_irradiance, needed.bands);
  solution.radiosity = radiosity_from(all, solution.irradiance);
  RaySolution found{std::move(solution), expanded(gathered.variance.sqrt(), needed.bands), {}};
  for (const Field& draw : gathered.correlated_errors) found.correlated_errors.push_back(expanded(draw, needed.bands));
  return found;
}

LitProblem lit_problem(const Run& run, const MeshToSolve& meshed, const MeshTransport& transport) {
  const PatchMesh& mesh = meshed.mesh.patches;
  return over_exposed_part(lit_problem(run, meshed.plan, mesh, transport.area), mesh, transport.facts.lost);
}

RawTransport raw_transport(RayTransportAndLight by_rays) {
  RawTransport found;
  found.facts.lost = by_rays.rows.lost;
  found.facts.counts.shadow_rays = by_rays.rows.shadow_rays;
  found.facts.closure = "each row by itself";
  found.by_rays = std::move(by_rays);
  return found;
}

RawTransport raw_transport(const Run& run, const Plan& plan, const PatchMesh& mesh, const Known& known) {
  if (plan.assembly.storage == Storage::rays)
    return raw_transport(ray_light(run, mesh, exchange_and_light(run, plan, mesh, known)));
  RawTransport found;
  if (plan.accuracy.error_bars) {
    found.assembly = assembly_of(run, plan, mesh, known);
    found.exchange = exchange_of(*found.assembly, mesh, lost_share_of(run, plan, mesh, known));
    found.facts = facts_of(found.exchange);
    return found;
  }
  found.exchange = exchange_on(run, plan, mesh);
  found.facts = facts_of(found.exchange);
  if (!run.with.exchange) {
    const auto rays = found.facts.counts.shadow_rays / 16;
    found.facts.bare_rays_per_second = bare_ray_rate(mesh, run.world->between_patches(), rays);
  }
  return found;
}

MeshTransport closed_transport(const Run& run, const Plan& plan, const NestedMesh& mesh, RawTransport raw) {
  if (raw.by_rays) return transport_by_rays(std::move(*raw.by_rays), std::move(raw.facts));
  MeshTransport transport{.rows = {},
                          .area = raw.exchange.area,
                          .facts = std::move(raw.facts),
                          .assembly = std::move(raw.assembly),
                          .of_parents = {},
                          .rays = {},
                          .light = {}};
  if (!keeps_entries(plan.assembly.storage)) {
    const Occluder& occluder = run.world->between_patches();
    transport.rows = on_demand_transport(mesh.patches, occluder, plan.assembly, transport.area);
    return transport;
  }
  ClosedExchangeAreas exchange_areas = closed(std::move(raw.exchange), plan, run.observer);
  transport.facts.closure = exchange_areas.method;
  if (plan.accuracy.error_bars) transport.of_parents = merged(exchange_areas, mesh);
  transport.rows = dense_transport(std::move(exchange_areas), transport.area);
  transport.facts.row_sum = transport.rows->apply(Field::Ones(mesh.patches.size(), 1)).matrix();
  return transport;
}

}  // namespace patchlight
