#include "patchlight/simulate.h"

#include "patchlight/base/error.h"

#include "base/parallel.h"
#include "pipeline/light_colours.h"
#include "pipeline/mesh_transport.h"
#include "pipeline/problem_of.h"
#include "pipeline/radiosity_errors.h"
#include "pipeline/run.h"
#include "pipeline/search.h"
#include "pipeline/solved.h"
#include "pipeline/with_error_bars.h"
#include "plan/check_request.h"
#include "plan/choose_storage.h"

#include <utility>

namespace patchlight {
namespace {

Simulation finished(Simulation simulation, const StageClock& clock) {
  const Scene& scene = simulation.world->planned_scene();
  simulation.spaces = errors_by_space(scene, simulation);
  simulation.costs = clock.costs();
  return to_geometric_area(std::move(simulation), scene);
}

// One mesh: form factors, light, solution and how far that may be off.
SolvedMesh solved_mesh(const Run& run, MeshToSolve& meshed, Search& search, StageClock& clock) {
  // 5. Form factors between them, and closure: light goes from patch to patch by H = F B.
  RawTransport raw = raw_transport(run, meshed.plan, meshed.mesh.patches, std::exchange(meshed.known, {}));
  clock.finish(Stage::form_factors);
  MeshTransport transport = closed_transport(run, meshed.plan, meshed.mesh, std::move(raw));
  clock.finish(Stage::closure);

  // 6. Materials, and the light of luminaires, sun and sky where it first arrives: with rows of rays it comes with the
  // form factors.
  LitProblem problem = transport.light ? transport.light->lit : lit_problem(run, meshed, transport);
  if (has_point_or_daylight(run.scene) && !transport.light) clock.finish(Stage::direct_light);

  // 7. Solve B = E + rho o (F B + H_direct), and see where the light went.
  Simulation simulation = solved(run, meshed, transport, std::move(problem));
  clock.finish(Stage::solve);
  search.keep(simulation);
  if (simulation.solution.stopped && !simulation.solution.converged) throw Canceled();

  // 8. How far that may be off.
  SolvedMesh result = with_error_bars(run, {std::move(simulation), std::move(meshed.mesh)}, std::move(transport));
  clock.finish(Stage::error_bars);
  return result;
}

}  // namespace

Simulation simulate(const Scene& scene, const Request& request, const Observer& observer, const Steps& with) {
  return simulate(std::make_shared<const Scene>(scene), request, observer, with);
}

Simulation simulate(std::shared_ptr<const Scene> read, const Request& request, const Observer& observer,
                    const Steps& with) {
  const Scene& scene = *read;
  const ThreadLimit threads(request.resources.threads);
  StageClock clock;

  // 1. Refuse requests that cannot be combined.
  const Given given = given_by(with);
  check(request, scene, given);

  // 2. Survey the scene. Decide which effects are simulated, which sides are included, how finely they are subdivided,
  //    and how form factors and radiosities are computed.
  const Plan plan = make_plan(scene, request, given);
  require_memory(scene, request, plan);
  clock.finish(Stage::plan);

  // 3. Share what rays and sources of light need with all later steps, and with the views of the solution.
  const auto world = std::make_shared<const World>(std::move(read), plan);
  const Diagnostics notes = notes_on_run(*world, plan);
  const Run run{world->planned_scene(), request, plan, notes, world, with, observer};
  const std::vector<LightColour> colours = light_colours(run);

  Search search(run);
  try {
    for (std::optional<MeshToSolve> next = search.first();;) {
      // 4. Subdivide the kept sides of the polygons into patches.
      const MeshToSolve& meshed = *next;
      require_memory(meshed.mesh.patches.size(), request, meshed.plan);
      clock.finish(Stage::mesh);

      // 5. to 8. Once for each color that clear faces and mirrors distinguish.
      SolvedMesh result =
          colours.empty() ? solved_mesh(run, *next, search, clock) : solved_in_colours(run, colours, meshed, clock);

      // 9. Refine where that pays, or end.
      result = search.noted(std::move(result));
      next = search.next(result);
      if (!next) return finished(std::move(result.simulation), clock);
    }
  } catch (const Canceled&) {
    if (!search.kept()) throw;
    return finished(*search.kept(), clock);
  }
}

}  // namespace patchlight
