#include "patchlight/simulate.h"

#include "patchlight/base/parallel.h"
#include "patchlight/mesh/mesher.h"
#include "patchlight/mesh/refine.h"
#include "patchlight/plan/close_lamps.h"
#include "patchlight/solve/energy.h"
#include "patchlight/transport/dense.h"
#include "patchlight/transport/on_demand.h"
#include "patchlight/transport/ray_rate.h"
#include "patchlight/visibility/occluder.h"

#include "error_bars.h"
#include "memory.h"
#include "problem_of.h"
#include "stage_clock.h"

#include <cassert>
#include <limits>
#include <memory>

namespace patchlight {

Simulation simulate(const Scene& scene, const Request& request, const Observer& observer, const Steps& with) {
  const ThreadLimit threads(request.threads);
  StageClock clock;
  Simulation result;

  // 1. Decide which sides take part, how finely they are subdivided, and how form factors and radiosities are found.
  require_memory(scene, request);
  result.plan = make_plan(scene, request);
  const Plan& plan = result.plan;
  assert(!plan.on_demand || !with.exchange);

  // 2. Subdivide the kept sides of the polygons into patches.
  result.mesh = plan.error_bars ? refine(with.mesh(scene, plan.sides, 2 * plan.max_edge))
                                : with.mesh(scene, plan.sides, plan.max_edge);
  const PatchMesh& mesh = result.mesh;
  require_memory(mesh.size(), request);
  clock.finish(Stage::mesh);

  // 3. Exchange areas S_ij = A_i F_ij of all pairs, with visibility from shadow rays, unless their rows are computed on
  //    demand; and the share of each patch's hemisphere from which no patch is seen.
  const Coverings coverings = find_coverings(scene, plan.sides);
  for (const Problem& problem : problems_with_overlaps(scene, coverings)) result.plan.notes.push_back(problem.what);
  const Occluder occluder(scene, Occluder::Blockers::inside_hull, coverings);
  for (std::string& note : notes_on_close_lamps(scene, occluder, plan.max_edge))
    result.plan.notes.push_back(std::move(note));
  const auto find = plan.on_demand ? exchange_on_demand : trace_exchange;
  Exchange exchange = with.exchange ? with.exchange(mesh)
                                    : find(mesh, occluder, assembly_options(plan), plan.lost_share_rays, observer);
  const Eigen::VectorXd area = exchange.area;
  TransportFacts& facts = result.transport;
  facts = {.raw_row_sum = exchange.raw_row_sum,
           .row_sum = {},
           .lost = exchange.lost,
           .counts = exchange.counts,
           .error = exchange.error,
           .closure = exchange.closure};
  if (!with.exchange) facts.bare_rays_per_second = bare_ray_rate(mesh, occluder, facts.counts.shadow_rays / 16);
  clock.finish(Stage::form_factors);

  const EntryErrors entry_errors = std::move(exchange.entry_errors);
  // 4. Closure: each row sums up to what its patch sees.
  std::unique_ptr<RowTransport> transport;
  if (plan.on_demand) {
    transport = on_demand_transport(mesh, occluder, assembly_options(plan), area);
  } else {
    ClosedExchangeAreas closed = plan.close ? close_exchange(std::move(exchange), observer)
                                            : keep_exchange_areas(std::move(exchange.exchange_areas), "not wanted");
    facts.closure = closed.method;
    transport = dense_transport(std::move(closed), area);
    facts.row_sum = transport->apply(Field::Ones(mesh.size(), 1)).matrix();
  }
  clock.finish(Stage::closure);

  // 5. Solve B = E + rho o F B, and see where the light went.
  result.problem = problem_of(scene, mesh, area, plan.sides.emit_from_back);
  SolverOptions options = plan.solver;
  options.largest_row_sum = plan.on_demand ? std::numeric_limits<double>::infinity() : facts.row_sum.maxCoeff();
  result.solution = with.solve(*transport, result.problem, options, observer);
  result.balance = energy_balance(result.problem, result.solution,
                                  plan.on_demand ? expected_row_sum(facts.lost) : facts.row_sum, facts.lost);
  clock.finish(Stage::solve);

  // 6. How far off that may be: mesh, form factors, solver.
  if (plan.error_bars) {
    result.error_bars = error_bars(scene, request, {result, *transport, entry_errors}, observer);
    clock.finish(Stage::error_bars);
  }
  result.costs = clock.costs();
  return result;
}

}  // namespace patchlight
