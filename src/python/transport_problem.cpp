#include "python/transport_problem.h"

#include "patchlight/form_factors.h"

#include "transport/closure.h"
#include "transport/dense.h"

#include <utility>

namespace patchlight {

TransportProblem transport_problem(std::shared_ptr<const Scene> scene, const Request& request,
                                   const Observer& observer) {
  // 1. The form factors as they are found: a run closes them
  Request raw = request;
  raw.assembly.close = false;
  std::erase(raw.effects.force, Effect::closure);
  FormFactors found = find_form_factors(*scene, raw, observer);
  TransportProblem result{.scene = scene, .mesh = found.mesh, .problem = {}, .transport = nullptr};

  // 2. What a run makes of materials and lamps with them
  const SolveWith take_problem = [&](const RowTransport& transport, const RadiosityProblem& problem,
                                     const SolverOptions&, const Observer&) {
    result.problem = problem;
    // The lamps' light alone: nobody looks at the solution.
    Solution solution;
    solution.direct_irradiance = transport.apply(problem.exitance);
    solution.irradiance = solution.direct_irradiance;
    solution.radiosity = radiosity_from(problem, solution.irradiance);
    solution.history.emplace_back();
    solution.converged = true;
    return solution;
  };
  Steps with{.exchange = [&](const PatchMesh&) { return found.exchange; }, .solve = take_problem};
  with.mesh = [&] { return found.mesh; };
  Request kept = found.request;
  kept.assembly.close = request.assembly.close;
  kept.effects = request.effects;
  kept.assembly.storage = Storage::tiles;
  kept.effects.force.push_back(Effect::interreflection);
  const Simulation simulation = simulate(*scene, kept, observer, with);
  result.emits_from_back = simulation.plan.sides.emit_from_back;

  // 3. The operator
  Eigen::VectorXd area = found.exchange.area;
  ClosedExchangeAreas areas = simulation.plan.assembly.close
                                  ? close_exchange(std::move(found.exchange), observer)
                                  : keep_exchange_areas(std::move(found.exchange.exchange_areas), "as found");
  result.transport = dense_transport(std::move(areas), std::move(area));
  return result;
}

}  // namespace patchlight
