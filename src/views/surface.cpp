#include "patchlight/views/views.h"

#include "render/smooth.h"
#include "visibility/occluder.h"
#include "visibility/tracing.h"

#include <numbers>

namespace patchlight {

SolvedSurface surface_of(const Scene& scene, const Simulation& simulation) {
  const Field radiance = simulation.solution.radiosity / std::numbers::pi;  // L = B / pi
  const Occluder& occluder = simulation.tracing->all_faces(scene);
  return {scene, simulation, smooth(simulation.mesh, radiance, simulation.problem.area, occluder).at_vertices};
}

}  // namespace patchlight
