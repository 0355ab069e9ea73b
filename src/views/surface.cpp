#include "patchlight/views/surface.h"

#include "patchlight/render/smooth.h"
#include "patchlight/visibility/occluder.h"

#include <numbers>

namespace patchlight {

SolvedSurface surface_of(const Scene& scene, const Simulation& simulation) {
  const Field radiance = simulation.solution.radiosity / std::numbers::pi;  // L = B / pi
  return {scene, simulation, smooth(simulation.mesh, radiance, simulation.problem.area, Occluder(scene)).at_vertices};
}

}  // namespace patchlight
