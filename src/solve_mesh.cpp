#include "solve_mesh.h"

#include "patchlight/mesh/mesher.h"

#include "base/vectors.h"
#include "effects.h"
#include "lighting/direct_irradiance.h"
#include "memory.h"
#include "problem_of.h"
#include "relative_errors.h"
#include "solve/energy.h"
#include "solve_for_interest.h"
#include "transport/dense.h"
#include "transport/merged.h"
#include "transport/on_demand.h"
#include "transport/ray_rate.h"
#include "with_error_bars.h"

#include <limits>
#include <memory>
#include <utility>

namespace patchlight {
namespace {

// Exchange areas before closure with the errors of their entries; what is known from the mesh before is taken over.
Assembly assembly_of(const Setting& setting, const Plan& plan, const MeshToSolve& to_solve) {
  const PatchMesh& mesh = to_solve.mesh.patches;
  const AssemblyOptions options = assembly_options(plan);
  if (!to_solve.known)
    return assemble_exchange_areas(mesh, setting.tracing->between_patches(), options, setting.observer);
  return assemble_exchange_areas(mesh, setting.tracing->between_patches(), options, {*to_solve.known, to_solve.place},
                                 setting.observer);
}

LostShare lost_share_of(const Setting& setting, const Plan& plan, const MeshToSolve& to_solve) {
  const auto& [mesh, place, known, lost] = to_solve;
  if (!lost)
    return measure_lost_share(mesh.patches, setting.tracing->between_patches(), plan.lost_share_rays, plan.seed,
                              setting.observer);
  return measure_lost_share(mesh.patches, setting.tracing->between_patches(), KnownShares{*lost, place}, plan.seed,
                            setting.observer);
}

// Exchange areas by computation, unless they are known or computed on demand.
Exchange exchange_on(const Setting& setting, const Plan& plan, const PatchMesh& mesh) {
  if (setting.with.exchange) return setting.with.exchange(mesh);
  const auto find = keeps_entries(plan.storage) ? trace_exchange : exchange_on_demand;
  return find(mesh, setting.tracing->between_patches(), assembly_options(plan), plan.lost_share_rays, setting.observer);
}

TransportFacts facts_of(const Exchange& exchange) {
  return {.raw_row_sum = exchange.raw_row_sum,
          .row_sum = {},
          .lost = exchange.lost,
          .counts = exchange.counts,
          .error = exchange.error,
          .closure = exchange.closure};
}

ClosedExchangeAreas closed(Exchange exchange, const Plan& plan, const Observer& observer) {
  return plan.close ? close_exchange(std::move(exchange), observer)
                    : keep_exchange_areas(std::move(exchange.exchange_areas), "not wanted");
}

}  // namespace

SolvedMesh solve_mesh(const Setting& setting, const Plan& plan, MeshToSolve to_solve, StageClock& clock) {
  const auto& [scene, tracing, with, observer] = setting;
  const Occluder& occluder = tracing->between_patches();
  SolvedMesh result;
  result.mesh = to_solve.mesh;
  Simulation& simulation = result.simulation;
  TransportFacts& facts = simulation.transport;
  simulation.plan = plan;
  simulation.tracing = tracing;
  simulation.mesh = to_solve.mesh.patches;
  const PatchMesh& mesh = simulation.mesh;

  // 1. Exchange areas S_ij = A_i F_ij of all pairs, with visibility from shadow rays, unless their rows are computed on
  //    demand; and the share of each patch's hemisphere from which no patch is seen.
  Exchange exchange;
  if (plan.error_bars) {
    result.raw = assembly_of(setting, plan, to_solve);
    exchange = exchange_of(*result.raw, mesh, lost_share_of(setting, plan, to_solve));
    to_solve.known.reset();
  } else {
    exchange = exchange_on(setting, plan, mesh);
  }
  const Eigen::VectorXd area = exchange.area;
  facts = facts_of(exchange);
  if (!with.exchange && !plan.error_bars)
    facts.bare_rays_per_second = bare_ray_rate(mesh, occluder, facts.counts.shadow_rays / 16);
  clock.finish(Stage::form_factors);

  // 2. Closure: each row sums up to what its patch sees.
  std::unique_ptr<RowTransport> transport;
  std::optional<ClosedExchangeAreas> of_parents;
  if (!keeps_entries(plan.storage)) {
    transport = on_demand_transport(mesh, occluder, assembly_options(plan), area);
  } else {
    ClosedExchangeAreas exchange_areas = closed(std::move(exchange), plan, observer);
    facts.closure = exchange_areas.method;
    if (plan.error_bars) of_parents = merged(exchange_areas, result.mesh);
    transport = dense_transport(std::move(exchange_areas), area);
    facts.row_sum = transport->apply(Field::Ones(mesh.size(), 1)).matrix();
  }
  clock.finish(Stage::closure);

  // 3. Light of luminaires, sun and sky where it first arrives.
  simulation.problem = problem_of(scene, mesh, area, plan.sides.emit_from_back);
  if (has_point_or_daylight(scene)) {
    DirectIrradiance direct = direct_irradiance_as_planned(setting, plan, mesh);
    simulation.problem.direct_irradiance = std::move(direct.irradiance);
    simulation.direct_standard_error = std::move(direct.standard_error);
    clock.finish(Stage::direct_light);
  }

  // 4. Solve B = E + rho o (F B + H_direct), and see where the light went.
  SolverOptions options = plan.solver;
  options.largest_row_sum =
      keeps_entries(plan.storage) ? largest(facts.row_sum) : std::numeric_limits<double>::infinity();
  const SolveWith solve = solver_as_planned(with.solve, plan);
  const Solve once = [&](const SolverOptions& by) {
    return solve(*transport, simulation.problem, by, setting.observer);
  };
  SolvedWith solved = solve_for_interest(setting, simulation, options, once);
  simulation.plan.solver.relative_error = solved.relative_error;
  simulation.solution = std::move(solved.solution);
  simulation.balance =
      energy_balance(simulation.problem, simulation.solution,
                     keeps_entries(plan.storage) ? facts.row_sum : expected_row_sum(facts.lost), facts.lost);
  clock.finish(Stage::solve);

  // 5. How far that may be off.
  if (plan.error_bars) result = with_error_bars(setting, std::move(result), *transport, std::move(*of_parents));
  clock.finish(Stage::error_bars);
  return result;
}

NestedMesh first_mesh(const Scene& scene, const Plan& plan) {
  if (plan.error_bars) return nest(tessellate(scene, plan.sides, 2 * plan.max_edge));
  NestedMesh mesh;
  mesh.patches = tessellate(scene, plan.sides, plan.max_edge);
  return mesh;
}

SolvedMesh solve_mesh(const Setting& setting, const Request& request, const Plan& plan, StageClock& clock) {
  MeshToSolve to_solve;
  if (setting.with.mesh) {
    to_solve.mesh.patches = setting.with.mesh();
  } else {
    to_solve.mesh = first_mesh(setting.scene, plan);
  }
  require_memory(to_solve.mesh.patches.size(), request);
  clock.finish(Stage::mesh);
  SolvedMesh solved = solve_mesh(setting, plan, std::move(to_solve), clock);
  if (plan.error_bars) solved.simulation.accuracy = {accuracy_of(solved)};
  return solved;
}

AccuracyStep accuracy_of(const SolvedMesh& solved) {
  AccuracyStep step = errors_of(solved.simulation, solved.interest);
  step.patches = step.new_patches = solved.simulation.mesh.size();
  return step;
}

}  // namespace patchlight
