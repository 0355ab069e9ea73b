#include "error_bars.h"

namespace patchlight {

ErrorBars error_bars(const Scene& scene, const Request& request, const SolvedScene& solved, const Observer& observer) {
  const auto& [simulation, transport, entry_errors] = solved;
  const Solution& solution = simulation.solution;
  Request coarse = request;
  coarse.patches.reset();
  coarse.max_edge = 2 * simulation.plan.max_edge;
  coarse.error_bars = coarse.standard_errors = false;
  const Simulation half = simulate(scene, coarse, observer);

  ErrorBars bars;
  bars.mesh =
      mesh_errors(half.mesh, half.solution.radiosity, {simulation.mesh, solution.radiosity, simulation.problem.area});
  bars.form_factor = form_factor_errors(transport, simulation.problem, solution.radiosity, entry_errors,
                                        simulation.transport.lost.closed(), simulation.plan.seed);
  bars.solver = solution.error.size() > 0 ? solution.error : Field::Zero(bars.mesh.rows(), bars.mesh.cols());
  return bars;
}

}  // namespace patchlight
