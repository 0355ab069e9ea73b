#include "python/transport_problem.h"

#include "patchlight/form_factors.h"
#include "patchlight/gather/gather.h"

#include "gather/sensor_places.h"
#include "transport/closure.h"
#include "transport/dense.h"
#include "visibility/occluder.h"
#include "visibility/tracing.h"

#include <limits>
#include <utility>
#include <vector>

namespace patchlight {

Field sensor_factors(const TransportProblem& problem, const Observer& observer) {
  const Occluder& occluder = problem.tracing->all_faces(*problem.scene);
  const std::vector<SensorPlace> places = place_sensors(*problem.scene, problem.plan.sides, occluder);
  const auto patches = static_cast<Eigen::Index>(problem.mesh.size());
  std::vector<Sensor> sensors;
  for (const SensorPlace& place : places) sensors.push_back(place.sensor);
  const Field one_each = Field(Eigen::MatrixXd::Identity(patches, patches).array());
  Field factors = gather_irradiance(problem.mesh, one_each, occluder, sensors,
                                    {.seed = problem.plan.assembly.seed, .slopes = false}, observer)
                      .irradiance;
  for (std::size_t k = 0; k < places.size(); ++k) {
    if (places[k].standing == Standing::inside_wall)
      factors.row(static_cast<Eigen::Index>(k)).setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  return factors;
}

TransportProblem transport_problem(const std::shared_ptr<const Scene>& scene, const Request& request,
                                   const Observer& observer) {
  // 1. The form factors as they are found: a run closes them
  check(*scene);
  Request raw = request;
  raw.assembly.close = false;
  std::erase(raw.effects.force, Effect::closure);
  FormFactors found = find_form_factors(*scene, raw, observer);
  TransportProblem result{
      .scene = scene, .mesh = found.mesh, .problem = {}, .plan = {}, .tracing = nullptr, .transport = nullptr};

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
  Simulation simulation = simulate(*scene, kept, observer, with);
  const bool closes = simulation.plan.assembly.close;
  result.plan = std::move(simulation.plan);
  result.tracing = std::move(simulation.tracing);

  // 3. The operator
  Eigen::VectorXd area = found.exchange.area;
  ClosedExchangeAreas areas = closes ? close_exchange(std::move(found.exchange), observer)
                                     : keep_exchange_areas(std::move(found.exchange.exchange_areas), "as found");
  result.transport = dense_transport(std::move(areas), std::move(area));
  return result;
}

}  // namespace patchlight
