#include "pipeline/mesh_transport.h"

#include "accuracy/errors.h"
#include "base/vectors.h"
#include "form_factor/patch_shape.h"
#include "pipeline/local_cuts.h"
#include "pipeline/problem_of.h"
#include "pipeline/solve_with_rays.h"
#include "transport/pair_sampler.h"
#include "transport/ray_rows.h"
#include "visibility/occluder.h"

#include <utility>

namespace patchlight {
namespace {

// Exchange areas before closure, with the errors of their entries. Known entries come from the previous mesh.
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
          .closure = exchange.closure};
}

// Rows of rays are closed one by one as they are made.
MeshTransport transport_by_rays(RayTransportAndLight found, TransportFacts facts) {
  // Between translucent sheets no pockets are followed.
  const Scattering& scattering = found.light.lit.problem.scattering;
  Eigen::VectorXd highest = Eigen::VectorXd::Zero(scattering.reflectance.rows());
  if (scattering.is_diagonal()) highest = scattering.reflectance.rowwise().maxCoeff();
  MeshTransport transport;
  transport.area = found.rows.area;
  transport.facts = std::move(facts);
  transport.rays = std::make_shared<RaysWithPockets>(RayTransport(std::move(found.rows.halves)), highest);
  transport.light = std::move(found.light);
  transport.facts.row_sum = transport.rays->rays().row_sums();
  return transport;
}

}  // namespace

RayTransportAndLight ray_light(const Run& run, const PatchMesh& mesh, ExchangeAndLight found) {
  // 1. Rows in the color of this run.
  RayExchange& exchange = found.exchange;
  RayLight& light = found.light;
  exchange.rows = weighed_rows(std::move(exchange.rows), mesh, run.world->between_patches());
  light.distance = std::move(exchange.rows.distance);

  // 2. Means over the exposed part of each patch, which has an error of its own.
  const LostShare& lost = exchange.rows.lost;
  RadiosityProblem& problem = light.lit.problem;
  if (cuts_locally(run, mesh.size()) && !run.is_part && light.lit.direct_standard_error.size() > 0)
    light.as_found = {problem.direct_irradiance, light.lit.direct_standard_error, light.lit.unfollowed};
  problem.area = exchange.rows.area;
  problem.scattering = with_sheets(std::move(problem.scattering), run.scene, mesh, problem.area);
  light.lit = over_exposed_part(std::move(light.lit), mesh, lost);
  const auto is_exposed = lost.covered.array() < 1;
  const Eigen::ArrayXd exposed = is_exposed.select(1 - lost.covered.array(), 1.0);
  for (Field* field : {&light.by_emitters[0], &light.by_emitters[1], &light.emitter_standard_error})
    field->colwise() /= exposed;
  const Eigen::ArrayXd relative = exposure_errors(lost);
  const Field by_exposure = (0.5 * (light.by_emitters[0] + light.by_emitters[1])).colwise() * relative;
  light.emitter_standard_error = (light.emitter_standard_error.square() + by_exposure.square()).sqrt();
  Field& of_direct = light.lit.direct_standard_error;
  if (of_direct.size() > 0) {
    const Field off = light.lit.problem.direct_irradiance.colwise() * relative;
    of_direct = (of_direct.square() + off.square()).sqrt();
  }
  light.in_mirrors = over_exposed_part(std::move(light.in_mirrors), mesh, lost, problem.area);
  if (light.in_mirrors.irradiance.size() > 0) {
    auto& [irradiance, error, unfollowed] = light.in_mirrors;
    error = (error.square() + (irradiance.colwise() * relative).square()).sqrt();
  }
  return {std::move(exchange.rows), std::move(light)};
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
  MeshTransport transport;
  transport.area = raw.exchange.area;
  transport.facts = std::move(raw.facts);
  transport.assembly = std::move(raw.assembly);
  if (!keeps_entries(plan.assembly.storage)) {
    const Occluder& occluder = run.world->between_patches();
    transport.rows = on_demand_transport(mesh.patches, occluder, plan.assembly, transport.area);
    return transport;
  }
  ClosedExchangeAreas exchange_areas = plan.assembly.close
                                           ? close_exchange(std::move(raw.exchange), run.observer)
                                           : keep_exchange_areas(std::move(raw.exchange.exchange_areas), "not wanted");
  transport.facts.closure = exchange_areas.method;
  if (plan.accuracy.error_bars) transport.of_parents = merged(exchange_areas, mesh);
  transport.rows = dense_transport(std::move(exchange_areas), transport.area);
  transport.facts.row_sum = transport.rows->apply(Field::Ones(mesh.patches.size(), 1)).matrix();
  return transport;
}

}  // namespace patchlight
