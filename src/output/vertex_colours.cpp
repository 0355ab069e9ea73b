#include "output/vertex_colours.h"

#include "patchlight/render/smooth.h"
#include "patchlight/render/tone_map.h"
#include "patchlight/visibility/occluder.h"

#include <numbers>

namespace patchlight {

std::vector<std::array<std::uint8_t, 3>> vertex_colours(const Scene& scene, const Simulation& simulation,
                                                        double exposure) {
  const Field radiance = simulation.solution.radiosity / std::numbers::pi;  // L = B / pi
  const Occluder occluder(scene);
  return tone_map(smooth(simulation.mesh, radiance, simulation.problem.area, occluder).at_vertices, exposure);
}

}  // namespace patchlight
