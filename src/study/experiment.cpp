#include "study/experiment.h"

namespace patchlight {

Simulation Experiment::run(const SizedMesh& on, const Request& asked, const SolveWith& solve) const {
  Request of_mesh = asked;
  of_mesh.effects.force.push_back(Effect::interreflection);  // a matrix and a solver, even where no light is reflected
  of_mesh.mesh.patches.reset();
  of_mesh.mesh.max_edge = on.max_edge;
  return simulate(scene, of_mesh, observer, {.solve = solve, .mesh = [&on] { return on.mesh; }});
}

Experiment experiment_for(const Scene& scene, const Request& request, int sizes, const Observer& observer) {
  return {scene, request, nested_sizes(scene, request, sizes), observer};
}

StudySetting setting_of(const Simulation& simulation) {
  const Plan& plan = simulation.plan;
  StudySetting setting;
  setting.patches = simulation.mesh.size();
  setting.estimator = plan.assembly.estimator;
  setting.samples = plan.assembly.samples;
  setting.tolerance = tolerance_of(plan.solver);
  setting.costs = simulation.costs;
  setting.matrix_bytes = static_cast<double>(ExchangeAreas::bytes(setting.patches));
  return setting;
}

StudySetting judged(const Simulation& simulation, const Reference& reference) {
  StudySetting setting = setting_of(simulation);
  const Discrepancy found = discrepancy(simulation, reference);
  setting.error = found.of_means;
  setting.display_error = found.of_display;
  setting.own_error = found.of_means;
  return setting;
}

StudySetting judged(const Simulation& simulation, const Reference& reference, const FieldView& own) {
  StudySetting setting = judged(simulation, reference);
  setting.own_error = relative_error(own, simulation.solution.radiosity, simulation.problem);
  return setting;
}

}  // namespace patchlight
